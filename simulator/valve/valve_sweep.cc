#include "simulator/valve/valve_sweep.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "simulator/die_cushion/valve.h"
#include "simulator/random.h"
#include "simulator/ranges.h"

namespace hydroscope {
namespace {

constexpr double kSweepFullScale = 10;  // V

/// The command, relative to full scale, as a function of time: sines that follow each other without a jump.
class SteppedSine {
 public:
  explicit SteppedSine(const ValveSweepOptions& options) : options_(options) {
    double begin = 0;
    for (const double f : options.frequencies) {
      begins_.push_back(begin);
      begin += std::ceil(options.hold * f - 1e-9) / f;
    }
    end_ = begin;
  }
  double end() const { return end_; }

  double At(double t) const {
    if (options_.update_rate > 0) t = std::floor(t * options_.update_rate + 1e-9) / options_.update_rate;
    if (t < 0 || t >= end_) return 0;
    const auto next = std::upper_bound(begins_.begin(), begins_.end(), t);
    const std::size_t k = static_cast<std::size_t>(next - begins_.begin()) - 1;
    return options_.amplitude * std::sin(2 * std::numbers::pi * options_.frequencies[k] * (t - begins_[k]));
  }

 private:
  const ValveSweepOptions& options_;
  std::vector<double> begins_;
  double end_ = 0;
};

}  // namespace

Status Validate(const ValveSweepOptions& o) {
  if (o.frequencies.empty()) return UsageError("a sweep needs at least one frequency");
  TRY(CheckRanges({{"amplitude", o.amplitude, 1e-6, 1, "of full scale"},
                   {"hold", o.hold, 0.01, 1e4, "s"},
                   {"sample rate", o.sample_rate, 10, 1e5, "Hz"},
                   {"update rate", o.update_rate, 0, 1e5, "Hz"},
                   {"f0", o.f0, 1, 5000, "Hz"},
                   {"damping", o.damping, 0.05, 5, "1"},
                   {"gain", o.gain, 1e-3, 100, "1"},
                   {"dead time", o.dead_time, 0, 0.1, "s"},
                   {"noise", o.noise, 0, 1, "1"},
                   {"command noise", o.command_noise, 0, kSweepFullScale, "V"}}));
  for (const double f : o.frequencies) TRY(CheckRanges({{"frequency", f, 0.01, o.sample_rate / 2, "Hz"}}));
  return {};
}

ValveSweepLog SimulateValveSweep(const ValveSweepOptions& o) {
  const SteppedSine command(o);
  const double period = 1 / o.sample_rate;
  const int steps = std::max(1, static_cast<int>(std::ceil(period / 10e-6 - 1e-9)));
  const double step = period / steps;
  ServoValve valve(o.f0, o.damping, o.gain, 0, step);
  RandomStream noise(StreamSeed(o.seed, "valve sweep"));
  ValveSweepLog log;
  const auto rows = static_cast<std::int64_t>(std::floor(command.end() * o.sample_rate + 1e-6));
  for (std::int64_t row = 0; row < rows; ++row) {
    const double t = static_cast<double>(row) * period;
    log.t.push_back(t);
    log.U_v.push_back(kSweepFullScale * command.At(t) + o.command_noise * noise.Normal());
    log.y_v.push_back(o.zero + valve.position() + o.noise * noise.Normal());
    for (int k = 0; k < steps; ++k) valve.Step(command.At(t + (k + 0.5) * step - o.dead_time));
  }
  return log;
}

std::string FormatValveSweep(const ValveSweepLog& log) {
  std::string text = "t,U_v,y_v\n";
  const auto end = std::back_inserter(text);
  for (std::size_t k = 0; k < log.t.size(); ++k)
    fmt::format_to(end, FMT_COMPILE("{:.6f},{:.6f},{:.8f}\n"), log.t[k], log.U_v[k], log.y_v[k]);
  return text;
}

}  // namespace hydroscope
