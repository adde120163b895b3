#include "workbench/history/history_output.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/interval_text.h"
#include "core/relative_change.h"
#include "core/short_number.h"
#include "diagnosis/doubts.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "models/parameter_unit.h"
#include "workbench/explain/explain_output.h"
#include "workbench/fit_output.h"

namespace hydroscope {
namespace {

nlohmann::json MachinesJson(const StrokeHistory& history) {
  nlohmann::json out = nlohmann::json::array();
  for (const HistoryPart& part : history.parts)
    out.push_back({{"machine", part.machine},
                   {"first", part.first},
                   {"last", part.last - 1},
                   {"strokes", part.strokes()}});
  return out;
}

/// The model that explains a set of strokes.
nlohmann::json SideJson(const StrokeHistory& history, const ExplainResult& result) {
  const Explanation& x = result.explanation;
  const double factor = OutputUnit(result.log.machine).factor;
  std::vector<Estimate> estimates =
      BaseParameters(*result.log.model, x.final, static_cast<int>(history.units.size()));
  MarkConfounded(result.extended_confounded, estimates);
  nlohmann::json parameters = ParametersJson(estimates);
  AddConfoundings(result.extended_confounded, parameters);
  nlohmann::json effects = nlohmann::json::object();
  for (const EffectEstimate& e : x.final.effects) {
    const Effect& effect = result.effect(e.choice.effect);
    effects[effect.id] = {{"value", e.size}, {"std", e.std}, {"unit", effect.unit}};
  }
  return {{"machines", MachinesJson(history)},
          {"strokes", history.strokes()},
          {"rms_holdout", x.final.rms_holdout * factor},
          {"noise_floor", x.final.noise_floor * factor},
          {"excess_ratio", x.final.excess_ratio},
          {"parameters", std::move(parameters)},
          {"effects", effects}};
}

nlohmann::json ValuesJson(const std::vector<ValueChange>& values) {
  nlohmann::json out = nlohmann::json::object();
  for (const ValueChange& v : values)
    out[v.name] = {{"unit", v.unit},
                   {"before", {{"value", v.before}, {"std", v.before_std}}},
                   {"after", {{"value", v.after}, {"std", v.after_std}}},
                   {"change", {{"value", v.change()}, {"std", v.std()}}},
                   {"significant", v.significant}};
  return out;
}

std::string ValuesText(const MachineKind& kind, const std::string& title,
                       const std::vector<ValueChange>& values) {
  if (values.empty()) return "";
  std::string text = fmt::format("\n{}\n", title);
  std::size_t width = 6;
  for (const ValueChange& v : values) width = std::max(width, v.name.size());
  for (const ValueChange& v : values) {
    const ShownParameter before = ShowParameter(kind, v.name, v.before, v.before_std, v.unit);
    const ShownParameter after = ShowParameter(kind, v.name, v.after, v.after_std, v.unit);
    text += fmt::format("{} {:<{}} {:>19} -> {:>19} {}", v.significant ? "*" : " ", v.name, width,
                        before.numbers, after.numbers, after.unit);
    if (const auto share = RelativeChange(v.before, v.before_std, v.change());
        share && v.unit != "1" && ToldInPercent(kind, v.name, v.unit))
      text += fmt::format("  {:+.1f} %", 100 * *share);
    text += "\n";
  }
  return text;
}

std::string ChangedEffectsText(const ChangeResult& result) {
  std::string text;
  for (const std::string& id : result.after.explanation.set)
    if (const Effect* effect = result.after.FindEffect(id))
      text += fmt::format("  {} ({})\n", effect->title, id) +
              (effect->plain.empty() ? "" : "    " + effect->plain + "\n");
  return text;
}

bool AnyMoved(const ChangeResult& result) {
  const auto moved = [](const ValueChange& v) { return v.significant; };
  return std::ranges::any_of(result.parameters, moved) || std::ranges::any_of(result.effects, moved);
}

/// What explains part of an error whose cause is not named.
std::string NearestText(const Explanation& after) {
  if (after.steps.size() < 2 || !(after.base.excess_ratio > 0)) return "";
  std::vector<std::string> added;
  for (std::size_t k = 1; k < after.steps.size(); ++k) added.push_back(after.steps[k].added);
  return fmt::format(
      "Nearest, and not proven: {} would explain {:.0f} % of the model error's energy. Stored strokes hold "
      "laws with a threshold, a place or a delay at a few values only: explain a log recorded since.\n",
      fmt::join(added, " and "), 100 * (1 - after.final.excess_ratio / after.base.excess_ratio));
}

/// Of episodes of a machine with states that no parameters which stay describe.
std::string EpisodesText(const ChangeResult& result) {
  if (!result.after.EachAlone())
    return "UNKNOWN: the model errs more than before, and no parameters that stay as they are over these "
           "episodes take that away: one is still moving, or an effect is missing. 'hydroscope trends' shows "
           "what moves, 'hydroscope explain' with the logs which effect it is.\n";
  std::vector<std::string> moved;
  for (const ValueChange& v : result.parameters)
    if (v.significant) moved.push_back(v.name);
  return fmt::format(
      "UNKNOWN cause: {} changed and goes on changing. Parameters of its own describe each episode down to the "
      "sensor noise, none that stay describe all of them. 'hydroscope trends' shows the course, 'hydroscope "
      "explain' with the logs which effect it is.\n",
      moved.empty() ? "a parameter" : fmt::format("{}", fmt::join(moved, " and ")));
}

std::string VerdictText(const ChangeResult& result) {
  const bool proven = WhyNotProven(result.after.explanation).empty();
  switch (result.after.explanation.verdict) {
    case Verdict::kAdequate:
      return AnyMoved(result) ? "ADEQUATE: no physical effect appeared; what is marked * below moved.\n"
                              : fmt::format("ADEQUATE: nothing changed between these {} that stands out.\n",
                                            CountedWordsOf(result.after.log.machine).many);
    case Verdict::kNamed:
      return (proven ? "NAMED: this appeared or changed.\n"
                     : "NAMED, NOT PROVEN: this, or a relative of it, appeared or changed.\n") +
             ChangedEffectsText(result);
    case Verdict::kAmbiguous:
      return fmt::format(
                 "AMBIGUOUS{}: something appeared or changed, and these {} cannot tell which of these it is, best first.\n",
                 proven ? "" : ", NOT PROVEN", CountedWordsOf(result.after.log.machine).many) +
             ChangedEffectsText(result);
    case Verdict::kUnknown:
      if (KindOf(result.after.log.machine).has_states) return EpisodesText(result);
      return "UNKNOWN: the model errs more than before, and no effect of the library explains it.\n" +
             NearestText(result.after.explanation);
  }
  return "";
}

}  // namespace

std::string HistoryLine(const StrokeHistory& history) {
  std::string text;
  const CountedWords counted = CountedWordsOf(history.machine);
  for (const HistoryPart& part : history.parts)
    text += part.strokes() == 0
                ? fmt::format("{}: no {}.\n", part.machine, counted.many)
                : fmt::format("{}: {} {} to {}.\n", part.machine, counted.many, part.first, part.last - 1);
  if (history.strokes_per_unit() > 1)
    text += fmt::format("{} {}, judged as {} groups of up to {}.\n", history.strokes(), counted.many,
                        history.units.size(), history.strokes_per_unit());
  return text;
}

nlohmann::json HistoryJson(const StrokeHistory& history, const ExplainResult& result) {
  nlohmann::json out = ExplainJson(result);
  out["strokes"] = out["strokes_in_log"] = history.strokes();
  out["database"] = history.database;
  out["machines"] = MachinesJson(history);
  out["units"] = history.units.size();
  out["strokes_per_unit"] = history.strokes_per_unit();
  return out;
}

std::string ChangeText(const ChangeResult& result) {
  const Explanation &before = result.before.explanation, &after = result.after.explanation;
  const DisplayUnit unit = OutputUnit(result.after.log.machine);
  const CountedWords counted = CountedWordsOf(result.after.log.machine);
  const auto shown = [&](double rms) { return ShortNumber(rms * unit.factor); };
  std::string text = VerdictText(result);
  if (!after.doubt.empty()) text += fmt::format("Not proven: {}.\n", after.doubt.english);
  text += fmt::format("Before:\n{}After:\n{}", result.before.described, result.after.described);
  if (result.newest > 0)
    text += fmt::format("What appeared went on changing: explained on the newest {} of these {}.\n",
                        result.newest, counted.many);
  text += fmt::format(
      "\nError on {} left out, {}\n"
      "  before, with the model that explains them {:>8}   sensor noise alone {}\n"
      "  after, with the same model                {:>8}   sensor noise alone {}\n",
      counted.many, unit.name, shown(before.final.rms_holdout), shown(before.final.noise_floor),
      shown(after.base.rms_holdout), shown(after.base.noise_floor));
  if (after.steps.size() > 1)
    text +=
        fmt::format("  after, with what appeared                 {:>8}\n", shown(after.final.rms_holdout));
  const MachineKind& kind = KindOf(result.after.log.machine);
  const bool tolerances = std::ranges::any_of(result.after.log.machine.geometry,
                                              [](const auto& known) { return known.second.std > 0; });
  text += ValuesText(kind,
                     fmt::format("Parameters before and after, ± 95 %{}; * moved",
                                 tolerances ? " without the tolerances of the geometry" : ""),
                     result.parameters);
  for (const auto& [when, side] : {std::pair("before", &result.before), {"after", &result.after}})
    if (const std::string names = ConfoundedNames(side->extended_confounded); !names.empty())
      text += fmt::format("NOT IDENTIFIABLE {}: {}\n", when, names);
  text += ValuesText(kind, "Effects that were there before", result.effects);
  for (std::size_t k = static_cast<std::size_t>(after.started); k < after.final.effects.size(); ++k) {
    const EffectEstimate& e = after.final.effects[k];
    const Effect& effect = result.after.effect(e.choice.effect);
    text += fmt::format("{}  {:<28} {} = {}\n",
                        k == static_cast<std::size_t>(after.started) ? "\nAppeared\n" : "", effect.id,
                        effect.parameter, ShownWithInterval(e.size, e.std, effect.unit));
  }
  if (!before.no_verdict.empty())
    text += fmt::format("\nOf the model as it was before: {}.\n", before.no_verdict.english);
  else if (before.verdict != Verdict::kAdequate)
    text += fmt::format(
        "\nBefore, the model missed something already (verdict {}): see 'hydroscope explain' with --to.\n",
        VerdictName(before.verdict));
  return text;
}

nlohmann::json ChangeJson(const StrokeHistory& before, const StrokeHistory& after,
                          const ChangeResult& result) {
  nlohmann::json out = HistoryJson(after, result.after);
  out["change"] = {{"since", after.parts.front().first},
                   {"before", SideJson(before, result.before)},
                   {"after", SideJson(after, result.after)},
                   {"verdict_before", VerdictName(result.before.explanation.verdict)},
                   {"parameters", ValuesJson(result.parameters)},
                   {"effects", ValuesJson(result.effects)},
                   {"appeared", result.appeared},
                   {"newest_strokes", result.newest > 0 ? nlohmann::json(result.newest) : nlohmann::json()}};
  return out;
}

}  // namespace hydroscope
