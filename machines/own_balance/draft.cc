#include "machines/own_balance/draft.h"

namespace hydroscope {
namespace {

std::string SuitsAny(const LogSample&) { return "no built-in machine has just these signals"; }

void CompleteOwn(const LogSample& log, const std::map<std::string, double>&, MachineDraft& draft) {
  const auto has = [&](const char* signal) { return log.signals.contains(signal); };
  if (!has("F") || !has("p_A")) {
    draft.open.emplace_back(
        "[balance]: write which output equals which sum of terms, see docs/machine_file.md");
    draft.notes.tail = {
        "<-- FILL IN the balance: the output and the terms that explain it, over the signals above; e.g.",
        "[balance]", "output = \"F\"", "terms = { A = \"p\", c = \"1\" }"};
    return;
  }
  BalanceSpec& balance = draft.machine.balance;
  balance.output = "F";
  balance.unit = "N";
  balance.terms = {{"A", "p_A", "m2"}};
  if (has("p_B")) balance.terms.push_back({"A_B", "-p_B", "m2"});
  balance.terms.push_back({"c", "1", "N"});
  draft.decided.emplace_back("balance: force = area * pressure + constant, because both are there");
  if (!has("z")) return;
  draft.machine.user_effects = {
      {"coulomb_friction", "Friction of constant size against the motion", {{"F_c", "sign(ddt(z))", "N"}}},
      {"viscous_friction", "Friction that grows with speed", {{"d", "ddt(z)", "N s/m"}}},
      {"pressure_friction", "Friction that grows with pressure", {{"mu", "p_A*sign(ddt(z))", "m2"}}}};
  draft.decided.emplace_back("effects to try: friction, because a position is there");
}

}  // namespace

const DraftRules kOwnDraft = {SuitsAny, CompleteOwn};

}  // namespace hydroscope
