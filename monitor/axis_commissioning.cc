// How an AxisMonitor learns the healthy machine: by itself from the first strokes, or from those somebody names.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/told_error.h"
#include "monitor/axis_alarms.h"
#include "monitor/axis_monitor.h"
#include "monitor/learning_check.h"
#include "pipeline/doubtful_estimates.h"

namespace hydroscope {
namespace {

/// First stroke of a machine from `sequence` on whose Gram may have so many columns, by what is stored of each run: a long history of
/// another model need not be read.
Result<std::int64_t> NextWithColumns(const Database& database, std::int64_t machine, int columns,
                                     std::int64_t sequence) {
  const auto runs = TRY(database.Runs(machine));
  std::map<int, bool> fits;  // by version
  for (const RunInfo& run : runs) {
    const std::int64_t end = run.first_sequence + run.strokes;
    if (end <= sequence) continue;
    if (!fits.contains(run.model_version)) {
      const auto version = TRY(database.GetModelVersion(machine, run.model_version));
      fits[run.model_version] =
          version.columns.empty() || static_cast<int>(version.columns.size()) == columns;
    }
    if (fits[run.model_version]) return std::max(sequence, run.first_sequence);
    sequence = end;
  }
  return sequence;
}

}  // namespace

Result<std::vector<drift::StrokeEvidence>> AxisMonitor::LoadLearnable(std::int64_t first,
                                                                      std::int64_t count) const {
  const auto stored = TRY(Load(first, count));
  std::vector<drift::StrokeEvidence> strokes;
  for (const Stored& stroke : stored) {
    drift::StrokeEvidence evidence = EvidenceOf(stroke);
    if (Learnable(evidence)) strokes.push_back(std::move(evidence));
  }
  return strokes;
}

/// True once there are as many as commissioning asks for. They are collected anew after a restart: nothing of them
/// is stored twice.
Result<bool> AxisMonitor::CollectForLearning() {
  recorded_.reset();
  while (static_cast<int>(collected_.size()) < rules_.commissioning) {
    collected_to_ = TRY(NextWithColumns(database_, machine_id_, columns_, collected_to_));
    const auto chunk = TRY(Load(collected_to_, kStrokesPerChange));
    if (chunk.empty()) return false;
    for (const Stored& stroke : chunk) {
      collected_to_ = stroke.sequence + 1;
      drift::StrokeEvidence evidence = EvidenceOf(stroke);
      if (Learnable(evidence)) collected_.push_back(std::move(evidence));
      if (static_cast<int>(collected_.size()) == rules_.commissioning) break;
    }
  }
  return true;
}

/// Limits of the machine file hold while the healthy machine is being learned, too, and signals that are lost are missed.
Status AxisMonitor::JudgeWithoutReference(std::int64_t end, double wall) {
  while (without_reference_to_ < end) {
    const auto strokes = TRY(
        LoadWithoutGrams(without_reference_to_, std::min(kStrokesPerChange, end - without_reference_to_)));
    if (strokes.empty()) return {};
    TRY(Change(wall, [&](AxisContent& axis) {
      for (const Stored& stroke : strokes) {
        const StrokeSummary& summary = stroke.record.summary;
        last_ = {summary.end, wall, stroke.sequence, summary.oil_temperature, stroke.model_version, 0};
        const bool cold = summary.oil_temperature < rules_.minimum_temperature;
        for (AlarmState& alarm : axis.alarms) {
          axis.Append(alarm_machine::Tick(alarm, last_));
          if (IsOfLimit(alarm)) axis.Append(alarm_machine::Suppress(alarm, kSuppressedTooCold, cold, last_));
        }
        const JudgedRecord judged{stroke.record, stroke.sequence, drift::JudgementReason::kJudged};
        axis_alarms::JudgeSignals(machine_, judged, last_, axis);
        if (!cold && ReversedIn(machine_, stroke.record.estimates).empty())
          axis_alarms::JudgeLimits(KindOf(machine_), machine_.monitors, tolerances_, rules_, judged, last_,
                                   axis);
        Suppress(axis, last_);
        without_reference_to_ = stroke.sequence + 1;
      }
    }));
  }
  return {};
}

/// Whether it tells of a limit of the machine file, which no reference changes.
bool AxisMonitor::IsOfLimit(const AlarmState& alarm) const {
  return std::ranges::any_of(
      machine_.monitors, [&](const MonitorSpec& spec) { return alarm.id.starts_with(spec.parameter + "."); });
}

/// Whether the strokes collected are refused for what their signals are. Then those that are seen to be wrong make room for others,
/// or the older half: once the signals are right, commissioning goes on by itself.
bool AxisMonitor::RefuseCollected() {
  const HistoryPart part{machine_.name, machine_id_, collected_.front().sequence, collected_to_};
  const auto doubt = DoubtOfSignals(database_, path_, part, machine_);
  if (!doubt) return false;
  why_not_learned_ =
      Tell("nothing is learned from {} {} to {}: {}", "aus {} {} bis {} wird nichts gelernt: {}",
           counted().Many(), part.first, part.last - 1, doubt->text);
  const auto right = std::ranges::find_if(
      collected_, [&](const drift::StrokeEvidence& stroke) { return stroke.sequence >= doubt->refused_to; });
  const auto half = collected_.begin() + std::max<std::ptrdiff_t>(1, std::ssize(collected_) / 2);
  collected_.erase(collected_.begin(), doubt->refused_to > 0 ? right : half);
  return true;
}

/// True once a reference is there.
Result<bool> AxisMonitor::Commission(double wall) {
  for (;;) {
    const auto enough = CollectForLearning();
    if (!enough || !*enough) return enough;
    if (!rules_.automatic) return false;
    if (RefuseCollected()) continue;
    TRY(JudgeWithoutReference(collected_to_, wall));
    const Status learned = LearnFrom(collected_, collected_to_, wall, {"", "automatic"});
    if (learned) {
      why_not_learned_ = {};
      return true;
    }
    if (learned.error().kind != ErrorKind::kBadInput) return tl::unexpected(learned.error());
    // These strokes do not tell the parameters apart: the older half makes room for others.
    collected_.erase(collected_.begin(), collected_.begin() + collected_.size() / 2);
  }
}

Status AxisMonitor::LearnFrom(std::vector<drift::StrokeEvidence> strokes, std::int64_t next, double wall,
                              const AlarmUser& user) {
  const auto latest = TRY(journal_.LatestReference(machine_.name));
  auto reference = TRY(drift::Reference::Learn(*model_, strokes, latest ? latest->version + 1 : 1));
  const drift::StrokeEvidence& newest = strokes.back();
  const std::vector<LearningDoubt> doubts = DoubtsOfLearning(
      database_, path_, {machine_.name, machine_id_, strokes.front().sequence, newest.sequence + 1}, machine_,
      {});
  last_ = {newest.time, wall, newest.sequence, newest.oil_temperature, 0, reference.version()};
  unreadable_ = false;
  return Change(wall, [&](AxisContent& axis) {
    for (AlarmState& alarm : axis.alarms)
      if (!IsOfLimit(alarm) && alarm.severity != AlarmSeverity::kSignalLoss)
        axis.Append(alarm_machine::Clear(alarm, AlarmSettingsOf(rules_), last_));
    AppendReference(reference, strokes, user, axis);
    if (!doubts.empty())
      axis.events.back().text += "; what speaks against them: " + DoubtText(doubts, false).english;
    axis_alarms::JudgeReference(reference.version(), doubts, last_, axis);
    monitor_.emplace(*model_, rules_, std::move(reference));
    history_.EndAll(last_.stroke, last_.time);
    next_ = next;
  });
}

/// A new version of the reference with its event.
void AxisMonitor::AppendReference(const drift::Reference& reference,
                                  const std::vector<drift::StrokeEvidence>& strokes, const AlarmUser& user,
                                  AxisContent& content) const {
  AlarmEvent event;
  event.event = "reference_learned";
  event.time = strokes.back().time;
  event.stroke = strokes.back().sequence;
  event.oil_temperature = strokes.back().oil_temperature;
  event.reference_version = reference.version();
  event.user = user.name;
  event.comment = user.comment;
  event.first_stroke = strokes.front().sequence;
  event.last_stroke = strokes.back().sequence;
  event.text =
      fmt::format("reference {} learned from {} {}", reference.version(), strokes.size(), counted().many);
  ByteWriter bytes;
  reference.Save(bytes);
  content.references.push_back({reference.version(), event.first_stroke, event.last_stroke, bytes.Take()});
  content.events.push_back(std::move(event));
}

Status AxisMonitor::Learn(std::int64_t first, std::int64_t last, double wall, const AlarmUser& user) {
  if (!model_) return tl::unexpected(model_.error());
  TRY(Refresh());
  auto strokes = TRY(LoadLearnable(first, last - first));
  if (strokes.empty())
    return BadInput(
        Tell("{}: no {} from {} to {} can be learned from: none stored, or the oil was too cold",
             "{0}: aus {2} bis {3} lässt sich nichts lernen: nichts gespeichert, oder das Öl war zu kalt",
             machine_.name, counted().one, first, last - 1));
  const std::int64_t next = std::max(next_, strokes.back().sequence + 1);
  return LearnFrom(std::move(strokes), next, wall, user);
}

}  // namespace hydroscope
