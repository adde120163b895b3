// Models with states: what sensitivities cost beside a plain run, what expressions of a machine file cost beside the same by
// hand, and a fit. Writes the log of the fit for scipy_states.py (bench/states.sh runs both).

#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "estimation/states/fit.h"
#include "simulator/own_states/machines.h"

namespace hydroscope {
namespace {

constexpr int kRows = 2000;

/// A valve, a cylinder and a load on a spring: four states, sixteen parameters.
const char* const kSixteen = R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
p = { column = "p", unit = "1" }
w = { column = "w", unit = "1" }
[states]
q = { ddt = "k*(a*(u - u_0)*sqrt(max(1 - sign(u)*q/p_s, 0)) - v - l*q - l_2*q*abs(q))", initial = 0 }
v = { ddt = "(f*q - s*z - s_3*z^3 - b*(v - v_l) - c*tanh(v/v_c) - d*v)/m", initial = 0 }
z = { ddt = "v - v_l", initial = 0 }
v_l = { ddt = "(s*z + s_3*z^3 + b*(v - v_l) - d_l*v_l - g*v_l*abs(v_l))/m_l", initial = 0 }
[outputs]
p = "q"
w = "v"
[parameters]
k = { start = 3000 }
a = { start = 1 }
u_0 = { start = 0.01 }
p_s = { start = 60 }
l = { start = 0.01 }
l_2 = { start = 0.0001 }
f = { start = 1 }
s = { start = 3000 }
s_3 = { start = 1000 }
b = { start = 5 }
c = { start = 1 }
v_c = { start = 0.1 }
d = { start = 0.5 }
m = { start = 1 }
d_l = { start = 2 }
g = { start = 0.1 }
[geometry]
m_l = { value = 1 }
)toml";

/// A spring that hardens; the same as HandWritten below.
const char* const kOscillator = R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "v", initial = "estimate" }
v = { ddt = "w0^2*(u - x) - d*v - k3*x^3", initial = "estimate" }
[outputs]
y = "x"
[parameters]
w0 = { start = 380 }
d = { start = 30 }
k3 = { start = 6e5 }
)toml";

const char* const kTanks = R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "1" }
[states]
h_1 = { ddt = "pump*u - k1*sqrt(max(h_1, 0))", initial = "estimate", min = 0, max = 100 }
h_2 = { ddt = "k1*sqrt(max(h_1, 0)) - k2*sqrt(max(h_2, 0))", initial = "estimate", min = 0, max = 100 }
[outputs]
y = "h_2"
[parameters]
k1 = { start = 0.2, min = 0.005, max = 1 }
k2 = { start = 0.2, min = 0.005, max = 1 }
pump = { start = 0.2, min = 0.005, max = 1 }
)toml";

std::shared_ptr<const StateModel> ModelOf(const char* text) {
  const auto machine = ParseMachine(text, "bench.toml");
  const auto model = machine ? BuildStateModel(*machine, {}) : tl::unexpected(machine.error());
  if (model) return *model;
  std::fprintf(stderr, "%s\n", model.error().text.c_str());
  std::exit(1);
}

Episode EpisodeOf(const StatesLog& log) {
  Episode episode;
  episode.time = log.time;
  episode.signal.resize(static_cast<Eigen::Index>(log.time.size()),
                        static_cast<Eigen::Index>(1 + log.outputs.size()));
  for (std::size_t row = 0; row < log.time.size(); ++row) {
    episode.signal(static_cast<Eigen::Index>(row), 0) = log.input[row];
    for (std::size_t j = 0; j < log.outputs.size(); ++j)
      episode.signal(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(j) + 1) = log.outputs[j][row];
  }
  return episode;
}

/// CPU seconds of `work`, best of `repeats`.
template <typename Work>
double Best(int repeats, const Work& work) {
  double best = 1e300;
  for (int i = 0; i < repeats; ++i) {
    const std::clock_t start = std::clock();
    work();
    best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return best;
}

/// Seconds of a run over the episode, with sensitivities (by parameters and initial states) or without.
double SecondsOfRun(const StateModel& model, const Episode& episode, bool slopes, int repeats,
                    double* end = nullptr) {
  StateSimulator simulator(std::make_shared<const StateModel>(model));
  Eigen::VectorXd theta(model.parameter_count());
  for (int p = 0; p < theta.size(); ++p) theta[p] = model.parameters[static_cast<std::size_t>(p)].spec.start;
  simulator.SetParameters(theta);
  int free = 0;
  for (const bool estimated : model.estimated) free += estimated;
  RowMatrix start = RowMatrix::Zero(model.states(), model.parameter_count() + free);
  for (int i = 0; i < free; ++i) start(i, model.parameter_count() + i) = 1;
  const Eigen::VectorXd x0 = Eigen::VectorXd::Zero(model.states());
  StateRun run;
  const double best = Best(
      repeats, [&] { simulator.Run(episode, 0, episode.rows() - 1, x0, slopes ? &start : nullptr, run); });
  if (run.diverged) std::exit(1);
  if (end != nullptr) *end = slopes ? run.slopes(run.slopes.rows() - 1, 0) : run.outputs(run.rows - 1, 0);
  return best;
}

/// The oscillator with its sensitivities as one would write them for this model alone: Dormand and Prince's method with the
/// same control of its steps, everything of fixed size.
class HandWritten {
 public:
  static constexpr int kColumns = 5;  // w0, d, k3, x(0), v(0)
  using State = std::array<double, 2 + 2 * kColumns>;

  double Run(const Episode& episode) {
    State s{};
    s[2 + 3] = 1;
    s[2 + kColumns + 4] = 1;
    double share = 1, sum = 0;
    scale_ = {0, 0};
    for (int row = 0;; ++row) {
      for (int c = 0; c < kColumns; ++c) sum += s[static_cast<std::size_t>(2 + c)];
      if (row + 1 == episode.rows()) break;
      const auto at = static_cast<std::size_t>(row);
      const double u = episode.signal(row, 0), period = episode.time[at + 1] - episode.time[at];
      for (double done = 0; done < 1 - 1e-9;) {
        const double step = std::min(share, 1 - done);
        double error = 0;
        const State next = Step(s, u, step * period, error);
        const double factor = 0.9 * std::pow(1e-5 / std::max(error, 1e-30), 0.2);
        if (error > 1e-5) {
          share = step * std::clamp(factor, 0.2, 1.0);
          continue;
        }
        s = next;
        done += step;
        for (std::size_t i = 0; i < 2; ++i) scale_[i] = std::max(scale_[i], std::abs(s[i]));
        if (step >= share || factor < 1) share = std::min(1.0, step * std::clamp(factor, 0.2, 5.0));
      }
    }
    slope_ = s[2];
    return sum;
  }
  double slope() const { return slope_; }  ///< of the last output by w0

 private:
  static constexpr double kW0 = 380, kD = 30, kK3 = 6e5;

  static State Rate(const State& s, double u) {
    State out;
    const double x = s[0], v = s[1], stiffness = -kW0 * kW0 - 3 * kK3 * x * x;
    out[0] = v;
    out[1] = kW0 * kW0 * (u - x) - kD * v - kK3 * x * x * x;
    for (std::size_t c = 0; c < kColumns; ++c) {
      out[2 + c] = s[2 + kColumns + c];
      out[2 + kColumns + c] = stiffness * s[2 + c] - kD * s[2 + kColumns + c];
    }
    out[2 + kColumns] += 2 * kW0 * (u - x);
    out[2 + kColumns + 1] -= v;
    out[2 + kColumns + 2] -= x * x * x;
    return out;
  }

  State Step(const State& s, double u, double h, double& error) const {
    const auto plus = [&](std::initializer_list<std::pair<double, const State*>> terms) {
      State out = s;
      for (const auto& [weight, k] : terms)
        for (std::size_t i = 0; i < out.size(); ++i) out[i] += h * weight * (*k)[i];
      return out;
    };
    const State
        a = Rate(s, u),
        b = Rate(plus({{0.2, &a}}), u), c = Rate(plus({{3.0 / 40, &a}, {9.0 / 40, &b}}), u),
        d = Rate(plus({{44.0 / 45, &a}, {-56.0 / 15, &b}, {32.0 / 9, &c}}), u),
        e = Rate(
            plus({{19372.0 / 6561, &a}, {-25360.0 / 2187, &b}, {64448.0 / 6561, &c}, {-212.0 / 729, &d}}), u),
        f = Rate(plus({{9017.0 / 3168, &a},
                       {-355.0 / 33, &b},
                       {46732.0 / 5247, &c},
                       {49.0 / 176, &d},
                       {-5103.0 / 18656, &e}}),
                 u),
        end = plus(
            {{35.0 / 384, &a}, {500.0 / 1113, &c}, {125.0 / 192, &d}, {-2187.0 / 6784, &e}, {11.0 / 84, &f}});
    const State g = Rate(end, u);
    for (std::size_t i = 0; i < 2; ++i) {
      const double difference = h * (71.0 / 57600 * a[i] - 71.0 / 16695 * c[i] + 71.0 / 1920 * d[i] -
                                     17253.0 / 339200 * e[i] + 22.0 / 525 * f[i] - g[i] / 40);
      const double size = std::max({scale_[i], std::abs(s[i]), std::abs(end[i]), 1e-300});
      error = std::max(error, std::abs(difference) / size);
    }
    return end;
  }

  std::array<double, 2> scale_{};
  double slope_ = 0;
};

int Run(const char* path, int repeats) {
  const Episode actuator = EpisodeOf(SimulateStates({StateMachineKind::kActuator, "", 1, kRows}));
  const auto sixteen = ModelOf(kSixteen);
  const double plain = SecondsOfRun(*sixteen, actuator, false, repeats),
               with = SecondsOfRun(*sixteen, actuator, true, repeats);
  std::printf("plain_run %.9f 4 states\n", plain);
  std::printf("run_with_16_parameters %.9f %.2f times the plain one\n", with, with / plain);

  const Episode oscillator = EpisodeOf(SimulateStates({StateMachineKind::kOscillator, "", 1, kRows}));
  double ours = 0;
  const double expressions = SecondsOfRun(*ModelOf(kOscillator), oscillator, true, repeats, &ours);
  HandWritten hand;
  const double by_hand = Best(repeats, [&] { return hand.Run(oscillator); });
  std::printf("by_hand_with_sensitivities %.9f 2 states, 5 columns\n", by_hand);
  std::printf("machine_file_with_sensitivities %.9f %.2f times by hand; slopes at the end %.6g and %.6g\n",
              expressions, expressions / by_hand, ours, hand.slope());

  const StatesLog tanks = SimulateStates({StateMachineKind::kTanks, "", 1, kRows});
  const Episode episode = EpisodeOf(tanks);
  auto file = fmt::output_file(path);
  file.print("t,u,y\n");
  for (std::size_t row = 0; row < tanks.time.size(); ++row)
    file.print("{},{},{}\n", tanks.time[row], tanks.input[row], tanks.outputs[0][row]);
  StateFitOptions options;
  options.starts = 0;  // that of the machine file alone, as scipy has it
  StateFit fit;
  const auto model = ModelOf(kTanks);
  const double seconds =
      Best(std::min(repeats, 3), [&] { fit = FitStates(model, std::span(&episode, 1), options); });
  if (!fit.solved()) return 1;
  std::printf("machine_file_fit %.9f k1 %.6f k2 %.6f pump %.6f\n", seconds, fit.parameters[0],
              fit.parameters[1], fit.parameters[2]);
  return 0;
}

}  // namespace
}  // namespace hydroscope

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: states_bench FILE_FOR_THE_LOG [REPEATS]\n");
    return 2;
  }
  return hydroscope::Run(argv[1], argc > 2 ? std::atoi(argv[2]) : 20);
}
