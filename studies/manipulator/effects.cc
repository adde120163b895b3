#include "studies/manipulator/effects.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "diagnosis/states/explain_states.h"
#include "estimation/linear_form/starts.h"
#include "studies/manipulator/identification.h"
#include "studies/parallel.h"

namespace hydroscope {
namespace {

constexpr double kLogSeconds = 30, kPeriodOfRows = 0.01;  // s, of the logs that are explained

struct EffectOutcome {
  bool hidden = false, first = false, wrong = false, adequate = false;
  std::string line;
};

EffectOutcome ExplainOne(int number, const ManipulatorBenchmarkOptions& o) {
  const std::uint64_t seed = o.seed * 7919 + static_cast<std::uint64_t>(number);
  const auto& effects = ManipulatorEffects();
  // One healthy log after all the effects, again and again.
  const std::size_t turn = static_cast<std::size_t>(number) % (effects.size() + 1);
  const std::string hidden = turn < effects.size() ? effects[turn].id : "";
  ManipulatorOptions options;
  options.truth = DrawnManipulator(seed);
  const IdentifiedManipulator before = Identify(options.truth, DrawnMotion(seed), o.seconds, seed);
  if (!hidden.empty())
    if (const Status s = HideEffect(hidden, options.truth); !s) return {};
  options.model = before.model;
  options.motion = DrawnMotion(seed + 1);
  options.seconds = kLogSeconds;
  options.sample_period = kPeriodOfRows;
  options.seed = seed + 1;
  const Machine machine = ManipulatorMachine(options.truth, &before.model);
  const Episode episode = EpisodeOf(SimulateManipulator(options));
  const LinearStart start = StartOf(machine, std::span(&episode, 1));
  ExplainStatesOptions explain;
  explain.fit = start.options;
  const StatesExplanation x = ExplainStates(start.machine, std::span(&episode, 1), explain);
  EffectOutcome out;
  out.hidden = !hidden.empty();
  out.first = out.hidden && !x.set.empty() && x.set.front() == hidden;
  out.wrong = !x.set.empty() && std::find(x.set.begin(), x.set.end(), hidden) == x.set.end();
  out.adequate = x.verdict == Verdict::kAdequate;
  out.line = fmt::format("{:>4} hidden {:<20} {:<9} [{}]{}\n", number, hidden.empty() ? "-" : hidden,
                         VerdictName(x.verdict), fmt::join(x.set, ", "), out.wrong ? " WRONG" : "");
  return out;
}

}  // namespace

bool PrintManipulatorEffects(const ManipulatorBenchmarkOptions& options) {
  std::vector<EffectOutcome> outcomes(static_cast<std::size_t>(options.effects));
  std::mutex mutex;
  ProgressBar progress("effects", "logs");
  ForEachCase(
      options.effects, progress,
      [&](int number) {
        EffectOutcome& outcome = outcomes[static_cast<std::size_t>(number)];
        outcome = ExplainOne(number, options);
        const std::lock_guard lock(mutex);
        fmt::print("{}", outcome.line);
        std::fflush(stdout);
      },
      options.threads);
  const auto count = [&](auto what) {
    return static_cast<int>(std::count_if(outcomes.begin(), outcomes.end(), what));
  };
  const int hidden = count([](const auto&o) { return o.hidden; }),
            first = count([](const auto&o) { return o.first; }),
            wrong = count([](const auto&o) { return o.wrong; }),
            adequate = count([](const auto&o) { return !o.hidden && o.adequate; });
  fmt::print("\neffect named first {} of {}, healthy adequate {} of {}, wrong {} of {}\n", first, hidden,
             adequate, options.effects - hidden, wrong, options.effects);
  return first >= 0.95 * hidden && wrong <= 0.01 * options.effects;
}

}  // namespace hydroscope
