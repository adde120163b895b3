#include "studies/flexible_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "diagnosis/states/explain_states.h"
#include "simulator/random.h"
#include "studies/effect_tally.h"
#include "studies/parallel.h"

namespace hydroscope {
namespace {

constexpr const char* kAxisFile = R"toml([machine]
name = "flexible_axis"
model = "flexible_axis"
[log]
hold = "zero"
[signals]
U = { column = "U", unit = "V" }
position = { column = "x_p", unit = "m" }
load_position = { column = "x_l", unit = "m" }
acceleration = { column = "a_p", unit = "m/s2" }
pressure_1 = { column = "p_1", unit = "Pa" }
pressure_2 = { column = "p_2", unit = "Pa" }
[geometry]
m_1 = { value = 210, unit = "kg" }
m_2 = { value = 80, unit = "kg" }
A_1 = { value = 8.04, unit = "cm2" }
A_2 = { value = 4.24, unit = "cm2" }
V_01 = { value = 0.213, unit = "l" }
V_02 = { value = 0.107, unit = "l" }
L = { value = 1, unit = "m" }
p_s = { value = 140, unit = "bar" }
p_t = { value = 9, unit = "bar" }
k = { value = 42950, unit = "N/m" }
)toml";

FlexibleAxisOptions Staircase(const FlexibleAxisMachine& machine, std::uint64_t seed) {
  FlexibleAxisOptions o;
  o.machine = machine;
  o.manoeuvre = AxisManoeuvre::kStaircase;
  o.seed = seed;
  return o;
}

/// Seconds of the thread for one run without sensitivities at the truth.
double PlainRunSeconds(std::shared_ptr<const StateModel> model, const Episode& episode,
                       const Eigen::VectorXd& truth) {
  StateSimulator simulator(std::move(model));
  simulator.SetParameters(truth);
  Eigen::VectorXd x0 = Eigen::VectorXd::Zero(simulator.model().states());
  x0 << episode.signal(0, 1), 0, episode.signal(0, 2), 0, episode.signal(0, 4), episode.signal(0, 5), 0, 0;
  StateRun run;
  double best = 1e300;
  for (int k = 0; k < 3; ++k) {
    const double begin = ThreadSeconds();
    simulator.Run(episode, 0, episode.rows() - 1, simulator.Initial(episode, x0), nullptr, run);
    best = std::min(best, ThreadSeconds() - begin);
  }
  return best;
}

/// Error of the bulk modulus that a fit gives at a pressure, %.
double ModulusError(const Eigen::VectorXd& p, const FlexibleAxisMachine& machine, double pressure) {
  constexpr int kLow = 6, kHigh = 7, kShift = 8;
  const double share =
      std::log((pressure + p[kShift]) / (2e6 + p[kShift])) / std::log((10e6 + p[kShift]) / (2e6 + p[kShift]));
  return 100 * ((p[kLow] + share * (p[kHigh] - p[kLow])) / machine.BulkModulus(pressure) - 1);
}

/// The published axis, fitted to the staircase, runs freely along the manoeuvres that the paper validates with; initial states
/// alone are estimated there. True if the error is near the sensors' noise on all of them.
bool PrintValidation(const StateModel& model, const FlexibleAxisStudyOptions& o) {
  // Rms error over the sensors' noise; 8 V is twice what the staircase has, and shows what that leaves open of the parameters.
  constexpr double kMost = 1.5;
  constexpr int kReadings = 5;  // per row
  FlexibleAxisOptions options = Staircase({}, o.seed);
  const Episode staircase = FlexibleAxisEpisode(SimulateFlexibleAxis(options));
  StateFitOptions starts;
  starts.starts = o.starts - 1;
  const Eigen::VectorXd truth = FlexibleAxisParameters(options.machine);
  const StateFit fit = FitStates(StartedWithinTen(model, truth, o.seed), std::span(&staircase, 1), starts);
  if (!fit.solved()) return false;
  bool good = true;
  fmt::print(
      "\npublished axis, run freely along: rms error over the noise   fitted to the staircase   at the truth\n");
  for (const AxisManoeuvreInfo& info : AllAxisManoeuvres()) {
    if (info.manoeuvre == AxisManoeuvre::kStaircase) continue;
    options.manoeuvre = info.manoeuvre;
    ++options.seed;
    const Episode other = FlexibleAxisEpisode(SimulateFlexibleAxis(options));
    const auto error = [&](const Eigen::VectorXd& parameters) {
      const StateFit followed = FollowStates(fit.model, std::span(&other, 1), parameters, fit.noise);
      return followed.solved() ? std::sqrt(ChiSquare(followed, options.sensors) / (kReadings * other.rows()))
                               : std::numeric_limits<double>::infinity();
    };
    const double fitted = error(fit.parameters);
    good = good && fitted < kMost;
    fmt::print("  {:<14} {:<42} {:>24.3f} {:>14.3f}\n", info.name, info.meaning, fitted, error(truth));
  }
  return good;
}

/// Of all parameters, in standard deviations.
double WorstError(const StateFit& fit, const Eigen::VectorXd& truth) {
  double worst = 0;
  for (Eigen::Index p = 0; p < truth.size(); ++p) {
    const double deviation = std::sqrt(std::max(fit.covariance(p, p), 1e-300));
    worst = std::max(worst, std::abs(fit.parameters[p] - truth[p]) / deviation);
  }
  return worst;
}

int RunStarts(const FlexibleAxisStudyOptions& o) {
  constexpr double kNear = 20;  // of a chi square
  const auto model = BuildStateModel(FlexibleAxisFile(), {});
  if (!model) {
    fmt::print(stderr, "{}\n", model.error().text);
    return 1;
  }
  StateFitOptions one, several;
  one.starts = 0;
  several.starts = o.starts - 1;
  int reached = 0, first = 0;
  std::vector<double> times, equivalents;
  fmt::print("{:>7} {:>10} {:>7} {:>9} {:>11} {:>14} {:>12}  {}\n", "machine", "sigma_0", "starts", "CPU s",
             "plain runs", "above the best", "worst error", "bulk modulus at 2, 5, 10 MPa, %");
  for (int k = 0; k < o.machines; ++k) {
    const std::uint64_t seed = o.seed + k;
    const FlexibleAxisOptions options = Staircase(RandomFlexibleAxis(seed), seed);
    const Episode episode = FlexibleAxisEpisode(SimulateFlexibleAxis(options));
    const Eigen::VectorXd truth = FlexibleAxisParameters(options.machine);
    const double plain = PlainRunSeconds(*model, episode, truth);
    const auto started = StartedWithinTen(**model, truth, seed);
    const double begin = ThreadSeconds();
    const StateFit found = FitStates(started, std::span(&episode, 1), several);
    const double seconds = ThreadSeconds() - begin;
    const int starts = found.starts_tried;
    const double best = found.solved() ? ChiSquare(found, options.sensors) : 1e300;
    // What is best: the minimum that the truth leads to.
    auto at_truth = std::make_shared<StateModel>(**model);
    for (Eigen::Index p = 0; p < truth.size(); ++p) at_truth->parameters[p].spec.start = truth[p];
    const StateFit reference = FitStates(at_truth, std::span(&episode, 1), one);
    const double least = reference.solved() ? std::min(best, ChiSquare(reference, options.sensors)) : best;
    const bool near = best - least < kNear;
    reached += near;
    first += near && starts == 1;
    const double worst = found.solved() ? WorstError(found, truth) : 0;
    std::array<double, 3> beta{};
    constexpr std::array<double, 3> kAt = {2e6, 5e6, 10e6};  // Pa
    for (std::size_t i = 0; found.solved() && i < kAt.size(); ++i)
      beta[i] = ModulusError(found.parameters, options.machine, kAt[i]);
    times.push_back(seconds);
    equivalents.push_back(seconds / plain);
    fmt::print("{:>7} {:>10.3g} {:>7} {:>9.2f} {:>11.0f} {:>14.1f} {:>8.1f} std  {:+.3f} {:+.3f} {:+.3f}\n",
               seed, options.machine.bristle_stiffness, starts, seconds, seconds / plain, best - least, worst,
               beta[0], beta[1], beta[2]);
    std::fflush(stdout);
  }
  const auto median = [](std::vector<double> v) {
    std::ranges::sort(v);
    return v[v.size() / 2];
  };
  fmt::print(
      "\n{} of {} machines within a chi square of {:g} of the best ({} from the first start); median {:.2f} s and {:.0f} "
      "plain runs\npublished, differential evolution on a +1 V step: 46 020 iterations, cost 35.6 -> 5.6 "
      "(1484) -> 1.28 (29 586)\n",
      reached, o.machines, kNear, first, median(times), median(equivalents));
  const bool goal = PrintValidation(**model, o) && reached * 20 >= 19 * o.machines;
  fmt::print("{}\n", goal ? "all goals reached" : "NOT all goals reached");
  return goal ? 0 : 1;
}

int RunEffects(const FlexibleAxisStudyOptions& o) {
  constexpr std::array<double, 3> kSizes = {1, 0.5, 2};  // of the typical one, machine by machine
  const Machine machine = FlexibleAxisFile();
  EffectTally tally;
  for (int k = 0; k < o.machines; ++k)
    for (std::size_t f = 0; f <= AllFlexibleAxisFaults().size(); ++f) {
      const std::uint64_t seed = (o.seed + k) * 100 + f;
      FlexibleAxisOptions options =
          Staircase(k == 0 ? FlexibleAxisMachine{} : RandomFlexibleAxis(seed), seed);
      std::string id = "-";
      double size = 0;
      if (f < AllFlexibleAxisFaults().size()) {
        const FlexibleAxisFault& fault = AllFlexibleAxisFaults()[f];
        id = fault.id;
        size = options.faults.*fault.size =
                   kSizes[static_cast<std::size_t>(k) % kSizes.size()] * fault.typical;
      }
      if (!o.only.empty() && id != o.only) continue;
      const Episode episode = FlexibleAxisEpisode(SimulateFlexibleAxis(options));
      const double begin = ThreadSeconds();
      const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
      fmt::print("{:>4} {}, {:.1f} s\n", seed, tally.Add(id, size, x), ThreadSeconds() - begin);
      std::fflush(stdout);
    }
  fmt::print("{}{}\n", tally.Table(), tally.Reached() ? "all goals reached" : "NOT all goals reached");
  return tally.Reached() ? 0 : 1;
}

}  // namespace

Machine FlexibleAxisFile() {
  const auto machine = ParseMachine(kAxisFile, "flexible axis");
  if (!machine) fmt::print(stderr, "{}\n", machine.error().text);
  return machine.value_or(Machine{});
}

Episode FlexibleAxisEpisode(const FlexibleAxisLog& log) {
  Episode episode;
  episode.time = log.t;
  episode.signal.resize(static_cast<Eigen::Index>(log.t.size()), 6);
  for (std::size_t i = 0; i < log.t.size(); ++i)
    episode.signal.row(i) << log.U[i], log.x_p[i], log.x_l[i], log.a_p[i], log.p_1[i], log.p_2[i];
  return episode;
}

Eigen::VectorXd FlexibleAxisParameters(const FlexibleAxisMachine& m) {
  const double nominal = 10 * std::sqrt(35e5), shift = m.modulus_shift * 28e6 / m.modulus_rise;
  Eigen::VectorXd p(15);
  p << nominal * m.flow_gain, m.spool_time, m.damper, m.internal_leakage, m.external_leakage_1,
      m.external_leakage_2, m.BulkModulus(2e6), m.BulkModulus(10e6), shift, m.bristle_stiffness,
      m.bristle_damping, m.viscous_friction, m.coulomb_friction, m.static_friction - m.coulomb_friction,
      m.stribeck_speed;
  return p;
}

std::shared_ptr<const StateModel> StartedWithinTen(const StateModel& model, const Eigen::VectorXd& truth,
                                                   std::uint64_t seed) {
  RandomStream random(StreamSeed(seed, "start"));
  auto started = std::make_shared<StateModel>(model);
  for (Eigen::Index p = 0; p < truth.size(); ++p) {
    ParameterSpec& spec = started->parameters[p].spec;
    spec.start = truth[p] * std::pow(10, random.Uniform(-1, 1));
    spec.min = truth[p] / 10;
    spec.max = truth[p] * 10;
  }
  return started;
}

double ChiSquare(const StateFit& fit, const AxisSensors& s) {
  const Eigen::Vector<double, 5> noise{s.position, s.position, s.acceleration, s.pressure, s.pressure};
  double sum = 0;
  for (const RowMatrix& residual : fit.residuals)
    for (int j = 0; j < 5; ++j) sum += residual.col(j).squaredNorm() / (noise[j] * noise[j]);
  return sum;
}

int RunFlexibleAxisStudy(const FlexibleAxisStudyOptions& options) {
  return options.effects ? RunEffects(options) : RunStarts(options);
}

}  // namespace hydroscope
