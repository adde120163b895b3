#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace hydroscope {

/// A state of a machine: d state / dt = ddt, within its limits.
struct StateSpec {
  std::string name;
  std::string ddt;  ///< expression over states, inputs, parameters and [geometry], SI
  /// "estimate", or an expression over signals (at the first row), parameters and [geometry], SI.
  std::string initial = "estimate";
  /// Where it stops: expressions over parameters and [geometry], SI; "" = nowhere.
  std::string min = {}, max = {};
  std::string unit = {};  ///< SI, "" = not known
  /// Where the search for an initial value that is estimated begins, an expression as `initial`; "" = at what is measured of it,
  /// else between its limits.
  std::string near = {};

  bool operator==(const StateSpec&) const = default;
};

/// A signal that the model gives: expression over states, inputs, parameters and [geometry].
struct OutputSpec {
  std::string signal, expression;

  bool operator==(const OutputSpec&) const = default;
};

/// A parameter that is identified, with the range in which it is looked for.
struct ParameterSpec {
  std::string name;
  double start = 0;  ///< SI
  double min = -std::numeric_limits<double>::infinity(),
         max = std::numeric_limits<double>::infinity();  ///< SI
  std::string unit = {};                                 ///< SI, "" = not known

  bool operator==(const ParameterSpec&) const = default;
};

/// A machine that is described by states: dx/dt = f(x, u, p), y = g(x, u, p). Of its file, or of its kind.
struct StatesSpec {
  std::vector<StateSpec> states;
  std::vector<OutputSpec> outputs;
  std::vector<ParameterSpec> parameters;
  std::optional<double> episode_seconds;  ///< a continuous log is cut into episodes of this length
  /// Signal of the speed (rad/s) of the shaft whose ripple is taken out of the outputs: their readings are means over whole
  /// revolutions. "" = readings are taken as they are.
  std::string shaft = {};

  bool operator==(const StatesSpec&) const = default;
};

}  // namespace hydroscope
