#include "monitor/finding_explanation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/contains.h"
#include "core/interval_text.h"
#include "core/unit_told.h"
#include "diagnosis/doubts.h"
#include "diagnosis/drift/drift_thresholds.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "models/parameter_unit.h"
#include "workbench/explain/explain_change.h"
#include "workbench/explain/what_to_record.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kMostStrokesCompared = 300;  ///< on either side

std::vector<Told> SizesThatAppeared(const ChangeResult& result) {
  const Explanation& after = result.after.explanation;
  std::vector<Told> sizes;
  for (auto k = static_cast<std::size_t>(after.started); k < after.final.effects.size(); ++k) {
    const EffectEstimate& e = after.final.effects[k];
    const Effect& effect = result.after.effect(e.choice.effect);
    sizes.push_back(Tell("{} ({} = {})", "{} ({} = {})", effect.id, effect.parameter,
                         TellNumber(ShownWithInterval(e.size, e.std, effect.unit))));
  }
  return sizes;
}

std::vector<Told> Moved(const ChangeResult& result) {
  const MachineKind& kind = KindOf(result.after.log.machine);
  std::vector<Told> moved;
  for (const auto* values : {&result.parameters, &result.effects})
    for (const ValueChange& v : *values)
      if (v.significant)
        moved.push_back(Tell("{} {} -> {}", "{} {} -> {}", v.name,
                             TellNumber(ParameterWithInterval(kind, v.name, v.before, v.before_std, v.unit)),
                             TellNumber(ParameterWithInterval(kind, v.name, v.after, v.after_std, v.unit))));
  return moved;
}

Told ErrorText(const ChangeResult& result) {
  const Explanation& after = result.after.explanation;
  const DisplayUnit unit = OutputUnit(result.after.log.machine);
  if (after.steps.size() < 2) return {};
  return Tell("; error on strokes left out {:.3g} -> {:.3g} {}",
              "; Fehler auf ausgelassenen Hüben {:.3g} -> {:.3g} {}", after.base.rms_holdout * unit.factor,
              after.final.rms_holdout * unit.factor, UnitTold(unit.name));
}

Told MovedTold(const std::vector<Told>& moved) {
  return Tell("moved: {}", "bewegt haben sich: {}", Joined(moved));
}

/// What no parameters that stay take away, of episodes.
Told WhatGoesOn(const ChangeResult& result, const drift::DriftFinding& finding) {
  if (!result.after.EachAlone())
    return Tell(
        "no parameters that stay as they are over these episodes take that away: one is still "
        "moving, or an effect is missing",
        "keine Parameter, die über diese Episoden bleiben, nehmen das weg: einer bewegt "
        "sich noch, oder ein Effekt fehlt");
  std::vector<Told> names;
  for (const drift::FindingPart& part : finding.parts)
    names.push_back(part.title.empty() ? Told(part.quantity) : part.title);
  return Tell("parameters of its own describe each of them down to the sensor noise: {} goes on moving",
              "eigene Parameter beschreiben jede bis auf das Sensorrauschen: {} bewegt sich weiter",
              names.empty() ? Tell("one", "einer") : Joined(names));
}

/// Of episodes, whose effects are tried on logs alone.
Told SentenceOfEpisodes(const ChangeResult& result, const drift::DriftFinding& finding) {
  const auto moved = Moved(result);
  const bool adequate = result.after.explanation.verdict == Verdict::kAdequate;
  const Told worse =
      adequate ? Told{} : Tell("the model errs more than before; ", "das Modell irrt mehr als zuvor; ");
  const Told what = !moved.empty() ? MovedTold(moved)
                    : adequate     ? Tell("no parameter moved beyond its interval",
                                          "kein Parameter hat sich über sein Intervall hinaus bewegt")
                                   : WhatGoesOn(result, finding);
  return Tell("{}{}; which effect it is, `hydroscope explain` with the logs says",
              "{}{}; welcher Effekt es ist, sagt `hydroscope explain` mit den Aufzeichnungen", worse, what);
}

Told Sentence(const ChangeResult& result, const drift::DriftFinding& finding) {
  if (InEpisodes(*result.after.log.model->kind)) return SentenceOfEpisodes(result, finding);
  const auto appeared = SizesThatAppeared(result);
  const auto moved = Moved(result);
  const Told also = moved.empty() ? Told{} : Tell("; {}", "; {}", MovedTold(moved));
  const Told why = WhyNotProven(result.after.explanation);
  const Told doubt = why.empty() ? Told{} : Tell("; not proven: {}", "; nicht bewiesen: {}", why);
  switch (result.after.explanation.verdict) {
    case Verdict::kAdequate:
      return moved.empty()
                 ? Tell("no effect of the library appeared and no parameter moved beyond its interval",
                        "kein Effekt der Bibliothek ist aufgetreten, und kein Parameter hat sich über "
                        "sein Intervall hinaus bewegt")
                 : Tell("no effect of the library appeared{}", "kein Effekt der Bibliothek ist aufgetreten{}",
                        also);
    case Verdict::kNamed:
      return Tell("{}{}{}{}", "{}{}{}{}",
                  appeared.empty() ? Tell("nothing new appeared", "nichts Neues ist aufgetreten")
                  : why.empty()    ? Tell("appeared: {}", "aufgetreten: {}", Joined(appeared))
                                   : Tell("nearest: {}", "am nächsten kommt: {}", Joined(appeared)),
                  also, ErrorText(result), doubt);
    case Verdict::kAmbiguous: {
      const std::string set = fmt::format("{}", fmt::join(result.after.explanation.set, ", "));
      return Tell("{}{}{}{}", "{}{}{}{}",
                  why.empty()
                      ? Tell("one of these appeared and the strokes cannot tell which: {}",
                             "eines von diesen ist aufgetreten, und die Hübe sagen nicht welches: {}", set)
                      : Tell("nearest: {}", "am nächsten kommen: {}", set),
                  also, ErrorText(result), doubt);
    }
    case Verdict::kUnknown:
      return Tell("the model errs more than before and no effect of the library explains it{}",
                  "das Modell irrt mehr als zuvor, und kein Effekt der Bibliothek erklärt es{}", also);
  }
  return {};
}

/// Effects that were in the model and grew or shrank.
std::vector<std::string> ChangedEffects(const ChangeResult& result) {
  std::vector<std::string> changed;
  for (const ValueChange& effect : result.effects)
    if (effect.significant) changed.push_back(effect.name);
  return changed;
}

/// A parameter that moved is what was measured, not why: only effects are causes. One whose size moved while `explain` says
/// that nothing appeared, as the model had erred before already, is proven no more than one that is in doubt.
AlarmCause CauseOf(const ChangeResult& result) {
  const Explanation& after = result.after.explanation;
  AlarmCause cause;
  switch (after.verdict) {
    case Verdict::kNamed:
      cause = {CauseKind::kNamed, result.appeared.empty() ? ChangedEffects(result) : result.appeared};
      break;
    case Verdict::kAmbiguous:
      cause = {CauseKind::kSeveral, after.set};
      break;
    case Verdict::kAdequate:
      cause = {CauseKind::kNotProven, ChangedEffects(result)};
      break;
    case Verdict::kUnknown:
      break;
  }
  if (cause.effects.empty()) return {CauseKind::kNotKnown, {}};
  if (!WhyNotProven(after).empty()) {
    cause.kind = CauseKind::kNotProven;
    for (const std::string& id : after.untried)
      if (!Contains(cause.effects, id)) cause.effects.push_back(id);
  }
  return cause;
}

/// The effect that is proven to have appeared, where it is one that the finding's own rule is not about; nullptr if there is none.
const Effect* OtherCause(const ChangeResult& result, const drift::DriftFinding& finding) {
  const Explanation& after = result.after.explanation;
  if (after.verdict != Verdict::kNamed || !WhyNotProven(after).empty() || result.appeared.size() != 1 ||
      result.appeared.front() == finding.rule)
    return nullptr;
  return result.after.FindEffect(result.appeared.front());
}

/// Tests in place of a repair, where the comparison does not prove what the finding's rule advises to repair; "" where it does, or
/// where it sees no cause and says what moved.
Told TestAdvice(const ChangeResult& result, const AlarmCause& cause) {
  constexpr std::size_t kMostTold = 2;  // rivals
  const Told log = Tell(
      "Record a log and see `hydroscope explain` of it, which tries what stored sums do not tell.",
      "Eine Aufzeichnung machen und `hydroscope explain` davon ansehen, das versucht, was gespeicherte Summen "
      "nicht zeigen.");
  if (result.after.explanation.verdict == Verdict::kUnknown)
    return Tell("What causes it is not known: no repair yet. {}",
                "Was es verursacht, ist nicht bekannt: noch keine Reparatur. {}", log);
  if (cause.kind != CauseKind::kNotProven) return {};
  Told tests;
  for (std::size_t k = 1; k < std::min(cause.effects.size(), 1 + kMostTold); ++k)
    tests =
        Tell("{}To tell {} from {}: {}. ", "{}Um {} von {} zu trennen: {}. ", tests, cause.effects.front(),
             cause.effects[k], WhatTellsApart(result.after, cause.effects.front(), cause.effects[k]));
  return Tell("The cause is not proven: no repair yet. {}{}",
              "Die Ursache ist nicht bewiesen: noch keine Reparatur. {}{}", tests, log);
}

/// What a finding is called, and what to do, in place of its rule's words; empty: these stand.
struct OtherWords {
  Told title, advice;
};

OtherWords WordsBeside(const ChangeResult& result, const drift::DriftFinding& finding) {
  if (const Effect* other = OtherCause(result, finding))
    return {{other->title, other->german.title}, {other->plain, other->german.plain}};
  if (InEpisodes(*result.after.log.model->kind)) return {};
  std::vector<std::string> moved;
  for (const auto* values : {&result.parameters, &result.effects})
    for (const ValueChange& v : *values)
      if (v.significant) moved.push_back(v.name);
  const AlarmCause cause = CauseOf(result);
  const Verdict verdict = result.after.explanation.verdict;
  if (verdict == Verdict::kNamed && cause.kind != CauseKind::kNotProven) return {};
  Told title = TitleBeside(finding, verdict, cause.effects, moved);
  if (title.empty()) return {};
  return {std::move(title), Tell("See `hydroscope explain` of the strokes since the change.",
                                 "`hydroscope explain` der Hübe seit der Änderung ansehen.")};
}

}  // namespace

Told TitleBeside(const drift::DriftFinding& finding, Verdict verdict, const std::vector<std::string>& set,
                 const std::vector<std::string>& moved) {
  const bool seen =
      std::ranges::any_of(finding.parts, [&](const auto& part) { return Contains(moved, part.quantity); });
  if (finding.rule.empty() || seen) return {};
  if (verdict == Verdict::kAmbiguous && !Contains(set, finding.rule))
    return Tell("Change that several effects would explain; first taken for: {}",
                "Änderung, die mehrere Effekte erklären würden; zuerst gehalten für: {}", finding.name);
  if (verdict == Verdict::kNamed && !set.empty() && !Contains(set, finding.rule))
    return Tell("Change that other effects would explain; first taken for: {}",
                "Änderung, die andere Effekte erklären würden; zuerst gehalten für: {}", finding.name);
  if (verdict == Verdict::kAdequate && !moved.empty())
    return Tell("Change that comparing strokes finds in {}; first taken for: {}",
                "Änderung, die der Vergleich der Hübe in {} findet; zuerst gehalten für: {}",
                fmt::to_string(fmt::join(moved, ", ")), finding.name);
  return {};
}

std::int64_t EndOfHealthy(const drift::DriftFinding& finding,
                          const std::vector<drift::DriftFinding>& findings) {
  // Strokes in the interval of a change belong to neither side.
  const auto before = [](const drift::DriftFinding& f) {
    return std::min(f.since.low, f.since.last_before) + 1;
  };
  std::int64_t end = before(finding);
  for (const drift::DriftFinding& other : findings)
    if (!other.parts.empty() && other.state != drift::FindingState::kGone &&
        finding.since.last_before <= other.found + drift::kDriftThresholds.most_to_explain)
      end = std::min(end, before(other));
  return end;
}

drift::FindingExplanation ExplainFinding(const Database& database, const std::string& path,
                                         const std::string& machine, std::int64_t machine_id,
                                         const drift::DriftFinding& finding, std::int64_t first_healthy,
                                         std::int64_t healthy_end, std::int64_t end) {
  const std::int64_t changed = std::max(finding.since.high, finding.since.last_before) + 1;
  const HistoryPart before{machine, machine_id, std::max(first_healthy, healthy_end - kMostStrokesCompared),
                           healthy_end};
  const HistoryPart after{machine, machine_id, changed, std::min(end, changed + kMostStrokesCompared)};
  const Told strokes = Tell("{} to {} against {} to {}", "{} bis {} gegen {} bis {}", after.first,
                            after.last - 1, before.first, before.last - 1);
  const auto result = ExplainChange(database, path, before, after);
  if (!result)
    return {Tell("{} {} could not be compared: {}.", "{} {} ließen sich nicht vergleichen: {}.",
                 CountedWordsIn(path, machine).Several(), strokes, result.error().text),
            false,
            true,
            {},
            {},
            {}};
  const Verdict verdict = result->after.explanation.verdict;
  const bool episodes = InEpisodes(*result->after.log.model->kind);
  OtherWords other = WordsBeside(*result, finding);
  const AlarmCause cause = CauseOf(*result);
  if (Told test = TestAdvice(*result, cause); !test.empty()) other.advice = std::move(test);
  return {Tell("{} {}: {}.", "{} {}: {}.", episodes ? Tell("Episodes", "Episoden") : Tell("Strokes", "Hübe"),
               strokes, Sentence(*result, finding)),
          (verdict == Verdict::kNamed && WhyNotProven(result->after.explanation).empty()) ||
              verdict == Verdict::kAdequate,
          verdict != Verdict::kUnknown,
          cause,
          std::move(other.title),
          std::move(other.advice)};
}

}  // namespace hydroscope
