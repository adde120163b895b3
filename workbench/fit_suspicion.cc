#include "workbench/fit_suspicion.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/json_value.h"
#include "core/told_error.h"
#include "workbench/explain/headline.h"
#include "workbench/explain/odd_text.h"

namespace hydroscope {
namespace {

constexpr Wording kAbsorb = {
    "the parameters absorb part of it and may lie outside their intervals",
    "die Parameter nehmen einen Teil davon auf und können außerhalb ihrer Intervalle "
    "liegen"};

constexpr Wording kNotProven = {", which is not proven", ", was nicht bewiesen ist"};

/// "Internal leakage past the piston seal (internal_leakage)".
Told TitleOf(const ExplainResult& explained, const std::string& id) {
  const Effect* effect = explained.FindEffect(id);
  if (effect == nullptr || effect->title == id) return {id, id};
  return Tell("{} ({})", "{} ({})", Told(effect->title, effect->german.title), id);
}

/// One of the effects hidden at once: its name, or those that may be it.
Told GroupTold(const ExplainResult& explained, const std::vector<std::string>& group) {
  Told names;
  for (const std::string& id : group)
    names = names.empty() ? TitleOf(explained, id)
                          : Tell("{} or {}", "{} oder {}", names, TitleOf(explained, id));
  return names;
}

Told Sentence(const ExplainResult& explained) {
  const Explanation& x = explained.explanation;
  if (x.may_be_noise)
    return Tell("{}: the noise is not white, or the model misses something, and then {}",
                "{}: das Rauschen ist nicht weiß, oder dem Modell fehlt etwas, und dann gilt: {}",
                kNothingPredicts, kAbsorb);
  if (SwapLeads(x))
    return Tell("{}{}; {}", "{}{}; {}", SwapTold(*x.swap), x.swap->proven ? Told() : Told(kNotProven),
                kAbsorb);
  if (x.small_error) return Tell("{}; {}", "{}; {}", x.doubt, kAbsorb);
  if (x.verdict == Verdict::kUnknown)
    return Tell("the model misses something that no known effect explains; {}",
                "dem Modell fehlt etwas, das kein bekannter Effekt erklärt; {}", kAbsorb);
  std::vector<Told> groups;
  for (const auto& group : x.groups) groups.push_back(GroupTold(explained, group));
  Told missing;
  for (const Told& group : groups)
    missing = missing.empty() ? group : Tell("{} and {}", "{} und {}", missing, group);
  return Tell("the model misses {}{}; {}", "dem Modell fehlt {}{}; {}", missing,
              x.partial ? Told(kNotProven) : Told(), kAbsorb);
}

}  // namespace

FitSuspicion SuspicionOf(const Result<ExplainResult>& result) {
  if (!result)
    return {"",
            {},
            {Tell("whether the model misses something was not judged: {}",
                  "ob dem Modell etwas fehlt, wurde nicht beurteilt: {}", ToldOf(result.error()))},
            true,
            false};
  const ExplainResult& explained = *result;
  const Explanation& x = explained.explanation;
  FitSuspicion out{VerdictName(x.verdict), x.set, x.warnings, false, x.no_verdict.empty()};
  out.suspected = x.verdict != Verdict::kAdequate || !x.odd_strokes.empty();
  if (x.verdict != Verdict::kAdequate && x.no_verdict.empty()) out.warnings.push_back(Sentence(explained));
  for (const OddStrokes& odd : x.odd_strokes) out.warnings.push_back(OddText(explained, odd));
  return out;
}

std::string SuspicionText(const FitSuspicion& suspicion) {
  std::string text;
  for (const Told& warning : suspicion.warnings) text += "WARNING: " + warning.english + ".\n";
  if (suspicion.ExplainSaysMore()) text += "'hydroscope explain' says more.\n";
  return text;
}

void AddSuspicion(const FitSuspicion& suspicion, nlohmann::json& json) {
  json["verdict"] = JsonOrNull(suspicion.verdict);
  json["suspects"] = suspicion.suspects;
  nlohmann::json& warnings = json["warnings"];
  if (!warnings.is_array()) warnings = nlohmann::json::array();
  for (const Told& warning : suspicion.warnings) {
    warnings.push_back(warning.english);
    if (json.contains("german")) json["german"]["warnings"].push_back(warning.german);
  }
}

}  // namespace hydroscope
