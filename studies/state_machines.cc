#include "studies/state_machines.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <random>

#include "core/contains.h"
#include "diagnosis/states/held_out_run.h"
#include "studies/parallel.h"

namespace hydroscope {
namespace {

/// A kind's file, and its effects by id.
struct KindFile {
  const char* head;
  std::vector<std::pair<const char*, const char*>> effects;
  std::vector<const char*> hidden;
};

const KindFile& OscillatorFile() {
  static const KindFile file = {
      R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "v", initial = "estimate" }
v = { ddt = "w0^2*(u - x) - d*v", initial = "estimate" }
[outputs]
y = "gain*x + zero"
[parameters]
gain = { start = 1, min = 0.5, max = 2 }
zero = { start = 0, min = -1, max = 1 }
w0 = { start = 250, min = 100, max = 1000 }
d = { start = 10, min = 1, max = 300 }
)toml",
      {{"cubic", "adds = { v = \"-k3*x^3\" }\nparameters = { k3 = { start = 1e5, min = 0, max = 1e8 } }\n"},
       {"quadratic",
        "adds = { v = \"-k2*x^2\" }\nparameters = { k2 = { start = 1e4, min = -1e7, max = 1e7 } }\n"},
       {"coulomb",
        "adds = { v = \"-c*tanh(v/0.5)\" }\nparameters = { c = { start = 100, min = 0, max = 1e5 } }\n"},
       {"drag",
        "adds = { v = \"-q*v*abs(v)\" }\nparameters = { q = { start = 0.1, min = 0, max = 100 } }\n"}},
      {"cubic", "drag", "coulomb"}};
  return file;
}

const KindFile& TanksFile() {
  static const KindFile file = {
      R"toml([log]
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
)toml",
      {{"overflow",
        "adds = { h_1 = \"-c*max(h_1 - brim, 0)\" }\n"
        "parameters = { brim = { start = 20, min = 1, max = 100 }, c = { start = 1, min = 0.1, max = 10 } }\n"},
       {"spill",
        "adds = { h_1 = \"-c*max(h_1 - brim, 0)\", h_2 = \"part*c*max(h_1 - brim, 0)\" }\n"
        "parameters = { brim = { start = 20, min = 1, max = 100 }, c = { start = 1, min = 0.1, max = 10 }, "
        "part = { start = 0.2, min = 0, max = 1 } }\n"},
       {"leak", "adds = { h_1 = \"-l*h_1\" }\nparameters = { l = { start = 0.001, min = 0, max = 0.1 } }\n"},
       {"offset", "adds = { y = \"b\" }\nparameters = { b = { start = 0, min = -2, max = 2 } }\n"},
       {"pump_curve",
        "adds = { h_1 = \"-g*u^2\" }\nparameters = { g = { start = 0.001, min = 0, max = 0.1 } }\n"}},
      {"overflow", "leak", "spill"}};
  return file;
}

const KindFile& ActuatorFile() {
  static const KindFile file = {
      R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
p = { column = "p", unit = "1" }
w = { column = "w", unit = "1" }
[states]
q = { ddt = "k*(a*u - v - l*q)", initial = "p - p_0" }
v = { ddt = "f*q - s*z - b*(v - v_l)", initial = "w - w_0" }
z = { ddt = "v - v_l", initial = "estimate" }
v_l = { ddt = "s*z + b*(v - v_l) - 2*v_l", initial = "estimate" }
[outputs]
p = "q + p_0"
w = "v + w_0"
[parameters]
f = { start = 1, min = 0.3, max = 3 }
p_0 = { start = 0, min = -20, max = 20 }
w_0 = { start = 0, min = -1, max = 1 }
k = { start = 2000, min = 500, max = 20000 }
a = { start = 0.5, min = 0.1, max = 5 }
l = { start = 0.02, min = 0.001, max = 0.2 }
s = { start = 1500, min = 300, max = 20000 }
b = { start = 2, min = 0.5, max = 50 }
)toml",
      {{"coulomb",
        "adds = { v = \"-c*tanh(v/0.02)\" }\nparameters = { c = { start = 1, min = 0, max = 100 } }\n"},
       {"root_flow",
        "adds = { q = \"k*a*u*(sqrt(max(1 - sign(u)*q/ps, 0)) - 1)\" }\n"
        "parameters = { ps = { start = 60, min = 10, max = 1000 } }\n"},
       {"drag", "adds = { v = \"-g*v*abs(v)\" }\nparameters = { g = { start = 1, min = 0, max = 1000 } }\n"},
       {"hardening",
        "adds = { v = \"-h*z^3\" }\nparameters = { h = { start = 1e4, min = 0, max = 1e10 } }\n"}},
      {"coulomb", "root_flow"}};
  return file;
}

const KindFile& FileOf(StateMachineKind kind) {
  return kind == StateMachineKind::kOscillator ? OscillatorFile()
         : kind == StateMachineKind::kTanks    ? TanksFile()
                                               : ActuatorFile();
}

constexpr std::array<const char*, 3> kKindNames = {"oscillator", "tanks", "actuator"};

/// Errors of the machine's next log, initial states estimated, over its noise: of the free run, and where
/// that is more than noise of short ones.
struct NextLog {
  double error = 0, short_error = 0;
};
NextLog NextLogOf(const StateMachineCase& one, const Machine& machine, const StateFit& fit) {
  // The same machine: parameters are drawn first, so a longer log of the same seed goes on where this one ends.
  SimulatedStates longer = one.simulated;
  longer.rows *= 2;
  const StatesLog log = SimulateStates(longer);
  const Episode whole = EpisodeOf(log, machine);
  const auto rows = static_cast<Eigen::Index>(one.simulated.rows);
  const Episode next{0, rows, {whole.time.begin() + rows, whole.time.end()}, whole.signal.bottomRows(rows)};
  const StateFit followed = FollowStates(fit.model, std::span(&next, 1), fit.parameters, fit.noise);
  if (!followed.solved()) return {INFINITY, 0};
  const Eigen::VectorXd rms = RmsOf(followed.residuals, followed.model->output.rows);
  NextLog out;
  for (Eigen::Index j = 0; j < rms.size(); ++j) out.error = std::max(out.error, rms[j] / log.noise[j]);
  const Episode recorded{0, 0, {whole.time.begin(), whole.time.begin() + rows}, whole.signal.topRows(rows)};
  out.short_error = LookAtHeldOut(fit, std::span(&recorded, 1), followed, std::span(&next, 1)).short_error;
  return out;
}

}  // namespace

Machine StatesMachine(StateMachineKind kind, const std::string& without) {
  const KindFile& file = FileOf(kind);
  std::string text = file.head;
  const auto left_out = [&](const std::string& id) {
    return id == without || (id == "spill" && without == "overflow");  // the former holds the latter
  };
  for (const auto& [id, rest] : file.effects)
    if (!left_out(id)) text += fmt::format("[[effect]]\nid = \"{}\"\n{}", id, rest);
  const auto machine = ParseMachine(text, kKindNames[static_cast<std::size_t>(kind)]);
  if (!machine) std::fprintf(stderr, "%s\n", machine.error().text.c_str());
  return machine.value_or(Machine{});
}

Episode EpisodeOf(const StatesLog& log, const Machine& machine) {
  Episode episode;
  episode.time = log.time;
  episode.signal.resize(static_cast<Eigen::Index>(log.time.size()),
                        static_cast<Eigen::Index>(machine.signals.size()));
  for (Eigen::Index row = 0; row < episode.signal.rows(); ++row) {
    const auto at = static_cast<std::size_t>(row);
    episode.signal(row, 0) = log.input[at];
    for (std::size_t j = 0; j < log.outputs.size(); ++j)
      episode.signal(row, static_cast<Eigen::Index>(j) + 1) = log.outputs[j][at];
  }
  return episode;
}

StateMachineCase CaseNumber(int number, const StateMachinesOptions& options) {
  StateMachineCase out;
  SimulatedStates& simulated = out.simulated;
  simulated.kind = static_cast<StateMachineKind>(number % 3);
  simulated.seed = options.seed * 1000 + number;
  const int turn = number / 3 % 4;  // two known effects, one unknown, one healthy
  simulated.measured = number / 12 % 2 == 1;
  simulated.rows = options.rows;
  if (simulated.measured) {
    std::mt19937_64 random(simulated.seed);
    simulated.rows = static_cast<int>(1000 * std::pow(8, std::uniform_real_distribution<double>()(random)));
  }
  const auto& hidden = FileOf(simulated.kind).hidden;
  if (turn < 3) simulated.hidden = hidden[static_cast<std::size_t>(number / 3 + number / 24) % hidden.size()];
  out.known = turn != 2;
  return out;
}

void StateMachinesScore::Add(const StateMachinesScore& other) {
  hidden += other.hidden;
  first += other.first;
  unknown_law += other.unknown_law;
  unknown += other.unknown;
  healthy += other.healthy;
  adequate += other.adequate;
  wrong += other.wrong;
  cases += other.cases;
  worst_ratio = std::max(worst_ratio, other.worst_ratio);
}

StateMachineOutcome RunCase(int number, const StateMachinesOptions& options) {
  const StateMachineCase one = CaseNumber(number, options);
  const std::string& hidden = one.simulated.hidden;
  const Machine machine = StatesMachine(one.simulated.kind, one.known ? "" : hidden);
  const Episode episode = EpisodeOf(SimulateStates(one.simulated), machine);
  const double begin = ThreadSeconds();
  const StatesExplanation x = ExplainStates(machine, std::span(&episode, 1));
  const double seconds = ThreadSeconds() - begin;
  StateMachineOutcome out;
  out.measured = one.simulated.measured;
  StateMachinesScore& score = out.score;
  score.cases = 1;
  const bool in_set = Contains(x.set, hidden);
  score.wrong = !x.set.empty() && !in_set;
  NextLog next;
  if (hidden.empty()) {
    score.healthy = 1;
    score.adequate = x.verdict == Verdict::kAdequate;
  } else if (one.known) {
    score.hidden = 1;
    score.first = !x.set.empty() && x.set.front() == hidden;
    if (score.first > 0) next = NextLogOf(one, machine, x.final.fit);
    score.worst_ratio = next.error;
  } else {
    score.unknown_law = 1;
    score.unknown = x.verdict == Verdict::kUnknown;
  }
  const std::string in_short_runs =
      next.short_error > 0 ? fmt::format(" ({:.2f} x in short runs)", next.short_error) : "";
  out.line = fmt::format(
      "{:>4} {:<10} {:<8} {:>5} rows, hidden {:<10}{:<9} {:<9} [{}]{} left {:.3f} -> {:.3f} ({:.2g}){}, {:.1f} s{}\n",
      number, kKindNames[static_cast<std::size_t>(one.simulated.kind)], out.measured ? "measured" : "ideal",
      one.simulated.rows, hidden.empty() ? "-" : hidden, one.known ? "" : " (absent)", VerdictName(x.verdict),
      fmt::join(x.set, ", "), x.nearest.empty() ? "" : fmt::format(" part {}", fmt::join(x.nearest, ", ")),
      x.base_left.share, x.final_left.share, x.unexplained,
      next.error == 0 ? "" : fmt::format(", next log {:.2f} x noise{}", next.error, in_short_runs), seconds,
      score.wrong > 0 ? " WRONG" : "");
  return out;
}

int RunStateMachines(const StateMachinesOptions& options) {
  std::vector<StateMachineOutcome> outcomes(static_cast<std::size_t>(options.cases));
  std::mutex mutex;
  ProgressBar progress("state machines", "cases");
  ForEachCase(
      options.cases, progress,
      [&](int number) {
        StateMachineOutcome& outcome = outcomes[number];
        outcome = RunCase(options.first + number, options);
        const std::lock_guard lock(mutex);
        fmt::print("{}", outcome.line);
        std::fflush(stdout);
      },
      options.threads);
  bool reached = true;
  for (const bool measured : {false, true}) {
    StateMachinesScore score;
    for (const StateMachineOutcome& outcome : outcomes)
      if (outcome.measured == measured) score.Add(outcome.score);
    if (score.cases == 0) continue;
    fmt::print(
        "\n{} {} logs: known effect named first {} of {}, law absent called unknown {} of {}, healthy adequate {} of "
        "{}, wrong {}; error of the next log at most {:.2f} times its noise\n",
        score.cases, measured ? "measured" : "ideal", score.first, score.hidden, score.unknown,
        score.unknown_law, score.adequate, score.healthy, score.wrong, score.worst_ratio);
    reached = reached && score.first >= 0.95 * score.hidden && score.wrong <= 0.01 * score.cases;
  }
  fmt::print("{}\n", reached ? "all goals reached" : "NOT all goals reached");
  return reached ? 0 : 1;
}

}  // namespace hydroscope
