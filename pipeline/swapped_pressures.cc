#include "pipeline/swapped_pressures.h"

#include <algorithm>
#include <cmath>

#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// Rows that a rule is judged by, at least.
constexpr std::int64_t kRowsToJudge = 1000;
/// Of the rows: more are no moments.
constexpr double kNearlyAlways = 0.95;
/// Of its mean, by which a pressure does not rise, and by which the other one does.
constexpr double kStill = 0.02, kRises = 0.2;
constexpr double kBar = 1e5;

}  // namespace

SwappedPressures::SwappedPressures(const Machine& machine) : machine_(machine) {
  for (const PressureRule& rule : KindOf(machine).pressures) {
    const int lower = machine.SignalIndex(rule.lower), higher = machine.SignalIndex(rule.higher);
    const int driven_by = rule.driven_by.empty() ? lower : machine.SignalIndex(rule.driven_by);
    if (lower < 0 || higher < 0 || driven_by < 0) continue;
    Pair pair;
    pair.rule = &rule;
    pair.lower = static_cast<std::size_t>(lower);
    pair.higher = static_cast<std::size_t>(higher);
    pair.driven_by = static_cast<std::size_t>(driven_by);
    pairs_.push_back(pair);
  }
}

void SwappedPressures::Observe(const SampleBlock& block) {
  for (Pair& pair : pairs_)
    for (std::size_t row = 0; row < block.rows(); ++row) {
      const auto flags = block.quality[pair.lower][row] | block.quality[pair.higher][row] |
                         block.quality[pair.driven_by][row];
      if (flags != quality::kGood) continue;
      const double lower = block.signal[pair.lower][row], higher = block.signal[pair.higher][row];
      if (pair.rule->driven_by.empty())
        Count(lower, higher, pair);
      else
        Count(lower, higher, block.signal[pair.driven_by][row], pair);
    }
}

void SwappedPressures::Count(double lower, double higher, Pair& pair) {
  ++pair.rows;
  pair.above += lower > higher;
}

void SwappedPressures::Count(double lower, double higher, double drive, Pair& pair) {
  if (std::abs(drive) < pair.rule->open) return;
  const std::size_t enters = drive < 0;
  pair.of_lower[enters].sum += lower;
  pair.of_higher[enters].sum += higher;
  ++pair.of_lower[enters].rows;
  ++pair.of_higher[enters].rows;
}

Told SwappedPressures::Sentence(const Pair& pair) const {
  const auto named = [&](std::size_t signal) {
    const SignalSpec& spec = machine_.signals[signal];
    return Tell("{} (column {})", "{} (Spalte {})", spec.name, spec.column);
  };
  if (pair.rule->driven_by.empty()) {
    const double share =
        static_cast<double>(pair.above) / static_cast<double>(std::max<std::int64_t>(1, pair.rows));
    if (pair.rows < kRowsToJudge || share < kNearlyAlways) return {};
    return Tell(
        "{0} stands above {1} in {2:.0f} % of the rows, which it does for moments at most: are the two columns swapped in the "
        "machine file, or is the reading of {3} wrong?",
        "{0} liegt in {2:.0f} % der Zeilen über {1}, was höchstens für Augenblicke sein kann: sind die beiden Spalten in der "
        "Maschinendatei vertauscht, oder stimmt die Anzeige von {3} nicht?",
        named(pair.lower), named(pair.higher), 100 * share, pair.rule->higher);
  }
  for (const Mean& mean : pair.of_higher)
    if (mean.rows < kRowsToJudge) return {};
  const double leaves = pair.of_higher[0].value(), enters = pair.of_higher[1].value();
  const double other_leaves = pair.of_lower[0].value(), other_enters = pair.of_lower[1].value();
  const bool still = leaves < (1 + kStill) * enters;
  if (!still || other_leaves < (1 + kRises) * other_enters) return {};
  return Tell(
      "{0} is at {2:.3g} bar while oil is pressed out of its chamber and at {3:.3g} bar while oil flows in, {1} at {4:.3g} and "
      "{5:.3g} bar: are the two columns swapped in the machine file?",
      "{0} liegt bei {2:.3g} bar, während Öl aus der Kammer gedrückt wird, und bei {3:.3g} bar, während Öl zuströmt, {1} bei "
      "{4:.3g} und {5:.3g} bar: sind die beiden Spalten in der Maschinendatei vertauscht?",
      named(pair.higher), named(pair.lower), leaves / kBar, enters / kBar, other_leaves / kBar,
      other_enters / kBar);
}

std::vector<Told> SwappedPressures::Sentences() const {
  std::vector<Told> sentences;
  for (const Pair& pair : pairs_)
    if (Told sentence = Sentence(pair); !sentence.empty()) sentences.push_back(std::move(sentence));
  return sentences;
}

}  // namespace hydroscope
