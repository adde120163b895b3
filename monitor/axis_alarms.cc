#include "monitor/axis_alarms.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/interval_text.h"
#include "core/unit_told.h"
#include "core/units.h"
#include "diagnosis/drift/valve_check_monitor.h"
#include "models/machine_kind.h"
#include "models/parameter_unit.h"
#include "pipeline/doubtful_estimates.h"

namespace hydroscope {
namespace {

constexpr const char* kUnnamed = "unnamed_change_";
constexpr double kLeastUsed = 0.5;  ///< share of a stroke's gated rows below which its signals count as lost

/// Whether an alarm is one that valve checks raise.
bool OfValveChecks(const std::string& id, const drift::RuleBook& rules) {
  for (const char* figure : drift::ValveCheckMonitor::kFigureNames) {
    if (id == std::string(kUnnamed) + figure) return true;
    for (const drift::Rule& rule : rules.rules)
      if (rule.id == id && rule.when.contains(figure)) return true;
  }
  return false;
}

/// Whether an alarm is one that findings raise.
bool OfFindings(const std::string& id, const drift::RuleBook& rules) {
  return !OfValveChecks(id, rules) &&
         (id.starts_with(kUnnamed) ||
          std::ranges::any_of(rules.rules, [&](const drift::Rule& rule) { return rule.id == id; }));
}

Told Advice(const drift::DriftFinding& finding, const drift::CountedIn& counted) {
  if (!finding.compared.advice.empty()) return finding.compared.advice;
  if (finding.nameless())
    return Tell("See `hydroscope explain` of the {} since the change.",
                "`hydroscope explain` der {} seit der Änderung ansehen.", counted.several);
  return finding.guidance;
}

/// What comparing strokes said of it; before that, that its name is a first one.
Told ComparedText(const drift::DriftFinding& finding, const drift::CountedIn& counted) {
  if (!finding.compared.text.empty() || !counted.compared) return finding.compared.text;
  return Tell("Not compared with the {} before it yet: what it is called may change.",
              "Mit dem, was davor war, noch nicht verglichen: wie es heißt, kann sich ändern.",
              counted.several);
}

/// What a finding says of its alarm, but its size and severity.
AlarmCondition ConditionOf(const drift::DriftFinding& finding, const drift::CountedIn& counted) {
  const drift::FindingPart& part = finding.parts.front();
  AlarmCondition condition;
  condition.std = part.std;
  condition.limit = part.limit;
  condition.unit = part.unit;
  condition.severity = finding.alarm ? AlarmSeverity::kAlarm : static_cast<AlarmSeverity>(finding.severity);
  condition.text = AlarmTextOf(finding, counted);
  condition.words = WordsOf(finding, counted);
  condition.quantities = QuantitiesOf(finding);
  return condition;
}

}  // namespace

AlarmWords WordsOf(const drift::DriftFinding& finding, const drift::CountedIn& counted) {
  const Told text = ComparedText(finding, counted),
             compared = text.empty() ? Told{} : Tell(" {}", " {}", text);
  return {NameText(finding),
          Tell("{}: {}.{}", "{}: {}.{}", SinceText(finding, counted), SizesText(finding), compared),
          Advice(finding, counted)};
}

std::string AlarmTextOf(const drift::DriftFinding& finding, const drift::CountedIn& counted) {
  std::string text = drift::FindingText(finding, counted) + ". ";
  if (const Told compared = ComparedText(finding, counted); !compared.empty()) text += compared.english + " ";
  if (finding.compared.cause.kind != CauseKind::kNotSought)
    text += fmt::format("Cause: {}. ", CauseText(finding.compared.cause));
  return text + Advice(finding, counted).english;
}

AlarmSettings AlarmSettingsOf(const drift::RuleBook& rules) {
  return {rules.warn_delay, rules.clear_delay, rules.deadband, false};
}

std::vector<std::string> QuantitiesOf(const drift::DriftFinding& finding) {
  std::vector<std::string> names;
  for (const drift::FindingPart& part : finding.parts) names.push_back(part.quantity);
  return names;
}

std::string AlarmIdOf(const drift::DriftFinding& finding) {
  if (!finding.rule.empty()) return finding.rule;
  return kUnnamed + (finding.parts.empty() ? std::string("none") : finding.parts.front().quantity);
}

bool SpeaksForItsAlarm(const drift::DriftFinding& finding, const std::vector<drift::DriftFinding>& findings) {
  const auto first = std::ranges::find_if(findings, [&](const drift::DriftFinding& f) {
    return f.state != drift::FindingState::kGone && !f.parts.empty() && AlarmIdOf(f) == AlarmIdOf(finding);
  });
  return first == findings.end() || first->number == finding.number;
}

namespace axis_alarms {

void JudgeFindings(const drift::DriftMonitor& monitor, const drift::RuleBook& rules, const AlarmMoment& now,
                   AxisContent& content) {
  const AlarmSettings settings = AlarmSettingsOf(rules);
  const drift::CountedIn counted = drift::CountedInOf(monitor.model().kind());
  for (const drift::DriftFinding& finding : monitor.findings()) {
    if (finding.parts.empty() || !SpeaksForItsAlarm(finding, monitor.findings())) continue;
    AlarmState& alarm = content.Alarm(AlarmIdOf(finding));
    if (finding.state == drift::FindingState::kGone) {
      content.Append(alarm_machine::Clear(alarm, settings, now));
      continue;
    }
    const drift::FindingPart& part = finding.parts.front();
    AlarmCondition condition = ConditionOf(finding, counted);
    condition.value = part.moved() ? std::abs(part.size) : 0.0;
    condition.first_stroke = finding.since.last_before + 1;
    condition.last_stroke = finding.last;
    condition.cause = finding.compared.cause;
    content.Append(alarm_machine::Observe(alarm, settings, condition, now));
  }
}

void ClearWhatIsGone(const drift::DriftMonitor& monitor, const drift::RuleBook& rules, const AlarmMoment& now,
                     AxisContent& content) {
  const auto& findings = monitor.findings();
  for (AlarmState& alarm : content.alarms) {
    const bool found = std::ranges::any_of(
        findings, [&](const auto& f) { return !f.parts.empty() && AlarmIdOf(f) == alarm.id; });
    if (!found && OfFindings(alarm.id, rules))
      content.Append(alarm_machine::Clear(alarm, AlarmSettingsOf(rules), now));
  }
}

void JudgeSlowDrifts(const drift::DriftMonitor& monitor, const drift::RuleBook& rules, const AlarmMoment& now,
                     AxisContent& content) {
  AlarmSettings settings = AlarmSettingsOf(rules);
  settings.on_delay = settings.off_delay = 2;  // counted in looks, not in strokes
  const auto drifts = monitor.SlowDrifts();
  for (const drift::Quantity& quantity : monitor.model().quantities()) {
    const auto found =
        std::ranges::find_if(drifts, [&](const auto& d) { return d.quantity == quantity.name; });
    const std::string id = "slow_" + quantity.name;
    const bool known = std::ranges::any_of(content.alarms, [&](const auto& a) { return a.id == id; });
    if (found == drifts.end() && !known) continue;
    AlarmCondition condition{-1, 0, 0, true, quantity.unit, AlarmSeverity::kAdvisory, "", -1, now.stroke};
    condition.quantities = {quantity.name};
    if (found != drifts.end()) {
      condition.value = std::abs(found->figures.now);
      condition.std = found->figures.slope_std * static_cast<double>(found->figures.strokes);
      condition.limit = 0;
      condition.first_stroke = now.stroke - found->figures.strokes;
      const DisplayUnit unit = ParameterUnit(monitor.model().kind(), quantity.name, quantity.unit);
      const Told counted = drift::CountedInOf(monitor.model().kind()).several;
      condition.Say(Tell(
          "{} drifts slowly, {:+.3g}{} per 1000 {}; reaches the size of an alarm in {:.0f} {} (95 %: {:.0f} to {:.0f})",
          "{} driftet langsam, {:+.3g}{} je 1000 {}; erreicht die Größe eines Alarms in {:.0f} {} (95 %: {:.0f} bis {:.0f})",
          quantity.name, 1000 * found->figures.slope * unit.factor,
          unit.name == "-" ? Told{} : UnitTold(fmt::format(" {}", unit.name)), counted, found->reach.strokes,
          counted, found->reach.low, found->reach.high));
    }
    content.Append(alarm_machine::Observe(content.Alarm(id), settings, condition, now));
  }
}

void JudgeLimits(const MachineKind& kind, const std::vector<MonitorSpec>& monitors,
                 const std::vector<EstimateStatement>& tolerances, const drift::RuleBook& rules,
                 const JudgedRecord& stroke, const AlarmMoment& now, AxisContent& content) {
  const AlarmSettings settings = AlarmSettingsOf(rules);
  for (const MonitorSpec& spec : monitors)
    for (const Estimate& e : stroke.record.estimates) {
      if (e.parameter != spec.parameter || e.reason != EstimateReason::kUpdated) continue;
      const auto judge = [&](const std::optional<double>& limit, bool high, AlarmSeverity severity,
                             const char* name) {
        if (!limit) return;
        const DisplayUnit unit = ParameterUnit(kind, e.parameter, e.unit);
        const auto shown = [&](double v) { return v * unit.factor + unit.offset; };
        Estimate stated = e;
        StateEstimate(tolerances, stated);
        AlarmCondition condition{e.value,  stated.std, *limit,          high,           e.unit,
                                 severity, "",         stroke.sequence, stroke.sequence};
        condition.scatter = e.std;
        const bool sure = std::abs(e.value - *limit) > kNormal95 * stated.std;
        condition.Say(
            Tell("{} is {} {}, {} the limit {} = {:.4g} {}{}",
                 "{} liegt bei {} {}, {} der Grenze {} = {:.4g} {}{}", spec.parameter,
                 TellNumber(WithInterval(shown(e.value), kNormal95 * stated.std * unit.factor)),
                 UnitTold(unit.name), high ? Tell("above", "über") : Tell("below", "unter"), name,
                 shown(*limit), UnitTold(unit.name),
                 sure ? Told()
                      : Told("; its 95 % interval reaches over it", "; sein 95-%-Intervall reicht darüber")));
        condition.quantities = {spec.parameter};
        content.Append(
            alarm_machine::Observe(content.Alarm(spec.parameter + "." + name), settings, condition, now));
      };
      judge(spec.warn_low, false, AlarmSeverity::kWarning, "warn_low");
      judge(spec.warn_high, true, AlarmSeverity::kWarning, "warn_high");
      judge(spec.alarm_low, false, AlarmSeverity::kAlarm, "alarm_low");
      judge(spec.alarm_high, true, AlarmSeverity::kAlarm, "alarm_high");
    }
}

void JudgeSignals(const Machine& machine, const JudgedRecord& stroke, const AlarmMoment& now,
                  AxisContent& content) {
  const StrokeCounters& counters = stroke.record.summary.counters;
  const double used =
      counters.gated > 0 ? static_cast<double>(counters.used) / static_cast<double>(counters.gated) : 0.0;
  const Told reversed = ReversedIn(machine, stroke.record.estimates);
  const bool lost =
      stroke.reason == drift::JudgementReason::kUnusable || used < kLeastUsed || !reversed.empty();
  if (!lost && std::ranges::find(content.alarms, "signal_loss", &AlarmState::id) == content.alarms.end())
    return;
  AlarmCondition condition{
      1 - used,       0, 1 - kLeastUsed, true, "1", AlarmSeverity::kSignalLoss, "", stroke.sequence,
      stroke.sequence};
  if (lost) condition.value = std::max(condition.value, condition.limit);
  condition.Say(
      !reversed.empty()
          ? reversed
          : Tell("only {:.0f} % of the rows could be used: check sensors and cables; `hydroscope check` on a "
                 "log tells which signal",
                 "nur {:.0f} % der Zeilen waren zu gebrauchen: Sensoren und Kabel prüfen; `hydroscope check` "
                 "auf eine Aufzeichnung sagt, welches Signal",
                 100 * used));
  content.Append(alarm_machine::Observe(content.Alarm("signal_loss"), {3, 3, 0, false}, condition, now));
}

void JudgeReference(int version, const std::vector<LearningDoubt>& doubts, const AlarmMoment& now,
                    AxisContent& content) {
  const Told against = DoubtText(doubts, true);
  if (against.empty()) return;  // learning cleared the one of the reference before
  AlarmCondition condition;
  condition.value = condition.limit = 1;
  condition.unit = "1";
  condition.severity = AlarmSeverity::kWarning;
  condition.first_stroke = condition.last_stroke = now.stroke;
  condition.Say(Tell(
      "reference {} may not be that of a healthy machine; of the strokes it was learned from: {}. Drift is "
      "judged against it. Learn again from other strokes: `hydroscope learn --from --to`",
      "Referenz {} ist vielleicht nicht die einer gesunden Maschine; von den Hüben, aus denen sie gelernt wurde: "
      "{}. An ihr wird Drift gemessen. Aus anderen Hüben neu lernen: `hydroscope learn --from --to`",
      version, against));
  content.Append(
      alarm_machine::Observe(content.Alarm("doubtful_reference"), {1, 1, 0, false}, condition, now));
}

void JudgeValveCheck(const drift::DriftFinding& finding, const drift::RuleBook& rules, const AlarmMoment& now,
                     AxisContent& content) {
  AlarmSettings settings = AlarmSettingsOf(rules);
  settings.on_delay = 1;  // a check judges itself
  for (AlarmState& alarm : content.alarms)
    if (OfValveChecks(alarm.id, rules) && (finding.parts.empty() || alarm.id != AlarmIdOf(finding)))
      content.Append(alarm_machine::Clear(alarm, settings, now));
  if (finding.parts.empty()) return;
  AlarmCondition condition = ConditionOf(finding, drift::ValveChecksCounted());
  condition.value = std::abs(finding.parts.front().size);
  condition.first_stroke = condition.last_stroke = now.stroke;
  content.Append(alarm_machine::Observe(content.Alarm(AlarmIdOf(finding)), settings, condition, now));
}

}  // namespace axis_alarms
}  // namespace hydroscope
