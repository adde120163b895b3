#include "pipeline/log_faults/swapped_pressures.h"

#include <algorithm>
#include <cmath>

#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// Rows that a rule is judged by, at least.
constexpr std::int64_t kRowsToJudge = 1000;
/// Of its mean, by which a pressure does not rise, and by which the other one does.
constexpr double kStill = 0.02, kRises = 0.2;
constexpr double kBar = 1e5;

using Law = PressureRule::Law;

}  // namespace

SwappedPressures::SwappedPressures(const Machine& machine) : machine_(machine) {
  for (const PressureRule& rule : KindOf(machine).pressures) {
    const int lower = machine.SignalIndex(rule.lower), higher = machine.SignalIndex(rule.higher);
    const int driven_by = rule.law == Law::kBelow ? lower : machine.SignalIndex(rule.driven_by);
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
      Count(block.signal[pair.lower][row], block.signal[pair.higher][row], block.signal[pair.driven_by][row],
            pair);
    }
}

void SwappedPressures::Count(double lower, double higher, double drive, Pair& pair) {
  pair.moves = pair.moves || (pair.read > 0 && higher != pair.last);
  pair.last = higher;
  ++pair.read;
  pair.alike += lower == higher;
  if (pair.rule->law == Law::kPressedOut) {
    if (std::abs(drive) < pair.rule->open) return;
    const std::size_t enters = drive < 0;
    pair.of_lower[enters].Add(lower);
    pair.of_higher[enters].Add(higher);
    return;
  }
  const bool filled = pair.rule->law == Law::kFilled;
  if (filled && drive > -pair.rule->open) return;
  ++pair.rows;
  pair.above += filled ? lower >= higher : lower > higher;
}

Told SwappedPressures::Sentence(const Pair& pair) const {
  const auto named = [&](std::size_t signal) {
    const SignalSpec& spec = machine_.signals[signal];
    return Tell("{} (column {})", "{} (Spalte {})", spec.name, spec.column);
  };
  const Told lower = named(pair.lower), higher = named(pair.higher);
  if (Told same = TheSame(pair, lower, higher); !same.empty()) return same;
  return pair.rule->law == Law::kPressedOut ? PressedOut(pair, lower, higher) : Above(pair, lower, higher);
}

Told SwappedPressures::TheSame(const Pair& pair, const Told& lower, const Told& higher) const {
  const double share =
      static_cast<double>(pair.alike) / static_cast<double>(std::max<std::int64_t>(1, pair.read));
  if (pair.read < kRowsToJudge || !pair.moves || share < PressureRule::kNearlyAlways) return {};
  return Tell(
      "{0} and {1} have the same reading in {2:.0f} % of the rows: one of the two has the column of the other in the machine file, "
      "or one sensor was recorded twice",
      "{0} und {1} haben in {2:.0f} % der Zeilen denselben Wert: einer der beiden Drücke hat in der Maschinendatei die Spalte des "
      "anderen, oder ein Sensor wurde zweimal aufgezeichnet",
      lower, higher, 100 * share);
}

Told SwappedPressures::Above(const Pair& pair, const Told& lower, const Told& higher) const {
  const double share =
      static_cast<double>(pair.above) / static_cast<double>(std::max<std::int64_t>(1, pair.rows));
  if (pair.rows < kRowsToJudge || share < PressureRule::kNearlyAlways) return {};
  if (pair.rule->law == Law::kFilled)
    return Tell(
        "{0} is no lower than {1} in {2:.0f} % of the rows in which {3} lets oil from {4} into that chamber: {4} in the machine "
        "file has the column of another pressure, or its reading is wrong",
        "{0} liegt in {2:.0f} % der Zeilen, in denen {3} Öl von {4} in diese Kammer lässt, nicht unter {1}: {4} hat in der "
        "Maschinendatei die Spalte eines anderen Drucks, oder die Anzeige stimmt nicht",
        lower, higher, 100 * share, pair.rule->driven_by, pair.rule->higher);
  return Tell(
      "{0} stands above {1} in {2:.0f} % of the rows, which it does for moments at most: the two columns are swapped in the "
      "machine file, or the reading of {3} is wrong",
      "{0} liegt in {2:.0f} % der Zeilen über {1}, was höchstens für Augenblicke sein kann: die beiden Spalten sind in der "
      "Maschinendatei vertauscht, oder die Anzeige von {3} stimmt nicht",
      lower, higher, 100 * share, pair.rule->higher);
}

Told SwappedPressures::PressedOut(const Pair& pair, const Told& lower, const Told& higher) const {
  for (const Mean& mean : pair.of_higher)
    if (mean.rows < kRowsToJudge) return {};
  const double leaves = pair.of_higher[0].value(), enters = pair.of_higher[1].value();
  const double other_leaves = pair.of_lower[0].value(), other_enters = pair.of_lower[1].value();
  const bool still = leaves < (1 + kStill) * enters;
  if (!still || other_leaves < (1 + kRises) * other_enters) return {};
  return Tell(
      "{0} is at {2:.3g} bar while oil is pressed out of its chamber and at {3:.3g} bar while oil flows in, {1} at {4:.3g} and "
      "{5:.3g} bar: the two columns are swapped in the machine file",
      "{0} liegt bei {2:.3g} bar, während Öl aus der Kammer gedrückt wird, und bei {3:.3g} bar, während Öl zuströmt, {1} bei "
      "{4:.3g} und {5:.3g} bar: die beiden Spalten sind in der Maschinendatei vertauscht",
      higher, lower, leaves / kBar, enters / kBar, other_leaves / kBar, other_enters / kBar);
}

std::vector<Told> SwappedPressures::Sentences() const {
  std::vector<Told> sentences;
  for (const Pair& pair : pairs_)
    if (Told sentence = Sentence(pair); !sentence.empty()) sentences.push_back(std::move(sentence));
  return sentences;
}

}  // namespace hydroscope
