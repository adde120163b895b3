#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

/// What they let pass of laws that no effect of the file is `hydroscope benchmark state-machines` counts.
struct SpecificityOptions {
  /// An effect that changes the outputs by more than this many times what is left (rms) is told from functions by its shape
  /// as it is; the tangent of the model without it would not be.
  double weak = 1.5;
  /// Squared correlation of what two terms do to the outputs beyond which they are one law in this log.
  double same_law = 0.98;
};

/// A function of states and inputs that is no effect of the machine file.
struct LikeFunction {
  std::string equation;  ///< of this state or output
  std::string about;     ///< what it is a function of
};

/// What a weak effect adds may be the nearest there is to a law that is not in the machine file. Energies of the error on
/// pieces left out, of the effect and of each single function of states and inputs in its place, both as terms of the model
/// without it (`rest`; `with` holds the effect).
class Specificity {
 public:
  Specificity(const StateFit& rest, const StateFit& with, std::span<const Episode> episodes,
              const SpecificityOptions& options);

  /// Whether the effect is weak enough to be asked for.
  bool weak() const { return weak_; }
  /// Per piece, with the effect; empty if it is not weak.
  const std::vector<double>& with_effect() const { return with_effect_; }
  struct Function {
    LikeFunction named;
    std::vector<double> energies;  ///< per piece
  };
  /// The one that leaves least of those that are not the same law as the effect; nullptr: there is none.
  const Function* Best() const;

 private:
  bool weak_ = false;
  std::vector<double> with_effect_;
  std::vector<Function> functions_;
};

}  // namespace hydroscope
