#include "report/report_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/relative_change.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "report/error_words.h"
#include "report/heard_alarms.h"
#include "report/svg_text.h"

namespace hydroscope {
namespace {

std::string PText(const TestedValue& tested) {
  return tested.p < 0.001 ? "p &lt; 0.001" : fmt::format("p = {:.{}f}", tested.p, tested.p < 0.1 ? 3 : 2);
}

/// Changes of a parameter are told in % of `base` (SI) or in the unit.
struct Scale {
  double factor = 1;
  std::string unit;
};
Scale ScaleOf(const ParameterInfo& info, double base, double base_std, double change) {
  if (info.relative && RelativeChange(base, base_std, change)) return {100 / std::abs(base), "%"};
  return {info.factor, info.unit};
}
/// What goes with the oil and what does not are told in one scale; in % only if both are, and if the parameter did not
/// begin near zero.
Scale ScaleOf(const ParameterInfo& info, const ParameterAnalysis& analysis) {
  const OilDependence& oil = analysis.oil;
  const double std = oil.line.coefficients.empty() ? 0 : oil.line.coefficients[0].std;
  std::vector<Scale> scales = {ScaleOf(info, oil.value_at_mean, std, oil.explained)};
  if (oil.beyond.Known()) scales.push_back(ScaleOf(info, oil.value_at_mean, std, oil.beyond.value));
  if (const ThirdsComparison& change = analysis.change; change.change.Known())
    scales.push_back(ScaleOf(info, change.first, change.first_std, change.change.value));
  const auto in_unit = std::ranges::find_if(scales, [](const Scale& s) { return s.unit != "%"; });
  return in_unit == scales.end() ? scales.front() : *in_unit;
}

/// "+3.6 ± 0.3 %".
std::string Signed(double value, double half_width, const Scale& scale, const std::string& per = "") {
  const double shown = value * scale.factor, half = half_width * scale.factor;
  const int decimals = DecimalsFor(shown, half);
  const std::string width = std::isfinite(half) && half > 0 ? " ± " + FormatFixed(half, decimals) : "";
  return FormatSigned(shown, decimals) + width + " " + EscapeText(scale.unit) + per;
}
std::string Signed(const TestedValue& tested, const Scale& scale, const std::string& per = "") {
  return Signed(tested.value, tested.HalfWidth(), scale, per);
}

std::string Unsigned(double value, const Scale& scale, const std::string& per = "") {
  const double shown = std::abs(value * scale.factor);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(std::max(shown, 1e-9)))), 0, 6);
  return FormatFixed(shown, decimals) + " " + EscapeText(scale.unit) + per;
}

std::string WithUnit(const std::string& number, const ParameterInfo& info) {
  return info.unit.empty() ? number : number + " " + EscapeText(info.unit);
}

/// "a change below 24 l would not be seen".
std::string NotSeenText(const ParameterAnalysis& analysis, const ParameterInfo& info) {
  return fmt::format("a change below {} would not be seen",
                     WithUnit(FormatShort(analysis.smallest_seen * std::abs(info.factor)), info));
}

std::string ChangeText(const ParameterAnalysis& analysis, const ParameterInfo& info,
                       const CountedWords& counted) {
  const ThirdsComparison& change = analysis.change;
  if (!change.change.Known() && analysis.version_since)
    return fmt::format(
        "not comparable: estimates before {} {} are of other versions of the model, and blocks of {} cannot be refitted with this one",
        counted.one, FormatCount(*analysis.version_since), counted.many);
  if (!change.change.Known())
    return fmt::format("too few {} to compare the ends of the record", counted.many);
  const Scale scale = ScaleOf(info, change.first, change.first_std, change.change.value);
  const std::string numbers = Signed(change.change, scale);
  switch (SignificanceOf(change.change)) {
    case Significance::kNone:
      if (analysis.cannot_tell)
        return fmt::format("{}: cannot be told; {}", numbers, NotSeenText(analysis, info));
      return fmt::format("{}: none that stands out ({})", numbers, PText(change.change));
    case Significance::kHint:
      return analysis.by_estimates
                 ? fmt::format(
                       "{} in the estimates plotted: a hint, which blocks of {} by themselves do not confirm",
                       numbers, counted.many)
                 : fmt::format("{}: a hint, not conclusive ({})", numbers, PText(change.change));
    case Significance::kClear:
      break;
  }
  const int decimals = DecimalsFor(info.Shown(change.first), change.change.HalfWidth() * info.factor);
  return fmt::format("{}: clear ({}), from {} to {}", numbers, PText(change.change),
                     FormatFixed(info.Shown(change.first), decimals),
                     WithUnit(FormatFixed(info.Shown(change.last), decimals), info));
}

std::string BeyondText(const OilDependence& oil, const Scale& scale) {
  if (!oil.separable)
    return fmt::format(
        " Oil temperature and time ran together (r² = {}): what is left at equal temperature cannot be told.",
        FormatFixed(oil.shared_with_time, 2));
  switch (SignificanceOf(oil.beyond)) {
    case Significance::kNone:
      return fmt::format(" At equal oil temperature the change left is {}: none that stands out.",
                         Signed(oil.beyond, scale));
    case Significance::kHint:
      return fmt::format(" At equal oil temperature {} are left: a hint ({}).", Signed(oil.beyond, scale),
                         PText(oil.beyond));
    case Significance::kClear:
      return fmt::format(" At equal oil temperature {} are left: clear ({}).", Signed(oil.beyond, scale),
                         PText(oil.beyond));
  }
  return "";
}

std::string OilText(const ParameterAnalysis& analysis, const ParameterInfo& info,
                    const CountedWords& counted) {
  const OilDependence& oil = analysis.oil;
  const Scale scale = ScaleOf(info, analysis);
  switch (oil.outcome) {
    case OilOutcome::kNone:
      return "";
    case OilOutcome::kNotMeasured:
      return "not measured";
    case OilOutcome::kTooFewStrokes:
      return fmt::format("too few {} to ask", counted.many);
    case OilOutcome::kOilHardlyMoved:
      return fmt::format("cannot be asked: averaged over blocks of {} the oil temperature moved by {} K only",
                         counted.many, FormatFixed(oil.warmest - oil.coldest, 1));
    case OilOutcome::kNotSeen:
      return fmt::format("no dependence seen: {} ({}); up to {} cannot be ruled out",
                         Signed(oil.slope, scale, "/K"), PText(oil.slope),
                         Unsigned(std::abs(oil.slope.value) + oil.slope.HalfWidth(), scale, "/K"));
    case OilOutcome::kNotInStep:
      return fmt::format(
          "it moved while the oil temperature moved, but not along a straight line, so "
          "the oil alone is a doubtful explanation.{}",
          oil.separable ? BeyondText(oil, scale) : "");
    case OilOutcome::kHint:
    case OilOutcome::kFollows:
      break;
  }
  const std::string lead =
      oil.outcome == OilOutcome::kFollows ? "moves with it" : "a hint that it moves with it";
  return fmt::format(
      "{}: {} ({}). {} by {} K from the first to the last third, which accounts for {}.{}", lead,
      Signed(oil.slope, scale, "/K"), PText(oil.slope),
      oil.warming >= 0 ? "The oil warmed" : "The oil cooled", FormatFixed(std::abs(oil.warming), 1),
      Signed(oil.explained, oil.slope.HalfWidth() * std::abs(oil.warming), scale), BeyondText(oil, scale));
}

std::string StrokesText(const LimitCheck& limits, const CountedWords& counted) {
  return fmt::format("{} {}, first {} {}", FormatCount(limits.strokes), counted.Of(limits.strokes),
                     counted.one, FormatCount(limits.first_sequence));
}

std::string LimitText(const LimitCheck& limits, const ParameterInfo& info, const CountedWords& counted) {
  const std::string limit = WithUnit(FormatShort(info.Shown(limits.limit)), info);
  const char* end = !limits.over_now ? "; back inside at the end"
                    : limits.unsure  ? "; the newest 95&nbsp;% interval reaches back over it"
                                     : "";
  switch (limits.outcome) {
    case LimitOutcome::kNone:
      return "none in the machine file";
    case LimitOutcome::kWithin:
      return "never touched";
    case LimitOutcome::kIntervalReaches:
      return fmt::format("not touched, but the 95&nbsp;% interval reaches over {}", limit);
    case LimitOutcome::kWarned:
      return fmt::format("warning limit {} crossed: {}{}", limit, StrokesText(limits, counted), end);
    case LimitOutcome::kAlarmed:
      return fmt::format("alarm limit {} crossed: {}{}", limit, StrokesText(limits, counted), end);
  }
  return "";
}

Standing StandingOf(const ParameterAnalysis& analysis) {
  if (analysis.limits.outcome == LimitOutcome::kAlarmed) return Standing::kAlarmed;
  if (analysis.limits.outcome == LimitOutcome::kWarned) return Standing::kWarned;
  if (analysis.updated == 0) return Standing::kUnknown;
  if (analysis.unexplained == Significance::kClear) return Standing::kChanged;
  if (analysis.unexplained == Significance::kHint) return Standing::kHint;
  if (analysis.oil.outcome == OilOutcome::kFollows) return Standing::kOil;
  if (analysis.oil.outcome == OilOutcome::kHint) return Standing::kHint;
  return analysis.change.change.Known() && !analysis.cannot_tell ? Standing::kSteady : Standing::kUnknown;
}

std::string PillOf(Standing standing, const ParameterAnalysis& analysis, const CountedWords& counted) {
  switch (standing) {
    case Standing::kSteady:
      return "no change seen";
    case Standing::kOil:
      return "moves with the oil";
    case Standing::kUnknown:
      return analysis.updated == 0  ? "not identifiable"
             : analysis.cannot_tell ? "cannot be told"
                                    : fmt::format("too few {}", counted.many);
    case Standing::kHint:
      return "a hint";
    case Standing::kChanged:
      return "changed";
    case Standing::kWarned:
      return "warning limit";
    case Standing::kAlarmed:
      return "alarm limit";
  }
  return "";
}

/// What stands in the way of blaming or clearing the oil for a clear change.
std::string ChangedReading(const ParameterAnalysis& analysis, const ParameterInfo& info,
                           const CountedWords& counted) {
  const OilDependence& oil = analysis.oil;
  switch (oil.outcome) {
    case OilOutcome::kNone:
      return "It changed over the record.";
    case OilOutcome::kNotMeasured:
      return "It changed over the record. Whether the oil temperature did it "
             "cannot be told, as that was not measured.";
    case OilOutcome::kTooFewStrokes:
      return fmt::format(
          "It changed over the record; there are too few {} to tell "
          "whether the oil temperature did it.",
          counted.many);
    case OilOutcome::kOilHardlyMoved:
      return fmt::format(
          "It changed over the record while the oil temperature, averaged over "
          "blocks of {}, stayed within {} K.",
          counted.many, FormatFixed(oil.warmest - oil.coldest, 1));
    case OilOutcome::kNotSeen:
      return "It changed over the record, and no dependence on the oil "
             "temperature is seen that would account for it.";
    case OilOutcome::kNotInStep:
      return "It changed over the record, not in step with the oil temperature.";
    case OilOutcome::kHint:
    case OilOutcome::kFollows:
      break;
  }
  return fmt::format("It changed by {} beyond what the oil temperature accounts for.",
                     Signed(oil.beyond, ScaleOf(info, analysis)));
}

std::string OilReading(const ParameterAnalysis& analysis) {
  if (analysis.oil.separable)
    return "It moves with the oil temperature; at equal temperature no change stands out.";
  if (SignificanceOf(analysis.change.change) == Significance::kNone)
    return "It moves with the oil temperature; over the record as a whole no change stands out.";
  return "It moves in step with the oil temperature, which would account for its change over the record. A "
         "steady change of the machine "
         "at the same pace could not be told from that.";
}

std::string Reading(Standing standing, const ParameterAnalysis& analysis, const ParameterInfo& info,
                    const CountedWords& counted) {
  std::string text;
  if (standing == Standing::kAlarmed || standing == Standing::kWarned) {
    const char* which = standing == Standing::kAlarmed ? "alarm" : "warning";
    text = fmt::format("It {} the {} limit of the machine file{}. ",
                       !analysis.limits.over_now ? "was beyond"
                       : analysis.limits.unsure  ? "is estimated beyond"
                                                 : "is beyond",
                       which, analysis.limits.over_now ? "" : " for a time");
  }
  if (analysis.updated == 0)
    return text + (analysis.why_not
                       ? fmt::format("Not identifiable in this record: {}.", ReasonText(*analysis.why_not))
                       : std::string("Not identified in this record."));
  if (analysis.unexplained == Significance::kClear)
    text += ChangedReading(analysis, info, counted);
  else if (analysis.oil.outcome == OilOutcome::kFollows && analysis.unexplained == Significance::kNone)
    text += OilReading(analysis);
  else if (analysis.unexplained == Significance::kHint)
    text += fmt::format("There is a hint of a change, too weak to rely on; more {} will tell.", counted.many);
  else if (analysis.oil.outcome == OilOutcome::kHint)
    text += "There is a hint that it moves with the oil temperature, too weak to rely on.";
  else if (!analysis.change.change.Known())
    text += fmt::format("There are too few {} to say whether it changes.", counted.many);
  else if (analysis.cannot_tell)
    text += fmt::format("Whether it changes cannot be told: {}.", NotSeenText(analysis, info));
  else
    text += "No change stands out in this record.";
  if (analysis.why_not)
    text += fmt::format(" The last {} did not update it: {}.", counted.one, ReasonText(*analysis.why_not));
  return text;
}

std::string JoinNames(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

/// Symbols of the parameters a predicate holds for.
template <typename Predicate>
std::vector<std::string> NamesWhere(const std::vector<ParameterInfo>& infos, Predicate holds) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < infos.size(); ++i)
    if (holds(i)) names.push_back("<b>" + HtmlSymbol(infos[i].symbol) + "</b>");
  return names;
}

void AddOilSentence(std::vector<std::string>& out, const TrendAnalysis& analysis,
                    const std::vector<ParameterInfo>& infos) {
  std::vector<std::string> follow;
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const OilDependence& oil = analysis.parameters[i].oil;
    if (oil.outcome != OilOutcome::kFollows) continue;
    follow.push_back(fmt::format("<b>{}</b> ({})", HtmlSymbol(infos[i].symbol),
                                 Signed(oil.slope, ScaleOf(infos[i], analysis.parameters[i]), "/K")));
  }
  const auto not_seen = NamesWhere(
      infos, [&](std::size_t i) { return analysis.parameters[i].oil.outcome == OilOutcome::kNotSeen; });
  const auto is = [](const auto& names, const char* one, const char* many) {
    return names.size() == 1 ? one : many;
  };
  if (!follow.empty())
    out.push_back(
        fmt::format("{} {} the oil temperature{}.", JoinNames(follow), is(follow, "follows", "follow"),
                    not_seen.empty() ? ""
                                     : fmt::format("; {} {} not, as far as can be seen", JoinNames(not_seen),
                                                   is(not_seen, "does", "do"))));
  else if (!not_seen.empty())
    out.push_back(fmt::format("No dependence on the oil temperature is seen in {}.", JoinNames(not_seen)));
}

bool HasOil(const TrendAnalysis& analysis) {
  return std::ranges::any_of(analysis.parameters,
                             [](const auto& p) { return p.oil.outcome != OilOutcome::kNone; });
}

bool AnyChangeKnown(const TrendAnalysis& analysis) {
  return std::ranges::any_of(analysis.parameters, [](const auto& p) { return p.change.change.Known(); });
}

std::string UnknownHeadline(const TrendAnalysis& analysis, const CountedWords& counted) {
  const bool identified =
      std::ranges::any_of(analysis.parameters, [](const auto& p) { return p.updated > 0; });
  if (!identified) return "No verdict: nothing was identified";
  if (!AnyChangeKnown(analysis)) return fmt::format("No verdict yet: too few {}", counted.many);
  const bool all_identified =
      std::ranges::all_of(analysis.parameters, [](const auto& p) { return p.updated > 0; });
  const bool blind = std::ranges::any_of(analysis.parameters, [](const auto& p) { return p.cannot_tell; });
  return all_identified && blind ? "No change stands out, but not in every parameter would one be seen"
                                 : "No change stands out, but not every parameter could be identified";
}

std::string Headline(Standing worst, const TrendAnalysis& analysis, bool inseparable,
                     const CountedWords& counted) {
  switch (worst) {
    case Standing::kAlarmed:
      return "An alarm limit was crossed";
    case Standing::kWarned:
      return "A warning limit was crossed";
    case Standing::kChanged:
      return HasOil(analysis) ? "A parameter changed, and the oil temperature does not account for it"
                              : "A parameter changed";
    case Standing::kHint:
      return "No clear change, but a hint worth watching";
    case Standing::kUnknown:
      return UnknownHeadline(analysis, counted);
    case Standing::kOil:
      return inseparable ? "Changes are in step with the oil temperature; none beyond it can be seen"
                         : "No change beyond what the oil temperature accounts for";
    case Standing::kSteady:
      return "No change stands out in this record";
  }
  return "";
}

/// A change that an alarm tells is not denied because it is small over the record as a whole, or young.
void HearAlarmsInVerdict(const std::vector<AlarmState>& alarms, const CountedWords& counted,
                         ReportVerdict& verdict) {
  const std::vector<std::string> told = ToldByAlarms(alarms, counted);
  if (told.empty() || verdict.standing >= Standing::kChanged) return;
  verdict.standing = Standing::kChanged;
  verdict.headline = "An alarm tells a change, though it does not stand out over the record as a whole";
  verdict.sentences.push_back(
      fmt::format("What the drift watch has found stands above: {}.", JoinNames(told)));
}

}  // namespace

ParameterWords DescribeParameter(const ParameterAnalysis& analysis, const ParameterInfo& info,
                                 const CountedWords& counted, const std::vector<AlarmState>& alarms) {
  ParameterWords words;
  words.standing = StandingOf(analysis);
  words.pill = PillOf(words.standing, analysis, counted);
  words.value = "not identified";
  if (analysis.latest)
    words.value = WithUnit(FormatWithUncertainty(info.Shown(analysis.latest->value),
                                                 kNormal95 * analysis.latest->std * info.factor),
                           info);
  words.reading = Reading(words.standing, analysis, info, counted);
  words.limits = LimitText(analysis.limits, info, counted);
  HearAlarms(alarms, analysis, info, counted, words);
  if (analysis.updated == 0) return words;
  words.change = ChangeText(analysis, info, counted);
  words.oil = OilText(analysis, info, counted);
  return words;
}

ReportVerdict DescribeVerdict(const ReportInput& input, const TrendAnalysis& analysis,
                              const std::vector<ParameterInfo>& infos,
                              const std::vector<ParameterWords>& words) {
  ReportVerdict verdict;
  const CountedWords counted = CountedWordsOf(input.machine);
  bool inseparable = false;
  verdict.standing = words.empty() ? Standing::kUnknown : Standing::kSteady;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!words[i].by_alarm) verdict.standing = std::max(verdict.standing, words[i].standing);
    inseparable |= words[i].standing == Standing::kOil && !analysis.parameters[i].oil.separable;
  }
  if (ErrorGrew(analysis.error.ratio)) verdict.standing = std::max(verdict.standing, Standing::kHint);
  verdict.headline = Headline(verdict.standing, analysis, inseparable, counted);
  HearAlarmsInVerdict(input.alarms, counted, verdict);
  const auto standing = [&](Standing wanted) {
    return NamesWhere(infos, [&](std::size_t i) { return words[i].standing == wanted; });
  };
  const auto unexplained = NamesWhere(
      infos, [&](std::size_t i) { return analysis.parameters[i].unexplained == Significance::kClear; });
  auto& out = verdict.sentences;
  if (input.strokes.empty())
    out.push_back(
        fmt::format("No {} was found in the record. Check the gate of the machine file "
                    "against the log, and what was skipped below.",
                    counted.one));
  else if (!AnyChangeKnown(analysis))
    out.push_back(fmt::format(
        "A change over the record can be judged from {} {} on that identify a parameter; "
        "this record has {} {}.",
        6 * kLeastBlockStrokes, counted.many, FormatCount(static_cast<std::int64_t>(input.strokes.size())),
        counted.Of(static_cast<std::int64_t>(input.strokes.size()))));
  for (const auto& [wanted, text] : {std::pair{Standing::kAlarmed, "alarm"}, {Standing::kWarned, "warning"}})
    if (const auto names = standing(wanted); !names.empty())
      out.push_back(fmt::format("{} went beyond {} {} limit of the machine file.", JoinNames(names),
                                names.size() == 1 ? "its" : "their", text));
  if (!unexplained.empty())
    out.push_back(fmt::format(
        "{} changed over the record{}; the numbers alone do not tell which.", JoinNames(unexplained),
        HasOil(analysis) ? " by more than the oil temperature accounts for. What changed may be the "
                           "machine, the oil or a sensor"
                         : ". What changed may be the machine or a sensor"));
  if (const auto names = standing(Standing::kHint); !names.empty())
    out.push_back(fmt::format("{}: a hint of a change, too weak to rely on.", JoinNames(names)));
  AddOilSentence(out, analysis, infos);
  if (const auto names = standing(Standing::kSteady); !names.empty())
    out.push_back(fmt::format("No change stands out in {}.", JoinNames(names)));
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i].standing == Standing::kUnknown && analysis.parameters[i].cannot_tell)
      out.push_back(fmt::format("Whether <b>{}</b> changes cannot be told: {}.", HtmlSymbol(infos[i].symbol),
                                NotSeenText(analysis.parameters[i], infos[i])));
  if (inseparable)
    out.push_back(fmt::format(
        "The oil warmed or cooled steadily along this record. A slow change of the machine at the same pace would "
        "look the same; {} at equal oil temperature from another day would tell the two apart.",
        counted.many));
  const auto unidentified =
      NamesWhere(infos, [&](std::size_t i) { return analysis.parameters[i].updated == 0; });
  if (!unidentified.empty())
    out.push_back(
        fmt::format("{} could not be identified; the reason stands below.", JoinNames(unidentified)));
  AddErrorSentence(out, input, analysis);
  return verdict;
}

}  // namespace hydroscope
