#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <random>
#include <string>

#include "core/contains.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/explain.h"
#include "host/output.h"
#include "simulator/die_cushion/press.h"
#include "studies/benchmarks.h"
#include "studies/random_effect.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

constexpr std::array kSignals = {"position_signal", "pressure_signal", "spool_signal"};
constexpr double kShortest = 0.001, kLongest = 0.013;  ///< s
constexpr double kSeconds = 90, kSteppedSeconds = 200;
constexpr double kLow = 25e5, kHigh = 0.9;  ///< of pressure steps: Pa, share of the highest set point

/// A log and what its signal is.
struct LateCase {
  int signal = 0;
  std::string truth, twin;
  PressOptions options;
};

LateCase DrawLateCase(int index, std::uint64_t seed) {
  std::mt19937_64 random(seed * 1000003 + index);
  LateCase c;
  PressOptions& o = c.options;
  o = RandomMachine(random() >> 32);
  c.signal = index % 3;
  const std::string signal = kSignals[c.signal];
  const bool filtered = index / 3 % 2 == 1, stepped = index / 6 % 2 == 1;
  c.truth = signal + (filtered ? "_lag" : "_delay");
  c.twin = signal + (filtered ? "_delay" : "_lag");
  const double size = kShortest * std::pow(kLongest / kShortest, Uniform(random));
  if (filtered)
    o.imperfections = {{c.truth, size, {}, ""}};
  else
    o.effects = {{c.truth, size, {}}};
  o.seconds = stepped ? kSteppedSeconds : kSeconds;
  if (stepped) {
    const double high = kHigh * o.motion.set_point_max;
    o.motion.speeds = {o.motion.speed_max * (0.4 + 0.6 * Uniform(random))};
    o.motion.set_points = {kLow, high, kLow, high, kLow, high, kLow, high};
  }
  return c;
}

struct LateTally {
  int logs = 0, alone = 0, both = 0, wrong = 0, open = 0;
  double truth_leaves = 0,
         twin_leaves = 0;  ///< most of the noise energy that the one leaves more than the other
  double twin_gains = 1;   ///< least of what the truth gains that the twin does
  double truth_gains = 1;  ///< ... and of what the twin gains that the truth does
  double given_up = 0;     ///< Effect::Twin::excess
};

void CountLate(const LateCase& c, const Explanation& x, LateTally& t) {
  const auto has = [&](const std::string& id) { return Contains(x.set, id); };
  const bool truth = has(c.truth), twin = has(c.twin);
  ++t.logs;
  if (const Effect::Twin* const pair = FindTwin(*x.model, c.truth, c.twin)) t.given_up = pair->excess;
  t.alone += truth && !twin;
  t.both += truth && twin;
  t.wrong += twin && !truth;
  t.open += !truth && !twin;
  double left[2] = {NAN, NAN}, gains[2] = {0, 0};
  for (const RankedEffect& r : x.ranking)
    if (r.fit.solved && r.significant && (r.id == c.truth || r.id == c.twin)) {
      left[r.id == c.twin] = r.fit.excess_ratio;
      gains[r.id == c.twin] = r.gain;
    }
  if (!std::isfinite(left[0]) || !std::isfinite(left[1])) return;
  t.truth_leaves = std::max(t.truth_leaves, left[0] - left[1]);
  t.twin_leaves = std::max(t.twin_leaves, left[1] - left[0]);
  t.twin_gains = std::min(t.twin_gains, gains[1] / gains[0]);
  t.truth_gains = std::min(t.truth_gains, gains[0] / gains[1]);
}

/// A line for a log whose set has the other one of the two alone.
std::string MissedLate(int number, const LateCase& c, const Explanation& x) {
  if (!Contains(x.set, c.twin) || Contains(x.set, c.truth)) return "";
  std::string line = fmt::format("wrong: log {}, {} hidden:", number, c.truth);
  for (const RankedEffect& r : x.ranking)
    if (r.fit.solved && (r.id == c.truth || r.id == c.twin))
      line += fmt::format(" {} gains {:.0f} and leaves {:.3f} of the noise energy;", r.id, r.gain,
                          r.fit.excess_ratio);
  line.back() = '\n';
  return line;
}

}  // namespace

int RunLateSignalsBenchmark(const LateSignalsOptions& options) {
  const auto& [cases, seed] = options;
  std::array<LateTally, kSignals.size()> tallies;
  std::string missed;
  ProgressBar progress("late signals", "logs");
  for (int i = 0; i < cases; ++i) {
    const LateCase c = DrawLateCase(i, seed);
    const auto strokes = StrokesOf(SimulatePress(c.options), MachineFor(c.options), KeepSamples::kYes);
    if (!strokes) return ReportError(strokes.error());
    const Explanation x = ExplainSamples(strokes->model, strokes->stretches, strokes->window);
    CountLate(c, x, tallies[c.signal]);
    missed += MissedLate(i, c, x);
    progress.Update((i + 1.0) / cases, i + 1);
  }
  std::cout << fmt::format("{} logs with one signal late or filtered, seed {}\n\n", cases, seed)
            << fmt::format("{:<18}{:>6}{:>8}{:>8}{:>8}{:>8}{:>14}{:>14}{:>14}{:>14}{:>14}\n", "", "logs",
                           "alone", "both", "wrong", "open", "truth leaves", "twin leaves", "given up from",
                           "twin gains", "truth gains");
  int wrong = 0;
  for (std::size_t s = 0; s < tallies.size(); ++s) {
    const LateTally& t = tallies[s];
    fmt::print("{:<18}{:>6}{:>8}{:>8}{:>8}{:>8}{:>14.3f}{:>14.3f}{:>14.3f}{:>14.3f}{:>14.3f}\n", kSignals[s],
               t.logs, t.alone, t.both, t.wrong, t.open, t.truth_leaves, t.twin_leaves, t.given_up,
               t.twin_gains, t.truth_gains);
    wrong += t.wrong;
  }
  std::cout
      << missed
      << "\nleaves: most of the noise energy that it leaves more than the other; a twin that leaves so much more is given up\n"
      << "gains: least of what the one gains that the other does\n";
  return wrong == 0 ? 0 : 1;
}

}  // namespace hydroscope
