#include <fmt/format.h>

#include <array>
#include <mutex>

#include "diagnosis/states/explain_states.h"
#include "estimation/linear_form/starts.h"
#include "studies/effect_tally.h"
#include "studies/manipulator/benchmark.h"
#include "studies/manipulator/identification.h"
#include "studies/parallel.h"

namespace hydroscope {
namespace {

constexpr double kLogSeconds = 30, kPeriodOfRows = 0.01;  // s, of the logs that are explained

constexpr std::array<double, 3> kSizes = {1, 0.5, 2};  // of the typical one, round by round

struct EffectOutcome {
  std::string hidden = "-";
  double size = 0, seconds = 0;
  StatesExplanation explanation;
};

EffectOutcome ExplainOne(int number, const ManipulatorBenchmarkOptions& o) {
  const std::uint64_t seed = o.seed * 7919 + number;
  const auto& effects = ManipulatorEffects();
  // One healthy log after all the effects, again and again.
  const std::size_t turn = static_cast<std::size_t>(number) % (effects.size() + 1);
  EffectOutcome out;
  if (turn < effects.size()) {
    out.hidden = effects[turn].id;
    out.size = effects[turn].typical_size *
               kSizes[static_cast<std::size_t>(number) / (effects.size() + 1) % kSizes.size()];
  }
  ManipulatorOptions options;
  options.truth = DrawnManipulator(seed);
  const IdentifiedManipulator before = Identify(options.truth, DrawnMotion(seed), o.seconds, seed);
  if (out.size > 0)
    if (const Status s = HideEffect(fmt::format("{}={}", out.hidden, out.size), options.truth); !s) return {};
  options.model = before.model;
  options.motion = DrawnMotion(seed + 1);
  options.seconds = kLogSeconds;
  options.sample_period = kPeriodOfRows;
  options.seed = seed + 1;
  const Machine machine = ManipulatorMachine(options.truth, &before.model);
  const Episode episode = EpisodeOf(SimulateManipulator(options));
  const double begin = ThreadSeconds();
  const LinearStart start = StartOf(machine, std::span(&episode, 1));
  ExplainStatesOptions explain;
  explain.fit = start.options;
  out.explanation = ExplainStates(start.machine, std::span(&episode, 1), explain);
  out.seconds = ThreadSeconds() - begin;
  return out;
}

}  // namespace

bool PrintManipulatorEffects(const ManipulatorBenchmarkOptions& options) {
  EffectTally tally;
  std::mutex mutex;
  ProgressBar progress("effects", "logs");
  ForEachCase(
      options.effects, progress,
      [&](int at) {
        const int number = options.first_effect + at;
        const EffectOutcome outcome = ExplainOne(number, options);
        const std::lock_guard lock(mutex);
        fmt::print("{:>4} {}, {:.1f} s\n", number,
                   tally.Add(outcome.hidden, outcome.size, outcome.explanation), outcome.seconds);
        std::fflush(stdout);
      },
      options.threads);
  fmt::print("{}", tally.Table());
  return tally.Reached();
}

}  // namespace hydroscope
