#include "machines/own_balance/kind.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "models/expressions/balance.h"
#include "models/machine_draft.h"

namespace hydroscope {
namespace {

constexpr double kPieces = 20;                    ///< of a log that no condition cuts into strokes
constexpr double kShortest = 0.5, kLongest = 10;  ///< s, of such a piece

/// Strokes are what is left out and judged by; a log without conditions would be one.
void CutIntoPieces(const LogSample& log, MachineDraft& draft) {
  std::size_t rows = 0;
  for (const auto& [name, signal] : log.signals) rows = std::max(rows, signal.value.size());
  const double piece = std::clamp(static_cast<double>(rows) * log.period / kPieces, kShortest, kLongest);
  draft.machine.gate.max_stroke = std::strtod(fmt::format("{:.2g}", piece).c_str(), nullptr);
  draft.decided.push_back(Tell("without conditions in [gate] the log is cut into pieces of {:.2g} s",
                               "ohne Bedingungen in [gate] wird der Log in Stücke von {:.2g} s geteilt",
                               piece));
}

Told SuitsAny(const LogSample&) {
  return {"no built-in machine has just these signals", "keine eingebaute Maschine hat gerade diese Signale"};
}

void CompleteOwn(const LogSample& log, const std::map<std::string, double>&, MachineDraft& draft) {
  CutIntoPieces(log, draft);
  const auto has = [&](const char* signal) { return log.signals.contains(signal); };
  if (!has("F") || !has("p_A")) {
    draft.open.emplace_back(
        "[balance]: write which output equals which sum of terms, see docs/machine_file.md",
        "[balance]: angeben, welcher Ausgang gleich welcher Summe von Termen ist");
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
  draft.decided.emplace_back("balance: force = area * pressure + constant, because both are there",
                             "Bilanz: Kraft = Fläche * Druck + Konstante, weil beide da sind");
  if (!has("z")) return;
  draft.machine.user_effects = {{.id = "coulomb_friction",
                                 .description = "Friction of constant size against the motion",
                                 .terms = {{"F_c", "sign(ddt(z))", "N"}},
                                 .german = "Reibung fester Größe gegen die Bewegung"},
                                {.id = "viscous_friction",
                                 .description = "Friction that grows with speed",
                                 .terms = {{"d", "ddt(z)", "N s/m"}},
                                 .german = "Reibung, die mit der Geschwindigkeit wächst"},
                                {.id = "pressure_friction",
                                 .description = "Friction that grows with pressure",
                                 .terms = {{"mu", "p_A*sign(ddt(z))", "m2"}},
                                 .german = "Reibung, die mit dem Druck wächst"}};
  draft.decided.emplace_back("effects to try: friction, because a position is there",
                             "Effekte zum Probieren: Reibung, weil eine Position da ist");
}

/// Any log may be of a machine of the user's own; a balance of forces is proposed where there is a force.
const DraftRules kOwnDraft = {SuitsAny, CompleteOwn};

/// Signals that the terms of a balance read, in the order of the machine file.
std::vector<std::string> SignalsOfTerms(const Machine& machine) {
  std::set<std::string> names;
  for (const TermSpec& term : machine.balance.terms)
    if (const auto tree = ParseExpression(term.expression)) names.merge(NamesIn(**tree));
  std::vector<std::string> signals;
  for (const SignalSpec& signal : machine.signals)
    if (names.contains(signal.name)) signals.push_back(signal.name);
  return signals;
}

Told ListOf(const std::vector<std::string>& names) {
  if (names.empty()) return {"the signals of its terms", "die Signale ihrer Terme"};
  if (names.size() < 2) return {names.front(), names.front()};
  const std::vector<std::string> first(names.begin(), names.end() - 1);
  return Tell("{} and {}", "{} und {}", fmt::to_string(fmt::join(first, ", ")), names.back());
}

MachineWords OwnWords(const Machine& machine) {
  return {
      .output = machine.balance.output, .stroke = {"stroke", "Hub"}, .vary = ListOf(SignalsOfTerms(machine))};
}

}  // namespace

const MachineKind kOwnBalance = {
    .id = "expressions",
    .title = {"machine with a balance of its own", "Maschine mit eigener Bilanz"},
    .own_library = true,
    .words = OwnWords,
    .temperature = "T_oil",
    .draft = kOwnDraft,
    .build = BuildExpressionBalance};

}  // namespace hydroscope
