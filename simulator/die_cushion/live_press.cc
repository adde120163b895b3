#include "simulator/die_cushion/live_press.h"

#include <algorithm>
#include <limits>

namespace hydroscope {
namespace {

constexpr std::int64_t kRowsPerRampStep = 10;

/// Frequencies of the usual sweep that the sampling can follow.
ValveSweepOptions SweepFor(const PressOptions& press, double amplitude, std::uint64_t number) {
  ValveSweepOptions sweep;
  sweep.sample_rate = 1 / press.sample_period;
  std::erase_if(sweep.frequencies, [&](double f) { return f > sweep.sample_rate / 2; });
  sweep.amplitude = amplitude;
  sweep.f0 = press.machine.valve_f0;
  sweep.damping = press.machine.valve_damping;
  sweep.gain = press.machine.valve_gain;
  sweep.dead_time = press.machine.valve_dead_time;
  sweep.zero = press.machine.y_0;
  sweep.noise = press.noise.y_v;
  sweep.seed = press.noise_seed + number;
  return sweep;
}

}  // namespace

Result<std::unique_ptr<LivePress>> LivePress::Create(const Options& options) {
  if (options.axes < 1 || options.axes > kMostAxes)
    return UsageError("a press of {} axes; it must have 1 to {}", options.axes, kMostAxes);
  if (options.work < 0 || options.pause < 0 || (options.work > 0) != (options.pause > 0))
    return UsageError("work for {} s, then pause for {} s: both must be above 0, or none given", options.work,
                      options.pause);
  TRY(Validate(options.press));
  return std::unique_ptr<LivePress>(new LivePress(options));
}

LivePress::LivePress(const Options& options) : options_(options), period_(options.press.sample_period) {
  axes_.reserve(static_cast<std::size_t>(options.axes));
  for (const PressOptions& cushion : Cushions(options.press, options.axes)) {
    Axis& axis = axes_.emplace_back(cushion);
    for (const EffectSetting& effect : cushion.effects) axis.effects[effect.id] = effect;
  }
  rows_.resize(axes_.size());
}

bool LivePress::drawing() const { return !resting_ && axes_.front().generator.phase() == PressPhase::kDraw; }

void LivePress::FollowSchedule() {
  if (options_.work <= 0) return;
  const double since = now() - schedule_since_;
  if (since < (pause_wanted_ ? options_.pause : options_.work)) return;
  schedule_since_ = now();
  SetPause(!pause_wanted_);
}

void LivePress::SetPause(bool pause) {
  pause_wanted_ = pause;
  if (pause || !resting_) return;
  resting_ = false;
  if (sweep_ == SweepState::kRunning || sweep_ == SweepState::kGranted) sweep_ = SweepState::kBroken;
}

const std::vector<PressRow>& LivePress::Next() {
  FollowSchedule();
  if (pause_wanted_ && row_ > 0 && axes_.front().generator.phase() == PressPhase::kRestTop) resting_ = true;
  for (std::size_t k = 0; k < axes_.size(); ++k) rows_[k] = Advance(axes_[k]);
  if (resting_) PlaySweep();
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    if (axes_[k].faults.Apply(rows_[k])) continue;
    for (int channel = 0; channel < static_cast<int>(kPressChannels.size()); ++channel)
      ChannelOf(rows_[k], channel) = std::numeric_limits<double>::quiet_NaN();
  }
  if (drawing() && !was_drawing_) ++strokes_;
  was_drawing_ = drawing();
  ++row_;
  return rows_;
}

PressRow LivePress::Advance(Axis& axis) {
  if (row_ % kRowsPerRampStep == 0 && !axis.ramps.empty() && !Ramps(axis)) axis.ramps.clear();
  PressRow row;
  if (!resting_) axis.generator.NextClean(axis.clean);
  row = axis.clean;
  row.t = now();
  const auto draw = resting_ ? axis.rest_noise.Next() : axis.generator.noise();
  ReadSensors(axis.options.noise, axis.options.quantum, draw, row);
  return row;
}

void LivePress::PlaySweep() {
  if (sweep_ == SweepState::kGranted) sweep_ = SweepState::kRunning;
  if (sweep_ != SweepState::kRunning) return;
  PressRow& row = rows_[static_cast<std::size_t>(sweep_axis_)];
  row.U_v = sweep_log_.U_v[sweep_row_];
  row.y_v = sweep_log_.y_v[sweep_row_];
  if (++sweep_row_ < sweep_log_.t.size()) return;
  sweep_ = SweepState::kDone;
  ++sweeps_done_;
}

SweepState LivePress::RequestSweep(int axis, double amplitude) {
  if (sweep_ == SweepState::kRunning || sweep_ == SweepState::kGranted) return sweep_;
  if (axis < 0 || axis >= axes() || !(amplitude > 0 && amplitude <= 0.2))
    return sweep_ = SweepState::kRefused;
  if (!resting_) return sweep_ = SweepState::kBusy;
  sweep_axis_ = axis;
  sweep_row_ = 0;
  sweep_log_ = SimulateValveSweep(
      SweepFor(axes_[static_cast<std::size_t>(axis)].options, amplitude, sweeps_done_ + 1));
  return sweep_ = SweepState::kGranted;
}

Status LivePress::Apply(Axis& axis) {
  std::vector<EffectSetting> settings;
  for (const auto& [id, effect] : axis.effects) settings.push_back(effect);
  return axis.generator.SetEffects(settings);
}

Status LivePress::Ramps(Axis& axis) {
  for (const Ramp& ramp : axis.ramps) {
    const double share = std::clamp((now() - ramp.begin) / ramp.duration, 0.0, 1.0);
    axis.effects[ramp.id].size = ramp.from + share * (ramp.to - ramp.from);
  }
  std::erase_if(axis.ramps, [&](const Ramp& r) { return now() >= r.begin + r.duration; });
  return Apply(axis);
}

Status LivePress::ChangeEffect(const EffectSetting& effect, int axis, double ramp) {
  if (axis < -1 || axis >= axes()) return UsageError("axis {}: the press has {} axes", axis + 1, axes());
  if (!(ramp >= 0)) return UsageError("ramp {} s: it must be 0 s or more", ramp);
  for (int k = 0; k < axes(); ++k) {
    if (axis >= 0 && k != axis) continue;
    Axis& a = axes_[static_cast<std::size_t>(k)];
    const auto before = a.effects;
    const double from = before.contains(effect.id) ? before.at(effect.id).size : 0;
    a.effects[effect.id] = effect;  // tried at its full size, so that a refusal comes now
    if (const Status status = Apply(a); !status) {
      a.effects = before;
      return status;
    }
    std::erase_if(a.ramps, [&](const Ramp& r) { return r.id == effect.id; });
    if (ramp == 0) continue;
    a.ramps.push_back({effect.id, from, effect.size, now(), ramp});
    TRY(Ramps(a));
  }
  return {};
}

Status LivePress::AddFault(SensorFault fault, int axis) {
  if (axis < -1 || axis >= axes()) return UsageError("axis {}: the press has {} axes", axis + 1, axes());
  fault.start += now();
  PressOptions probe = options_.press;
  probe.faults = {fault};
  TRY(Validate(probe));
  for (int k = 0; k < axes(); ++k)
    if (axis < 0 || k == axis) axes_[static_cast<std::size_t>(k)].faults.Add(fault);
  return {};
}

}  // namespace hydroscope
