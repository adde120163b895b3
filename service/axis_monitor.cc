#include "service/axis_monitor.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "core/units.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kStrokesPerChange = 256;  ///< strokes per transaction
constexpr std::int64_t kSlowDriftEvery = 50;     ///< strokes
constexpr double kLeastUsed = 0.5;  ///< share of a stroke's gated rows below which its signals count as lost

AlarmSettings SettingsOf(const drift::RuleBook& rules) {
  return {rules.warn_delay, rules.clear_delay, rules.deadband, false};
}

AlarmSeverity SeverityOf(drift::RuleSeverity severity) { return static_cast<AlarmSeverity>(severity); }

bool EndsHere(const drift::DriftFinding& f) { return f.state == drift::FindingState::kGone; }

/// Id of the alarm a finding raises.
std::string AlarmId(const drift::DriftFinding& finding) {
  if (!finding.rule.empty()) return finding.rule;
  return "unnamed_change_" + (finding.parts.empty() ? std::string("none") : finding.parts.front().quantity);
}

}  // namespace

Result<drift::RuleBook> RulesFor(const std::string& machine_file) {
  const std::filesystem::path path(machine_file);
  const auto rules = path.parent_path() / (path.stem().string() + "_rules.toml");
  std::error_code ignored;
  if (!std::filesystem::exists(rules, ignored)) return drift::DefaultRules();
  return drift::LoadRules(rules.string());
}

AxisMonitor::AxisMonitor(const Machine& machine, std::shared_ptr<const ModelStructure> model,
                         const drift::RuleBook& rules, const Database& database, std::int64_t machine_id,
                         AlarmJournal& journal)
    : machine_(machine),
      rules_(rules),
      database_(database),
      machine_id_(machine_id),
      journal_(journal),
      model_(drift::WatchedModel::Create(model,
                                         [&] {
                                           std::vector<std::string> names;
                                           for (const drift::WatchSpec& w : rules.watches)
                                             names.push_back(w.quantity);
                                           return names;
                                         }())),
      columns_(model->column_count()) {}

/// Strokes first ... first + count - 1 as far as they are stored, with estimates.
Result<std::vector<AxisMonitor::Stored>> AxisMonitor::Load(std::int64_t first, std::int64_t count) const {
  const auto runs = database_.Runs(machine_id_);
  if (!runs) return tl::unexpected(runs.error());
  std::vector<Stored> strokes;
  for (const RunInfo& run : *runs) {
    const std::int64_t begin = std::max(first, run.first_sequence);
    const std::int64_t end = std::min(first + count, run.first_sequence + run.strokes);
    if (begin >= end) continue;
    const auto summaries = database_.Strokes(run.id);
    if (!summaries) return tl::unexpected(summaries.error());
    for (std::int64_t s = begin; s < end; ++s) {
      Stored stroke;
      stroke.record.summary = (*summaries)[static_cast<std::size_t>(s - run.first_sequence)];
      stroke.sequence = s;
      stroke.model_version = run.model_version;
      strokes.push_back(std::move(stroke));
    }
  }
  if (strokes.empty()) return strokes;
  auto grams = database_.Grams(machine_id_, strokes.front().sequence, strokes.back().sequence + 1);
  if (!grams) return tl::unexpected(grams.error());
  for (std::size_t i = 0; i < strokes.size() && i < grams->size(); ++i)
    strokes[i].record.gram = std::move((*grams)[i]);
  if (machine_.monitors.empty()) return strokes;
  const auto trend = database_.Trend(machine_id_, "", strokes.front().sequence);
  if (!trend) return tl::unexpected(trend.error());
  for (const TrendPoint& point : *trend) {
    const auto index = static_cast<std::size_t>(point.sequence - strokes.front().sequence);
    if (index < strokes.size()) strokes[index].record.estimates.push_back(point.estimate);
  }
  return strokes;
}

drift::StrokeEvidence AxisMonitor::EvidenceOf(const Stored& stroke) const {
  // A Gram of another model's columns tells nothing here.
  if (stroke.record.gram.integral.dimension() == columns_)
    return model_->Evidence(stroke.record, stroke.sequence);
  drift::StrokeEvidence none;
  none.sequence = stroke.sequence;
  none.time = stroke.record.summary.end;
  none.oil_temperature = stroke.record.summary.oil_temperature;
  return none;
}

Status AxisMonitor::LoadMonitor(const AxisContent& content) {
  alarms_ = content.alarms;
  if (content.monitor.next_stroke == next_) return {};
  next_ = content.monitor.next_stroke;
  monitor_.reset();
  if (content.monitor.state.empty()) return {};
  monitor_.emplace(*model_, rules_, drift::Reference());
  ByteReader in(content.monitor.state);
  if (!monitor_->Restore(in) || !in.at_end())
    monitor_.reset();  // another model or program: commissioning begins anew
  return {};
}

Status AxisMonitor::CatchUp(double wall) {
  if (!model_) return tl::unexpected(model_.error());
  const auto content = journal_.Axis(machine_.name);
  if (!content) return tl::unexpected(content.error());
  if (const Status loaded = LoadMonitor(*content); !loaded) return loaded;
  if (!monitor_) {
    const auto commissioned = Commission(next_, wall);
    if (!commissioned) return tl::unexpected(commissioned.error());
    if (!*commissioned) return {};
  }
  for (;;) {
    const auto strokes = Load(next_, kStrokesPerChange);
    if (!strokes) return tl::unexpected(strokes.error());
    if (strokes->empty()) return {};
    const std::int64_t after = strokes->back().sequence + 1;
    const Status stored = journal_.Change(machine_.name, wall, [&](AxisContent& axis) -> Status {
      if (axis.monitor.next_stroke != next_)
        return InternalError("another process judges the strokes of {} at the same time", machine_.name);
      for (const Stored& stroke : *strokes) Judge(stroke, wall, axis);
      ByteWriter out;
      monitor_->Save(out);
      axis.monitor = StoredMonitor{after, strokes->back().model_version, out.Take()};
      alarms_ = axis.alarms;
      return {};
    });
    if (!stored) {
      next_ = -1;  // what is in memory is ahead of the file
      return stored;
    }
    next_ = after;
  }
}

/// True once a reference is there. Strokes are collected anew after a restart: nothing of them is stored
/// twice.
Result<bool> AxisMonitor::Commission(std::int64_t first, double wall) {
  std::vector<drift::StrokeEvidence> strokes;
  std::int64_t next = first;
  while (static_cast<int>(strokes.size()) < rules_.commissioning) {
    const auto chunk = Load(next, kStrokesPerChange);
    if (!chunk) return tl::unexpected(chunk.error());
    if (chunk->empty()) break;
    for (const Stored& s : *chunk) {
      next = s.sequence + 1;
      drift::StrokeEvidence evidence = EvidenceOf(s);
      const bool cold = evidence.oil_temperature < rules_.minimum_temperature;
      if (!cold && evidence.equations.equations > 0) strokes.push_back(std::move(evidence));
      if (static_cast<int>(strokes.size()) == rules_.commissioning) break;
    }
  }
  commissioning_strokes_ = static_cast<std::int64_t>(strokes.size());
  if (!rules_.automatic || commissioning_strokes_ < rules_.commissioning) return false;
  if (const Status learned = LearnFrom(std::move(strokes), next, wall, {"", "automatic"}); !learned)
    return tl::unexpected(learned.error());
  return true;
}

Status AxisMonitor::LearnFrom(std::vector<drift::StrokeEvidence> strokes, std::int64_t next, double wall,
                              const AlarmUser& user) {
  const auto latest = journal_.LatestReference(machine_.name);
  if (!latest) return tl::unexpected(latest.error());
  const int version = *latest ? (*latest)->version + 1 : 1;
  auto reference = drift::Reference::Learn(*model_, strokes, version);
  if (!reference) return tl::unexpected(reference.error());
  AlarmEvent event;
  event.event = "reference_learned";
  event.time = strokes.back().time;
  event.stroke = strokes.back().sequence;
  event.oil_temperature = strokes.back().oil_temperature;
  event.reference_version = version;
  event.user = user.name;
  event.comment = user.comment;
  event.first_stroke = strokes.front().sequence;
  event.last_stroke = strokes.back().sequence;
  event.text = fmt::format("reference {} learned from {} strokes", version, strokes.size());
  ByteWriter bytes;
  reference->Save(bytes);
  monitor_.emplace(*model_, rules_, std::move(*reference));
  const Status stored = journal_.Change(machine_.name, wall, [&](AxisContent& axis) -> Status {
    AlarmMoment now{event.time, wall, event.stroke, event.oil_temperature, 0, version};
    for (AlarmState& alarm : axis.alarms) axis.Append(alarm_machine::Clear(alarm, SettingsOf(rules_), now));
    axis.references.push_back({version, event.first_stroke, event.last_stroke, bytes.Take()});
    axis.events.push_back(event);
    ByteWriter state;
    monitor_->Save(state);
    axis.monitor = {next, axis.monitor.model_version, state.Take()};
    alarms_ = axis.alarms;
    return {};
  });
  next_ = stored ? next : -1;
  return stored;
}

Status AxisMonitor::Learn(std::int64_t first, std::int64_t last, double wall, const AlarmUser& user) {
  if (!model_) return tl::unexpected(model_.error());
  const auto content = journal_.Axis(machine_.name);
  if (!content) return tl::unexpected(content.error());
  const auto stored = Load(first, last - first);
  if (!stored) return tl::unexpected(stored.error());
  std::vector<drift::StrokeEvidence> strokes;
  for (const Stored& s : *stored) {
    drift::StrokeEvidence evidence = EvidenceOf(s);
    const bool cold = evidence.oil_temperature < rules_.minimum_temperature;
    if (!cold && evidence.equations.equations > 0) strokes.push_back(std::move(evidence));
  }
  if (strokes.empty()) return BadInput("no usable stroke between {} and {}", first, last);
  const std::int64_t next = std::max(content->monitor.next_stroke, strokes.back().sequence + 1);
  return LearnFrom(std::move(strokes), next, wall, user);
}

Status AxisMonitor::SetSuppression(Suppression reason, bool on, const AlarmMoment& now) {
  return journal_.Change(machine_.name, now.wall, [&](AxisContent& axis) -> Status {
    for (AlarmState& alarm : axis.alarms) axis.Append(alarm_machine::Suppress(alarm, reason, on, now));
    alarms_ = axis.alarms;
    return {};
  });
}

void AxisMonitor::Judge(const Stored& stroke, double wall, AxisContent& content) {
  const drift::StrokeEvidence evidence = EvidenceOf(stroke);
  const drift::Judgement judgement = monitor_->Add(evidence);
  const AlarmMoment now{evidence.time,        wall,
                        stroke.sequence,      evidence.oil_temperature,
                        stroke.model_version, monitor_->reference().version()};
  for (AlarmState& alarm : content.alarms) content.Append(alarm_machine::Tick(alarm, now));
  JudgeSignals(stroke, judgement, now, content);
  const bool cold = judgement.reason == drift::JudgementReason::kTooCold;
  for (AlarmState& alarm : content.alarms)
    if (alarm.severity != AlarmSeverity::kSignalLoss)
      content.Append(alarm_machine::Suppress(alarm, kSuppressedTooCold, cold, now));
  if (judgement.reason == drift::JudgementReason::kJudged) {
    JudgeFindings(now, content);
    if (stroke.sequence % kSlowDriftEvery == 0) JudgeSlowDrifts(now, content);
  }
  if (!cold) JudgeLimits(stroke, now, content);
}

void AxisMonitor::JudgeFindings(const AlarmMoment& now, AxisContent& content) {
  const AlarmSettings settings = SettingsOf(rules_);
  for (const drift::DriftFinding& finding : monitor_->findings()) {
    if (finding.parts.empty()) continue;
    AlarmState& alarm = content.Alarm(AlarmId(finding));
    if (EndsHere(finding)) {
      content.Append(alarm_machine::Clear(alarm, settings, now));
      continue;
    }
    const drift::FindingPart& part = finding.parts.front();
    AlarmCondition condition{std::abs(part.size),
                             part.std,
                             part.limit,
                             true,
                             part.unit,
                             SeverityOf(finding.severity),
                             drift::FindingText(finding) + ". " + finding.guidance,
                             finding.since.last_before + 1,
                             finding.last};
    if (finding.alarm) condition.severity = AlarmSeverity::kAlarm;
    content.Append(alarm_machine::Observe(alarm, settings, condition, now));
  }
}

void AxisMonitor::JudgeSlowDrifts(const AlarmMoment& now, AxisContent& content) {
  AlarmSettings settings = SettingsOf(rules_);
  settings.on_delay = settings.off_delay = 2;  // counted in looks, not in strokes
  const auto drifts = monitor_->SlowDrifts();
  for (const drift::Quantity& quantity : monitor_->model().quantities()) {
    const auto found = std::find_if(drifts.begin(), drifts.end(),
                                    [&](const auto& d) { return d.quantity == quantity.name; });
    const std::string id = "slow_" + quantity.name;
    const bool known =
        std::any_of(content.alarms.begin(), content.alarms.end(), [&](const auto& a) { return a.id == id; });
    if (found == drifts.end() && !known) continue;
    AlarmCondition condition{-1, 0, 0, true, quantity.unit, AlarmSeverity::kAdvisory, "", -1, now.stroke};
    if (found != drifts.end()) {
      condition.value = std::abs(found->figures.now);
      condition.std = found->figures.slope_std * static_cast<double>(found->figures.strokes);
      condition.limit = 0;
      condition.first_stroke = now.stroke - found->figures.strokes;
      condition.text = fmt::format(
          "{} drifts slowly, {:.3g} {} per 1000 strokes; reaches its limit in {:.0f} strokes (95 %: {:.0f} "
          "to {:.0f})",
          quantity.name, 1000 * found->figures.slope, quantity.unit, found->reach.strokes, found->reach.low,
          found->reach.high);
    }
    content.Append(alarm_machine::Observe(content.Alarm(id), settings, condition, now));
  }
}

/// Limits that the machine file states for the identified values as they are, at any temperature.
void AxisMonitor::JudgeLimits(const Stored& stroke, const AlarmMoment& now, AxisContent& content) {
  const AlarmSettings settings = SettingsOf(rules_);
  for (const MonitorSpec& spec : machine_.monitors)
    for (const Estimate& e : stroke.record.estimates) {
      if (e.parameter != spec.parameter || e.reason != EstimateReason::kUpdated) continue;
      const auto judge = [&](const std::optional<double>& limit, bool high, AlarmSeverity severity,
                             const char* name) {
        if (!limit) return;
        const DisplayUnit unit = DisplayUnitFor(e.unit);
        const auto shown = [&](double v) { return v * unit.factor + unit.offset; };
        AlarmCondition condition{e.value,  e.std, *limit,          high,           e.unit,
                                 severity, "",    stroke.sequence, stroke.sequence};
        condition.text = fmt::format("{} is {:.4g} ± {:.2g} {}, {} the limit {} = {:.4g} {}", spec.parameter,
                                     shown(e.value), 1.96 * e.std * unit.factor, unit.name,
                                     high ? "above" : "below", name, shown(*limit), unit.name);
        content.Append(
            alarm_machine::Observe(content.Alarm(spec.parameter + "." + name), settings, condition, now));
      };
      judge(spec.warn_low, false, AlarmSeverity::kWarning, "warn_low");
      judge(spec.warn_high, true, AlarmSeverity::kWarning, "warn_high");
      judge(spec.alarm_low, false, AlarmSeverity::kAlarm, "alarm_low");
      judge(spec.alarm_high, true, AlarmSeverity::kAlarm, "alarm_high");
    }
}

void AxisMonitor::JudgeSignals(const Stored& stroke, const drift::Judgement& judgement,
                               const AlarmMoment& now, AxisContent& content) {
  const StrokeCounters& counters = stroke.record.summary.counters;
  const double used =
      counters.gated > 0 ? static_cast<double>(counters.used) / static_cast<double>(counters.gated) : 0.0;
  const bool lost = judgement.reason == drift::JudgementReason::kUnusable || used < kLeastUsed;
  AlarmCondition condition{
      1 - used,       0, 1 - kLeastUsed, true, "1", AlarmSeverity::kSignalLoss, "", stroke.sequence,
      stroke.sequence};
  if (lost) condition.value = std::max(condition.value, condition.limit);
  condition.text = fmt::format(
      "only {:.0f} % of the stroke's rows could be used: check sensors and cables; `hydroscope check` on a "
      "log tells which signal",
      100 * used);
  content.Append(alarm_machine::Observe(content.Alarm("signal_loss"), {3, 3, 0, false}, condition, now));
}

}  // namespace hydroscope
