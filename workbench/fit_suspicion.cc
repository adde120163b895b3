#include "workbench/fit_suspicion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "workbench/explain/headline.h"

namespace hydroscope {
namespace {

constexpr const char* kAbsorb = "the parameters absorb part of it and may lie outside their intervals";

/// "Internal leakage past the piston seal (internal_leakage)".
std::string TitleOf(const ExplainResult& explained, const std::string& id) {
  const Effect* effect = explained.FindEffect(id);
  return effect == nullptr ? id : fmt::format("{} ({})", effect->title, id);
}

/// One of the effects hidden at once: its name, or those that may be it.
std::string GroupText(const ExplainResult& explained, const std::vector<std::string>& group) {
  std::vector<std::string> titles;
  for (const std::string& id : group) titles.push_back(TitleOf(explained, id));
  return fmt::format("{}", fmt::join(titles, " or "));
}

std::string OddSentence(const ExplainResult& explained, const OddStrokes& odd) {
  std::vector<std::int64_t> numbers;
  for (const std::size_t s : odd.strokes) numbers.push_back(explained.log.strokes[s].summary.index);
  return fmt::format(
      "strokes {} differ from the rest{} and are left out of the parameters", fmt::join(numbers, ", "),
      odd.parameter.empty() ? "" : fmt::format(", as by another value of {} in them,", odd.parameter));
}

std::string Sentence(const ExplainResult& explained) {
  const Explanation& x = explained.explanation;
  if (x.may_be_noise)
    return fmt::format("{}: the noise is not white, or the model misses something, and then {}",
                       kNothingPredicts, kAbsorb);
  if (x.small_error) return fmt::format("{}; {}", x.doubt.english, kAbsorb);
  if (x.verdict == Verdict::kUnknown)
    return fmt::format("the model misses something that no known effect explains; {}", kAbsorb);
  std::vector<std::string> groups;
  for (const auto& group : x.groups) groups.push_back(GroupText(explained, group));
  return fmt::format("the model misses {}{}; {}", fmt::join(groups, " and "),
                     x.partial ? ", which is not proven" : "", kAbsorb);
}

}  // namespace

FitSuspicion SuspicionOf(const Result<ExplainResult>& result) {
  if (!result)
    return {"",
            {},
            {fmt::format("whether the model misses something was not judged: {}", result.error().text)},
            true,
            false};
  const ExplainResult& explained = *result;
  const Explanation& x = explained.explanation;
  FitSuspicion out{VerdictName(x.verdict), x.set, InEnglish(x.warnings), false, x.no_verdict.empty()};
  out.suspected = x.verdict != Verdict::kAdequate || !x.odd_strokes.empty();
  for (const OddStrokes& odd : x.odd_strokes) out.warnings.push_back(OddSentence(explained, odd));
  if (x.verdict != Verdict::kAdequate && x.no_verdict.empty()) out.warnings.push_back(Sentence(explained));
  return out;
}

std::string SuspicionText(const FitSuspicion& suspicion) {
  std::string text;
  for (const std::string& warning : suspicion.warnings) text += "WARNING: " + warning + ".\n";
  if (suspicion.ExplainSaysMore()) text += "'hydroscope explain' says more.\n";
  return text;
}

void AddSuspicion(const FitSuspicion& suspicion, nlohmann::json& json) {
  json["verdict"] = suspicion.verdict.empty() ? nlohmann::json() : nlohmann::json(suspicion.verdict);
  json["suspects"] = suspicion.suspects;
  nlohmann::json& warnings = json["warnings"];
  if (!warnings.is_array()) warnings = nlohmann::json::array();
  for (const std::string& warning : suspicion.warnings) warnings.push_back(warning);
}

}  // namespace hydroscope
