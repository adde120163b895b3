#include "studies/pump/identification.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>

#include "core/constants.h"
#include "diagnosis/states/missing_sensors.h"
#include "studies/parallel.h"

namespace hydroscope {
namespace {

constexpr double kRecordSeconds = 12;                // of each record
constexpr double kPublishedFit = 85.36;              // %
constexpr double kGoalFit = 95, kGoalError = 0.005;  // %, relative
constexpr double kGoalInside = 0.9;                  // of 95 % intervals
constexpr int kPublishedParameters = 5;              // K_v, K_q, C_l, K_p, V_t

double RmsOfColumn(const Episode& episode, int signal) {
  double energy = 0, count = 0;
  for (int row = 0; row < episode.rows(); ++row)
    if (const double y = episode.signal(row, signal); std::isfinite(y)) {
      energy += y * y;
      count += 1;
    }
  return std::sqrt(energy / std::max(count, 1.0));
}

/// Rms of what the published filter leaves of a ripple: Savitzky and Golay, order 2, over a period of the pistons (equation 20).
double Smoothed(const std::vector<double>& ripple, const PumpOptions& o) {
  const double frequency = o.machine.pistons * o.speed / (2 * std::numbers::pi);
  const int m = std::max(2, static_cast<int>(std::lround(0.5 / (o.period * frequency))));
  double energy = 0;
  const auto count = static_cast<int>(ripple.size());
  for (int k = m; k + m < count; ++k) {
    double sum = 0;
    for (int i = -m; i <= m; ++i)
      sum += ripple[k + i] * 3 * (3 * m * m + 3 * m - 1 - 5 * i * i) /
             ((2 * m - 1.0) * (2 * m + 1.0) * (2 * m + 3.0));
    energy += sum * sum;
  }
  return std::sqrt(energy / std::max(1, count - 2 * m));
}

PumpCase::Fits FitAndFollow(const Machine& machine, const PumpLog& log, const PumpLog& pulse) {
  PumpCase::Fits out;
  const auto model = BuildStateModel(machine, {});
  if (!model) return out;
  const Episode episode = PumpEpisode(log, machine), other = PumpEpisode(pulse, machine);
  out.fit = FitStates(*model, std::span(&episode, 1));
  if (!out.fit.solved()) return out;
  const StateFit followed = FollowStates(*model, std::span(&other, 1), out.fit.parameters, out.fit.noise);
  out.solved = followed.solved();
  out.log = PumpFit(out.fit);
  if (out.solved) out.pulse = PumpFit(followed);
  return out;
}

std::vector<FoundParameter> FoundOf(const StateFit& fit, const Eigen::VectorXd& truth) {
  std::vector<FoundParameter> found;
  for (Eigen::Index p = 0; p < truth.size() && fit.solved(); ++p)
    found.push_back({fit.model->parameters[static_cast<std::size_t>(p)].name, truth[p], fit.parameters[p],
                     std::sqrt(fit.covariance(p, p))});
  return found;
}

bool HoldsTruth(const FoundParameter& found) { return std::abs(found.StandardErrorsOff()) < kNormal95; }

/// A line per parameter that is identified.
std::string FoundText(const std::vector<FoundParameter>& found) {
  std::string text;
  for (const FoundParameter& p : found)
    text += fmt::format(
        "{:>14} {:>11.5g}, found {:>11.5g} +- {:>9.3g}: {:>+6.2f} % off, {:>+5.1f} standard errors{}\n",
        p.name, p.truth, p.estimate, kNormal95 * p.standard_error, 100 * p.RelativeError(),
        p.StandardErrorsOff(), HoldsTruth(p) ? "" : ", not held");
  return text;
}

/// Of each parameter, how many intervals hold the truth and the rms of what it is off in standard errors.
std::string IntervalsText(const std::vector<PumpCase>& cases) {
  std::map<std::string, std::vector<FoundParameter>> by_name;
  for (const PumpCase& c : cases)
    for (const FoundParameter& p : c.found) by_name[p.name].push_back(p);
  std::string text;
  for (const auto& [name, found] : by_name) {
    double energy = 0;
    for (const FoundParameter& p : found) energy += std::pow(p.StandardErrorsOff(), 2);
    text += fmt::format("  {:>4} {} of {}, rms {:.2f} standard errors off\n", name,
                        std::ranges::count_if(found, HoldsTruth), found.size(),
                        std::sqrt(energy / static_cast<double>(found.size())));
  }
  return text;
}

/// Of the parameters that the paper identifies the one that is furthest off, relative; 1 without a fit.
double LargestError(const std::vector<FoundParameter>& found) {
  double largest = found.empty() ? 1 : 0;
  for (std::size_t p = 0; p < kPublishedParameters && !found.empty(); ++p)
    largest = std::max(largest, std::abs(found[p].RelativeError()));
  return largest;
}

}  // namespace

PumpCase FitPump(const PumpOptions& options) {
  constexpr std::uint64_t kOther = 1'000'000;  // seed of the log that is not fitted, beyond those of any pump
  PumpCase out;
  PumpOptions other = options;
  other.manoeuvre = PumpManoeuvre::kPulse;
  other.seed += kOther;
  const PumpLog log = SimulatePump(options), pulse = SimulatePump(other);
  const Eigen::VectorXd truth = PumpParameters(options);
  const Machine file = PumpFile(true), outlet = PumpFile(false);
  PumpLog pistons = log;
  pistons.p_s = log.ripple;
  out.ripple = log.RippleRms();
  out.ripple_left = RmsOfColumn(PumpEpisode(pistons, outlet), 2);
  out.ripple_smoothed = Smoothed(log.ripple, options);
  const double begin = ThreadSeconds();
  out.all = FitAndFollow(file, log, pulse);
  out.seconds = ThreadSeconds() - begin;
  out.outlet = FitAndFollow(outlet, log, pulse);
  out.linear = FitAndFollow(LinearPumpFile(), log, pulse);
  out.found = FoundOf(out.all.fit, truth);
  out.found_outlet = FoundOf(out.outlet.fit, truth);
  if (out.outlet.solved) {
    const Episode episode = PumpEpisode(log, outlet);
    const ToldTogether together = FindToldTogether(out.outlet.fit, std::span(&episode, 1));
    out.together = together.parameters;
    for (const MissingSensor& sensor : together.sensors) out.sensors.push_back(sensor.signal);
  }
  return out;
}

bool PrintPumpIdentification(const PumpBenchmarkOptions& o) {
  std::vector<PumpCase> cases(static_cast<std::size_t>(o.machines));
  std::mutex mutex;
  ProgressBar progress("pumps", "fits");
  fmt::print("{:>5} {:>24} {:>15} {:>15} {:>15} {:>26} {:>7}\n", "pump", "ripple kPa raw/SG/left",
             "fit %  pulse", "outlet only", "linear", "worst error %, all/outlet", "CPU s");
  ForEachCase(
      o.machines, progress,
      [&](int k) {
        PumpCase& c = cases[k];
        PumpOptions options = RandomPump(o.seed + k);
        options.seconds = kRecordSeconds;
        c = FitPump(options);
        const std::lock_guard lock(mutex);
        fmt::print(
            "{:>5} {:>10.1f} {:>6.1f} {:>6.2f} {:>8.2f} {:>6.2f} {:>8.2f} {:>6.2f} {:>8.1f} {:>6.1f} {:>12.2f} {:>13.2f} {:>7.1f}  {}\n",
            o.seed + k, c.ripple / 1e3, c.ripple_smoothed / 1e3, c.ripple_left / 1e3, c.all.log, c.all.pulse,
            c.outlet.log, c.outlet.pulse, c.linear.log, c.linear.pulse, 100 * LargestError(c.found),
            100 * LargestError(c.found_outlet), c.seconds,
            c.together.empty()
                ? ""
                : fmt::format("{} together: {}", fmt::join(c.together, " "), fmt::join(c.sensors, " or ")));
        fmt::print("{}", FoundText(c.found));
        std::fflush(stdout);
      },
      o.threads);
  std::array<double, kPublishedParameters> errors{};  // mean squares
  double worst_fit = 100, worst_pulse = 100, worst_error = 0, inside = 0, judged = 0, linear = 0,
         linear_pulse = 0;
  int advised = 0;
  for (const PumpCase& c : cases) {
    for (const PumpCase::Fits* fits : {&c.all, &c.outlet}) {
      worst_fit = std::min(worst_fit, fits->log);
      worst_pulse = std::min(worst_pulse, fits->pulse);
    }
    for (std::size_t p = 0; p < errors.size(); ++p)
      errors[p] += (c.found.empty() ? 1.0 : std::pow(c.found[p].RelativeError(), 2)) / o.machines;
    inside += static_cast<double>(std::ranges::count_if(c.found, HoldsTruth));
    judged += static_cast<double>(c.found.size());
    linear += c.linear.log / o.machines;
    linear_pulse += c.linear.pulse / o.machines;
    // What is not told is said, with a sensor that would tell it.
    advised += !c.sensors.empty() || (c.outlet.solved && LargestError(c.found_outlet) < kGoalError);
  }
  inside /= std::max(judged, 1.0);
  for (const double square : errors) worst_error = std::max(worst_error, std::sqrt(square));
  fmt::print(
      "\nfit of the outlet pressure, worst of {} pumps: {:.2f} %, on a flow pulse that was not fitted {:.2f} % (goal {:g}; "
      "published {:g} %)\nthe published linear model on the same records, mean: {:.1f} %, on the pulse {:.1f} %\n"
      "K_v, K_q, C_l, K_p, V_t with both sensors of the control chamber, rms of the worst of them: {:.2f} % (goal {:g})\n"
      "95 % intervals that hold the truth: {:.1f} % (goal {:g})\n{}"
      "outlet pressure alone: parameters it does not tell said, with the sensor that would: {} of {}\n",
      o.machines, worst_fit, worst_pulse, kGoalFit, kPublishedFit, linear, linear_pulse, 100 * worst_error,
      100 * kGoalError, 100 * inside, 100 * kGoalInside, IntervalsText(cases), advised, o.machines);
  return worst_fit >= kGoalFit && worst_pulse >= kGoalFit && worst_error <= kGoalError &&
         inside >= kGoalInside && advised == o.machines;
}

}  // namespace hydroscope
