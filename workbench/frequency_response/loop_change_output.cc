#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/interval_text.h"
#include "core/short_number.h"
#include "models/closed_loop.h"
#include "models/machine_kind.h"
#include "workbench/frequency_response/loop_change.h"

namespace hydroscope {
namespace {

bool MovesDelay(const LoopChange& change) { return change.direction.back() != 0; }

/// Times a factor, or by some ms.
std::string SizeText(const SizedChange& sized) {
  if (MovesDelay(*sized.change))
    return WithInterval(1e3 * std::abs(sized.size), kNormal95 * 1e3 * sized.std) +
           (sized.size < 0 ? " ms shorter" : " ms longer");
  const double factor = std::exp(sized.size);
  return WithInterval(factor, kNormal95 * factor * sized.std) + " times";
}

std::vector<std::string_view> IdsOf(const LoopComparison& comparison) {
  std::vector<std::string_view> ids;
  if (comparison.verdict != LoopComparison::Verdict::kUnknown)
    for (const SizedChange& sized : comparison.set.changes) ids.push_back(sized.change->id);
  if (comparison.limit_appeared) ids.push_back(comparison.plant->limit.id);
  return ids;
}

/// Of a parameter: relative, of a delay in s.
double ChangeOf(const LoopComparison& comparison, std::size_t i) {
  const double before = comparison.before.parameters[i], after = comparison.after.parameters[i];
  return comparison.plant->parameters[i].kind == LoopParameter::Kind::kDelay ? after - before
                                                                             : after / before - 1;
}

std::string ParameterTable(const LoopComparison& comparison, const MachineKind& kind) {
  std::string text = fmt::format("  {:<8} {:>22} {:>22} {:>10}\n", "", "before", "now", "change");
  for (std::size_t i = 0; i < kind.parameters.size(); ++i) {
    const LoopParameter& parameter = comparison.plant->parameters[i];
    const bool delay = parameter.kind == LoopParameter::Kind::kDelay;
    const auto shown = [&](const LoopState& state) {
      const auto at = static_cast<std::ptrdiff_t>(i);
      const double value = state.parameters[i] * parameter.factor;
      const double std = std::sqrt(state.covariance(at, at)) * (delay ? parameter.factor : std::abs(value));
      return std > 0 ? WithInterval(value, kNormal95 * std) : ShortNumber(value, 4);
    };
    const double change = ChangeOf(comparison, i) * (delay ? parameter.factor : 100);
    text += fmt::format("  {:<8} {:>22} {:>22} {:>+8.2f} {} {}\n", parameter.name, shown(comparison.before),
                        shown(comparison.after), change, delay ? parameter.unit : "%",
                        delay || parameter.unit.empty() ? "" : fmt::format("  {}", parameter.unit));
  }
  return text;
}

std::string SetText(const LoopChangeSet& set) {
  std::vector<std::string> members;
  for (const SizedChange& sized : set.changes)
    members.push_back(fmt::format("{} ({} {})", sized.change->id, sized.change->quantity, SizeText(sized)));
  return fmt::format("{}", fmt::join(members, ", "));
}

std::string VerdictText(const LoopComparison& comparison) {
  const LoopChangeSet& set = comparison.set;
  std::string text;
  switch (comparison.verdict) {
    case LoopComparison::Verdict::kAdequate:
      return fmt::format(
          "adequate: nothing changed beyond the errors of the records and what {:g} % of repeatability explains\n",
          100 * comparison.plant->repeatability);
    case LoopComparison::Verdict::kNamed:
    case LoopComparison::Verdict::kAmbiguous:
      for (const SizedChange& sized : set.changes)
        text += fmt::format("named: {}\n  {}: {}\n  {}\n", sized.change->id, sized.change->quantity,
                            SizeText(sized), sized.change->sentence);
      if (!set.changes.empty() && !comparison.poles_unknown)
        text += fmt::format(
            "Nothing else changed: what is left is within the errors (chi^2 {:.1f} at {} degrees of freedom).\n",
            set.chi_squared, set.degrees_of_freedom);
      if (comparison.verdict == LoopComparison::Verdict::kAmbiguous) {
        text = "ambiguous: these records do not tell apart\n  " + SetText(set) + "\n";
        for (const LoopChangeSet& other : comparison.others) text += "  " + SetText(other) + "\n";
        text += "Record longer, or look at what tells them apart.\n";
      }
      for (const LoopChangeSet& imitator : comparison.imitators)
        text += fmt::format("At once, these would look the same: {}.\n", SetText(imitator));
      return text;
    case LoopComparison::Verdict::kUnknown:
      if (comparison.reversed)
        return fmt::format(
            "unknown: {} or {} is reversed between the records: check wiring and sign; nothing else is compared before\n",
            comparison.plant->output, comparison.plant->input);
      if (comparison.dead_band)
        return "unknown: one of the records alone shows a dead band, or friction that does not grow with speed (see the "
               "note): its figures go with the excitation, and what else changed is not said\n";
      if (comparison.readings_end)
        return fmt::format(
            "unknown: readings of {} end in one of the records alone (see the note), which may be all that changed; "
            "nearest: {}\n",
            comparison.plant->input, set.changes.empty() ? "none" : SetText(set));
      if (comparison.poles_unknown && set.changes.empty())
        return "unknown: gain and delay did not change; whether the poles did, these records do not say\n";
      return fmt::format("unknown: no set of changes that are known leads there; nearest: {}\n",
                         set.changes.empty() ? "none" : SetText(set));
  }
  return text;
}

nlohmann::json SetJson(const LoopChangeSet& set) {
  nlohmann::json sizes = nlohmann::json::object();
  std::vector<std::string_view> ids;
  for (const SizedChange& sized : set.changes) {
    ids.push_back(sized.change->id);
    const bool delay = MovesDelay(*sized.change);
    const double factor = std::exp(sized.size);
    sizes[std::string(sized.change->id)] = {{"value", delay ? sized.size : factor},
                                            {"std", delay ? sized.std : factor * sized.std},
                                            {"unit", delay ? "s" : "1"}};
  }
  return {{"set", ids}, {"chi_squared", set.chi_squared}, {"p_value", set.p_value}, {"parameters", sizes}};
}

/// What can happen to the plant, by id: what changes then, and what to look at.
nlohmann::json KnownChangesJson(const ClosedLoopPlant& plant) {
  std::vector<const LoopChange*> all{&plant.limit};
  for (const LoopChange& change : plant.changes) all.push_back(&change);
  nlohmann::json known = nlohmann::json::object();
  for (const LoopChange* change : all)
    known[std::string(change->id)] = {
        {"quantity", change->quantity.english},
        {"sentence", change->sentence.english},
        {"german", {{"quantity", change->quantity.german}, {"sentence", change->sentence.german}}}};
  return known;
}

std::vector<Told> WarningsOfChange(const LoopChangeResult& result) {
  std::vector<Told> warnings = result.after.response.warnings;
  for (const Told& text : RowWarnings(result.after.log)) warnings.push_back(text);
  return warnings;
}

}  // namespace

std::string LoopChangeText(const LoopChangeResult& result) {
  const LoopComparison& comparison = result.comparison;
  std::string text = fmt::format("What changed from {} to {}\n",
                                 result.since.empty() ? "the references of the machine file" : result.since,
                                 result.after.name);
  text += ParameterTable(comparison, KindOf(result.machine)) + "\n";
  const LoopChange& limit = comparison.plant->limit;
  if (comparison.limit_appeared)
    text += fmt::format("named: {}\n  {}: up to {:.3g} {}\n  {}\n", limit.id, limit.quantity,
                        *comparison.after.input_limit, comparison.plant->input_unit, limit.sentence);
  if (comparison.limit_went) text += fmt::format("{}: no longer limited\n", limit.quantity);
  const bool only_limit = comparison.limit_appeared && comparison.set.changes.empty() &&
                          comparison.verdict == LoopComparison::Verdict::kNamed;
  if (only_limit)
    text += comparison.poles_unknown ? "" : "Nothing else changed.\n";
  else
    text += VerdictText(comparison);
  if (comparison.poles_unknown)
    text +=
        "The poles are not told apart in one of the records, changes of them are not seen: record longer, or excite more.\n";
  for (const Told& warning : WarningsOfChange(result)) text += fmt::format("Note: {}\n", warning.english);
  return text;
}

nlohmann::json LoopChangeJson(const LoopChangeResult& result) {
  const LoopComparison& comparison = result.comparison;
  const MachineKind& kind = KindOf(result.machine);
  const std::vector<Told> warnings = WarningsOfChange(result);
  nlohmann::json json = {{"verdict", VerdictName(comparison.verdict)},
                         {"set", IdsOf(comparison)},
                         {"since", result.since},
                         {"log", result.after.name},
                         {"changes", SetJson(comparison.set)["parameters"]},
                         {"ranking", nlohmann::json::array()},
                         {"others", nlohmann::json::array()},
                         {"imitators", nlohmann::json::array()},
                         {"unseen", nlohmann::json::object()},
                         {"parameters", nlohmann::json::object()},
                         {"input_limit", nullptr},
                         {"reversed", comparison.reversed},
                         {"dead_band", comparison.dead_band},
                         {"readings_end", comparison.readings_end},
                         {"poles_unknown", comparison.poles_unknown},
                         {"known", KnownChangesJson(*comparison.plant)},
                         {"warnings", InEnglish(warnings)},
                         {"german", {{"warnings", InGerman(warnings)}}}};
  if (comparison.after.input_limit) json["input_limit"] = *comparison.after.input_limit;
  for (const LoopChangeSet& single : comparison.singles) {
    nlohmann::json one = SetJson(single);
    one["effect"] = one["set"].front();
    one.erase("set");
    json["ranking"].push_back(std::move(one));
  }
  for (const SizedChange& sized : comparison.unseen)
    json["unseen"][std::string(sized.change->id)] = {
        {"value", MovesDelay(*sized.change) ? sized.size : std::exp(sized.size)},
        {"unit", MovesDelay(*sized.change) ? "s" : "1"}};
  for (const LoopChangeSet& other : comparison.others) json["others"].push_back(SetJson(other));
  for (const LoopChangeSet& imitator : comparison.imitators) json["imitators"].push_back(SetJson(imitator));
  for (std::size_t i = 0; i < kind.parameters.size(); ++i) {
    const auto at = static_cast<std::ptrdiff_t>(i);
    const bool delay = comparison.plant->parameters[i].kind == LoopParameter::Kind::kDelay;
    const auto of = [&](const LoopState& state) -> nlohmann::json {
      const double scale = delay ? 1 : std::abs(state.parameters[i]);
      return {{"value", state.parameters[i]}, {"std", scale * std::sqrt(state.covariance(at, at))}};
    };
    json["parameters"][std::string(kind.parameters[i].name)] = {{"before", of(comparison.before)},
                                                                {"after", of(comparison.after)},
                                                                {"unit", kind.parameters[i].si},
                                                                {"change", ChangeOf(comparison, i)},
                                                                {"relative", !delay}};
  }
  return json;
}

}  // namespace hydroscope
