#pragma once

#include <string>
#include <utility>
#include <vector>

namespace hydroscope {

struct Machine;

/// Equations of a machine that are linear in its parameters and read measured signals alone:
///   sum of parameter * (d/dt rate + level) = d/dt known_rate + known_level,
/// texts over signals, [geometry] and `rates`. They need no simulation, so they give a fit by states its start, and
/// tell which parameters, or sums of them, a record can show. Integrated over windows no signal is differentiated but
/// those of `rates`.
struct LinearForm {
  struct Term {
    std::string parameter;    ///< "1/K": its reciprocal is the machine's K
    std::string rate, level;  ///< "" = 0
  };
  struct Equation {
    std::string name;  ///< "torque of joint 1"
    std::vector<Term> terms;
    std::string known_rate, known_level;
  };
  /// Signal and the name of its rate in the texts.
  std::vector<std::pair<std::string, std::string>> rates;
  std::vector<Equation> equations;
  /// Parameters in the order in which they are kept: of those that act alike the later ones are left out.
  std::vector<std::string> parameters;
};

/// The linear form of the machine's kind (MachineKind::linear_form); without equations if it has none.
LinearForm LinearFormOf(const Machine& machine);

}  // namespace hydroscope
