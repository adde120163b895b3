#include "monitor/finding_explanation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/interval_text.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "workbench/explain/explain_change.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kMostStrokesCompared = 300;  ///< on either side

std::vector<std::string> SizesThatAppeared(const ChangeResult& result) {
  const Explanation& after = result.after.explanation;
  std::vector<std::string> sizes;
  for (auto k = static_cast<std::size_t>(after.started); k < after.final.effects.size(); ++k) {
    const EffectEstimate& e = after.final.effects[k];
    const Effect& effect = result.after.effect(e.choice.effect);
    sizes.push_back(fmt::format("{} ({} = {})", effect.id, effect.parameter,
                                ShownWithInterval(e.size, e.std, effect.unit)));
  }
  return sizes;
}

std::vector<std::string> Moved(const ChangeResult& result) {
  std::vector<std::string> moved;
  for (const auto* values : {&result.parameters, &result.effects})
    for (const ValueChange& v : *values)
      if (v.significant)
        moved.push_back(fmt::format("{} {} -> {}", v.name, ShownWithInterval(v.before, v.before_std, v.unit),
                                    ShownWithInterval(v.after, v.after_std, v.unit)));
  return moved;
}

std::string ErrorText(const ChangeResult& result) {
  const Explanation& after = result.after.explanation;
  const DisplayUnit unit = OutputUnit(result.after.log.model.get());
  if (after.steps.size() < 2) return "";
  return fmt::format("; error on strokes left out {:.3g} -> {:.3g} {}", after.base.rms_holdout * unit.factor,
                     after.final.rms_holdout * unit.factor, unit.name);
}

/// Of episodes, whose effects are tried on logs alone.
std::string SentenceOfEpisodes(const ChangeResult& result) {
  const auto moved = Moved(result);
  const bool adequate = result.after.explanation.verdict == Verdict::kAdequate;
  std::string text = adequate ? "" : "the model errs more than before; ";
  text += !moved.empty() ? fmt::format("moved: {}", fmt::join(moved, ", "))
          : adequate     ? "no parameter moved beyond its interval"
                     : "no parameters that stay as they are over these episodes take that away: one is still "
                       "moving, or an effect is missing";
  return text + "; which effect it is, `hydroscope explain` with the logs says";
}

std::string Sentence(const ChangeResult& result) {
  if (InEpisodes(*result.after.log.model->kind)) return SentenceOfEpisodes(result);
  const auto appeared = SizesThatAppeared(result);
  const auto moved = Moved(result);
  const std::string also = moved.empty() ? "" : fmt::format("; moved: {}", fmt::join(moved, ", "));
  switch (result.after.explanation.verdict) {
    case Verdict::kAdequate:
      return moved.empty()
                 ? "no effect of the library appeared and no parameter moved beyond its interval"
                 : fmt::format("no effect of the library appeared; moved: {}", fmt::join(moved, ", "));
    case Verdict::kNamed:
      return (appeared.empty() ? "nothing new appeared"
                               : fmt::format("appeared: {}", fmt::join(appeared, ", "))) +
             also + ErrorText(result);
    case Verdict::kAmbiguous:
      return fmt::format("one of these appeared and the strokes cannot tell which: {}{}{}",
                         fmt::join(result.after.explanation.set, ", "), also, ErrorText(result));
    case Verdict::kUnknown:
      return "the model errs more than before and no effect of the library explains it" + also;
  }
  return "";
}

/// Effects that were in the model and grew or shrank.
std::vector<std::string> ChangedEffects(const ChangeResult& result) {
  std::vector<std::string> changed;
  for (const ValueChange& effect : result.effects)
    if (effect.significant) changed.push_back(effect.name);
  return changed;
}

/// A parameter that moved is what was measured, not why: only effects are causes.
AlarmCause CauseOf(const ChangeResult& result) {
  switch (result.after.explanation.verdict) {
    case Verdict::kNamed: {
      std::vector<std::string> effects = result.appeared;
      if (effects.empty()) effects = ChangedEffects(result);
      if (!effects.empty()) return {CauseKind::kNamed, std::move(effects)};
      break;
    }
    case Verdict::kAmbiguous:
      return {CauseKind::kSeveral, result.after.explanation.set};
    case Verdict::kAdequate:
      if (auto effects = ChangedEffects(result); !effects.empty())
        return {CauseKind::kNamed, std::move(effects)};
      break;
    case Verdict::kUnknown:
      break;
  }
  return {CauseKind::kNotKnown, {}};
}

}  // namespace

FindingExplanation ExplainFinding(const Database& database, const std::string& path,
                                  const std::string& machine, std::int64_t machine_id,
                                  const drift::DriftFinding& finding, std::int64_t first_healthy,
                                  std::int64_t end) {
  // Strokes in the interval of the change belong to neither side.
  const std::int64_t healthy_end = std::min(finding.since.low, finding.since.last_before) + 1;
  const std::int64_t changed = std::max(finding.since.high, finding.since.last_before) + 1;
  const HistoryPart before{machine, machine_id, std::max(first_healthy, healthy_end - kMostStrokesCompared),
                           healthy_end};
  const HistoryPart after{machine, machine_id, changed, std::min(end, changed + kMostStrokesCompared)};
  const std::string strokes =
      fmt::format("{} to {} against {} to {}", after.first, after.last - 1, before.first, before.last - 1);
  const auto result = ExplainChange(database, path, before, after);
  if (!result)
    return {fmt::format("Strokes {} could not be compared: {}.", strokes, result.error().text), false, {}};
  const Verdict verdict = result->after.explanation.verdict;
  const bool episodes = InEpisodes(*result->after.log.model->kind);
  return {fmt::format("{} {}: {}.", episodes ? "Episodes" : "Strokes", strokes, Sentence(*result)),
          verdict == Verdict::kNamed || verdict == Verdict::kAdequate, CauseOf(*result)};
}

}  // namespace hydroscope
