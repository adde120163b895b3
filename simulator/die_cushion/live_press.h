#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "simulator/die_cushion/press.h"
#include "simulator/valve/valve_sweep.h"

namespace hydroscope {

/// Answer to the request for a valve sweep, and its further fate; the numbers stand in the register map.
enum class SweepState : std::uint16_t {
  kIdle = 0,     ///< none asked for yet
  kGranted = 1,  ///< begins with the next row
  kRunning = 2,
  kDone = 3,
  kBusy = 4,     ///< refused: the press is not at rest, or a sweep is running
  kRefused = 5,  ///< refused: no such axis or amplitude
  kBroken = 6,   ///< broken off because the press began to work
};

/// A press that runs for as long as it is asked for rows: any number of cushions under one ram, effects and sensor
/// faults that come while it runs, pauses at the upper rest, valve sweeps in the pauses. Knows no clock.
class LivePress {
 public:
  static constexpr int kMostAxes = 256;

  struct Options {
    PressOptions press;  ///< of the first cushion; `seconds` is the longest possible run
    int axes = 4;
    double work = 0, pause = 0;  ///< s of work, then of pause, in turn; 0 = works until told to pause
  };
  /// Errors: as Validate(PressOptions), or no axes.
  static Result<std::unique_ptr<LivePress>> Create(const Options& options);

  /// What the sensors of every axis show next; valid until the next call. A lost row is NaN.
  const std::vector<PressRow>& Next();

  /// From now on `effect` has this size on `axis` (from 0; -1 = all), reached linearly over `ramp` s.
  Status ChangeEffect(const EffectSetting& effect, int axis, double ramp);
  /// `fault.start` in s from now.
  Status AddFault(SensorFault fault, int axis);
  /// Pause at the next upper rest, or go on working.
  void SetPause(bool pause);
  /// `axis` from 0, `amplitude` as a share of full scale.
  SweepState RequestSweep(int axis, double amplitude);

  bool resting() const { return resting_; }  ///< in a pause, ram at rest
  bool drawing() const;                      ///< the ram is in a drawing stroke
  std::uint32_t strokes() const { return strokes_; }
  SweepState sweep() const { return sweep_; }
  std::uint32_t sweeps_done() const { return sweeps_done_; }
  int axes() const { return static_cast<int>(axes_.size()); }
  double period() const { return period_; }  ///< s

 private:
  struct Ramp {
    std::string id;
    double from = 0, to = 0, begin = 0, duration = 0;
  };
  struct Axis {
    explicit Axis(const PressOptions& o)
        : options(o), generator(o), rest_noise(o.noise, StreamSeed(o.noise_seed, "rest")), faults(o.faults) {}
    PressOptions options;
    PressGenerator generator;
    NoiseSource rest_noise;
    FaultInjector faults;
    std::map<std::string, EffectSetting> effects;
    std::deque<Ramp> ramps;
    PressRow clean;
  };

  explicit LivePress(const Options& options);
  double now() const { return static_cast<double>(row_) * period_; }
  void FollowSchedule();
  Status Ramps(Axis& axis);
  Status Apply(Axis& axis);
  PressRow Advance(Axis& axis);
  void PlaySweep();

  Options options_;
  double period_;
  std::vector<Axis> axes_;
  std::vector<PressRow> rows_;
  std::int64_t row_ = 0;
  bool pause_wanted_ = false, resting_ = false, was_drawing_ = false;
  double schedule_since_ = 0;
  std::uint32_t strokes_ = 0;
  SweepState sweep_ = SweepState::kIdle;
  std::uint32_t sweeps_done_ = 0;
  int sweep_axis_ = 0;
  ValveSweepLog sweep_log_;
  std::size_t sweep_row_ = 0;
};

}  // namespace hydroscope
