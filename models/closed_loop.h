#pragma once

#include <complex>
#include <span>
#include <string_view>
#include <vector>

#include "core/told.h"

namespace hydroscope {

struct Machine;

/// A parameter of a transfer function and how the search for it begins.
struct LoopParameter {
  enum class Kind {
    kPositive,  ///< sought on a scale of logarithms
    kGain,      ///< a factor of the whole response, found by projection at each start; of any sign
    kDelay,     ///< s, beside the equations: the search begins at 0
  };
  std::string_view name;  ///< as in MachineKind::parameters, in the same order
  Kind kind = Kind::kPositive;
  std::span<const double> starts = {};  ///< SI; every combination of those of all parameters is looked at
  /// Relative half width that a record should reach; 0: none is asked for.
  double wanted = 0;
  std::string_view unit = "";  ///< of people, ...
  double factor = 1;           ///< ... shown = SI * factor
  /// SI, of a parameter that is 0 where all is well: errors that are small beside this one say something useful.
  double scale = 0;
};

/// Something that may have happened to the plant between two records. All that can are straight lines over the logarithms of
/// the parameters (a delay: over itself), since bulk modulus, stiffness, mass and flow gain enter them as powers.
struct LoopChange {
  std::string_view id;
  Wording quantity;  ///< what changed: "flow gain of the valve"
  Wording sentence;  ///< what that means and what to look at
  /// Of each parameter: change of its logarithm (a delay: s) for a change of the quantity by a factor of e (a delay: 1 s).
  std::span<const double> direction;
  int sign = 0;  ///< +1, -1: the quantity can only grow, only shrink
  /// Of a change that is no straight line: share of each parameter in it on the way from `from` to the quantity of `size`,
  /// the chord; in place of `direction`, which is that of the healthy plant.
  void (*chord)(std::span<const double> from, double size, std::span<double> direction) = nullptr;
};

/// A plant that a controller drives: it is measured in closed loop, by the set point that it is excited with from outside.
/// What is measured and fitted: estimation/closed_loop/.
struct ClosedLoopPlant {
  std::string_view set_point, input, output;  ///< signals; the input is what the controller gives out
  std::string_view input_unit;                ///< SI
  /// Output over input at the complex frequency s, 1/s, without delay. `parameters` SI, `geometry` as MachineKind::geometry
  /// lists it.
  std::complex<double> (*response)(std::complex<double> s, std::span<const double> parameters,
                                   std::span<const double> geometry) = nullptr;
  /// Of the sets of parameters that give the same response (real poles may be shared out in more ways than one), brings
  /// `parameters` to the one of number `way`, 0 the one that is meant where nothing else is known; false if there are no so
  /// many. nullptr: there is one only.
  bool (*share_out)(std::span<double> parameters, int way) = nullptr;
  int ways = 0;  ///< at most
  /// Index of the damping of a pair of poles, real from 1 on: near 1 they may be a double one, and can be shared out from there.
  /// -1: there is none.
  int damping = -1;
  std::span<const LoopParameter> parameters;
  /// Relative standard deviation with which a parameter comes back when the same plant is set up and measured again.
  double repeatability = 0;
  std::span<const LoopChange> changes;
  /// That the input does not reach the plant beyond some size; without direction, seen in the record itself.
  LoopChange limit;
};

/// The plant of a machine whose kind is measured in closed loop (MachineKind::closed_loop); nullptr: its kind is not.
const ClosedLoopPlant* ClosedLoopOf(const Machine& machine);
/// Indices of its set point, input and output among the machine's signals, -1 where it has none.
std::vector<int> SignalsOfLoop(const Machine& machine);

}  // namespace hydroscope
