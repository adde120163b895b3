#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "estimation/closed_loop/closed_loop.h"
#include "models/closed_loop.h"

namespace hydroscope {

/// A plant in closed loop as one record gives it.
struct LoopState : LoopEstimate, InputRange {};

/// As a response with a fit has it, its errors as wide as its intervals (TransferFit::Widening).
LoopState StateOf(const LoopResponse& response);

/// A change and its size.
struct SizedChange {
  const LoopChange* change = nullptr;
  double size = 0;  ///< logarithm of the factor of its quantity; a delay: s
  double std = 0;
};

/// Changes that together lead from one state to the other.
struct LoopChangeSet {
  std::vector<SizedChange> changes;
  double chi_squared = 0;  ///< of what they leave, errors of both records and repeatability taken
  int degrees_of_freedom = 0;
  double p_value = 1;
};

struct LoopComparison {
  enum class Verdict {
    kAdequate,   ///< nothing changed
    kNamed,      ///< `set` did
    kAmbiguous,  ///< another set of the same size does as well: `others`
    kUnknown,  ///< no set of up to three changes leads there, `poles_unknown`, `reversed`, `dead_band` or `readings_end`
  };
  const ClosedLoopPlant* plant = nullptr;
  Verdict verdict = Verdict::kAdequate;
  LoopChangeSet set;                     ///< best of those that suffice; unknown: the nearest
  std::vector<LoopChangeSet> others;     ///< as good, as large
  std::vector<LoopChangeSet> imitators;  ///< of other changes, as good, with one change more
  LoopChangeSet nothing;                 ///< no change at all
  std::vector<LoopChangeSet> singles;    ///< every change alone, best first
  std::vector<SizedChange> unseen;       ///< of kAdequate: large ones that these records would not have shown
  bool limit_appeared = false, limit_went = false;
  bool poles_unknown = false;  ///< in one of the records; their changes are not seen, and never kAdequate
  bool reversed = false;       ///< the gain changed its sign, a signal did: nothing is compared, kUnknown
  /// One of the records alone shows one: figures that go with the excitation are no changes that could be named.
  bool dead_band = false;
  /// The input's readings end in one of the records alone, and something changed: it may be the readings.
  bool readings_end = false;
  LoopState before, after;
};
/// "adequate", "named", "ambiguous", "unknown".
const char* VerdictName(LoopComparison::Verdict verdict);

/// Of chance; what they name and leave is what `hydroscope benchmark test-cylinder --changes` counts.
struct LoopComparisonOptions {
  /// Chance from which what is left counts as error of the records: over all parameters, and over the directions of all changes.
  double least_p = 0.01;
  double as_good = 6;    ///< difference of chi^2 below which two sets are as good: a likelihood ratio of 20
  std::size_t most = 3;  ///< changes at once
  /// Relative change of a quantity from which on it is told if records would not have shown it. A delay: LoopParameter::scale.
  double large = 0.2;
};

/// Which of the plant's changes lead from `before` to `after`: the smallest set of them after which the rest is within the
/// errors of both records and the repeatability of the plant (generalised least squares over the logarithms). No member of a set
/// may be without effect, or of the sign that its quantity cannot have. Poles of `after` that can be shared out in several ways
/// are taken in the way that needs the fewest changes: a pole that became real need not be the valve's. A gain of the other sign
/// is a signal that was reversed, and nothing is compared.
LoopComparison CompareLoopStates(const ClosedLoopPlant& plant, const LoopState& before,
                                 const LoopState& after, const LoopComparisonOptions& options = {});

}  // namespace hydroscope
