// What the journal keeps of an AxisMonitor, and how it goes on when that cannot be read.
#include <fmt/format.h>

#include <algorithm>

#include "monitor/axis_alarms.h"
#include "monitor/axis_monitor.h"

namespace hydroscope {
namespace {

/// Strokes that are judged again for a monitor whose state is lost: what stands is found within far fewer.
constexpr std::int64_t kStrokesJudgedAgain = 2000;

}  // namespace

/// Takes over what another process, or this one before a restart, left in the journal. What is known of the healthy machine is
/// read only after a change.
Status AxisMonitor::Refresh() {
  const auto version = TRY(journal_.CurrentVersion());
  if (saved_ && version == seen_) return {};
  const auto content = TRY(journal_.Axis(machine_.name));
  alarms_ = content.alarms;
  if (!saved_ || *saved_ != content.monitor.state || next_ != content.monitor.next_stroke) Restore(content);
  seen_ = version;
  return {};
}

void AxisMonitor::Restore(const AxisContent& content) {
  next_ = content.monitor.next_stroke;
  last_.stroke = next_ - 1;
  without_reference_to_ = next_;
  recorded_.reset();
  saved_ = content.monitor.state;
  collected_.clear();
  collected_to_ = next_;
  unreadable_ = false;
  not_judged_ = 0;
  Forget();
  if (saved_->empty() || RestoreState()) return;
  unreadable_ = true;
  Forget();
}

void AxisMonitor::Forget() {
  monitor_.reset();
  history_ = {};
  valve_ = drift::ValveCheckMonitor(rules_);
  checks_ = 0;
}

/// State: whether a reference was learned, drift monitor, valve checks judged, their monitor, what stood when, up to which
/// stroke limits and signals are judged where that is further, and until there is a reference the strokes that commissioning
/// has and needs. States of earlier versions end before.
bool AxisMonitor::RestoreState() {
  ByteReader in(*saved_);
  const bool learned = in.Get<std::uint8_t>() != 0;
  if (learned) monitor_ = drift::DriftMonitor::Restored(*model_, rules_, in);
  if (monitor_.has_value() != learned) return false;
  checks_ = in.Get<std::int64_t>();
  if (!valve_.Restore(in)) return false;
  if (!in.at_end() && !history_.Restore(in)) return false;
  if (!in.at_end()) without_reference_to_ = in.Get<std::int64_t>();
  if (!in.at_end()) {
    const auto strokes = in.Get<std::int64_t>();
    recorded_ = {strokes, in.Get<std::int64_t>()};
  }
  return in.ok() && in.at_end();
}

std::vector<std::uint8_t> AxisMonitor::SaveState() const {
  ByteWriter out;
  out.Put<std::uint8_t>(monitor_ ? 1 : 0);
  if (monitor_) monitor_->Save(out);
  out.Put(checks_);
  valve_.Save(out);
  history_.Save(out);
  if (!monitor_ || without_reference_to_ > next_) out.Put(without_reference_to_);
  if (!monitor_) {
    out.Put(commissioning_strokes());
    out.Put(commissioning_needed());
  }
  return out.Take();
}

/// The frozen reference; one that cannot be read either is learned again from the strokes it was learned
/// from, if they still serve; `learned_anew` then holds it and its event.
Result<std::optional<drift::Reference>> AxisMonitor::FrozenReference(AxisContent& learned_anew) const {
  const auto stored = TRY(journal_.LatestReference(machine_.name));
  if (!stored) return std::nullopt;
  drift::Reference reference;
  ByteReader bytes(stored->bytes);
  if (reference.Restore(bytes) && static_cast<int>(reference.curves().size()) == model_->size())
    return reference;
  const std::int64_t first = stored->first_stroke, last = stored->last_stroke;
  const auto strokes = TRY(LoadLearnable(first, last - first + 1));
  auto again = drift::Reference::Learn(*model_, strokes, stored->version + 1);
  if (!again) return std::nullopt;
  AppendReference(*again, strokes, {}, learned_anew);
  learned_anew.events.back().text +=
      fmt::format(", those of reference {}, which this version of the program cannot read", stored->version);
  return again;
}

/// After a state that cannot be read: the last strokes are judged again against the frozen reference, in
/// silence, so that what stands is known again and nothing is raised twice. Without a reference that serves
/// the healthy machine is learned anew from the strokes to come.
Status AxisMonitor::BeginAnew(double wall) {
  AxisContent learned;
  auto reference = TRY(FrozenReference(learned));
  std::string told = "the drift monitor's state is of another version of the program or of another model; ";
  if (reference) {
    monitor_.emplace(*model_, rules_, std::move(*reference));
    const std::int64_t first =
        std::max(monitor_->reference().last_sequence() + 1, next_ - kStrokesJudgedAgain);
    const auto strokes = TRY(Load(first, next_ - first));
    for (const Stored& stroke : strokes) JudgeInSilence(stroke, wall);
    told += fmt::format("against reference {} the last {} {} were judged again", last_.reference_version,
                        strokes.size(), counted().many);
  } else {
    told += fmt::format("the healthy machine is learned anew from {} {} on", counted().one, next_);
  }
  const auto checks = TRY(database_.ValveChecks(machine_id_));
  for (const ValveCheckRecord& check : checks) JudgeInSilence(check);
  unreadable_ = false;
  return Change(wall, [&](AxisContent& axis) {
    AlarmEvent event;
    event.event = "monitor_begun_anew";
    event.time = last_.time;
    event.stroke = next_ - 1;
    event.oil_temperature = last_.oil_temperature;
    event.model_version = last_.model_version;
    event.reference_version = last_.reference_version;
    event.text = told;
    axis.events.push_back(std::move(event));
    axis.Append(std::move(learned.events));
    for (StoredReference& r : learned.references) axis.references.push_back(std::move(r));
    if (monitor_) axis_alarms::ClearWhatIsGone(*monitor_, rules_, Moment(wall), axis);
  });
}

}  // namespace hydroscope
