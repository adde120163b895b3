#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/result.h"
#include "models/expressions/program.h"
#include "models/machine.h"

namespace hydroscope {

/// A parameter of a model with states: of the model itself, or of an effect.
struct StateParameter {
  std::string name;    ///< "k1", or "overflow.k3" of an effect
  std::string effect;  ///< id, "" = of the model itself
  ParameterSpec spec;
};

/// Equations as programs: their values alone, and with the derivatives that are not zero everywhere.
struct Equations {
  /// d row / d column; columns count the states first, then the parameters.
  struct Slope {
    int row = 0, column = 0;
  };
  ExpressionProgram values, slopes;  ///< outputs of `slopes`: the rows, then one per entry of `entries`
  std::vector<Slope> entries;
  int rows = 0;
};

/// An input of some seconds ago. Beside its value the programs read its rate r and, once more, the delay as it stands:
/// u + (now - delay)*r has the value u and, by the delay, the derivative -r.
struct DelayedInput {
  static constexpr int kRegisters = 3;  ///< value, rate, now
  int input = 0;                        ///< index into StateModel::inputs
  int parameter = -1;                   ///< that is the delay; -1: it is known
  double seconds = 0;                   ///< ... and this

  bool operator==(const DelayedInput&) const = default;
};

/// The model of a machine that is described by states, with some of its effects:
///   dx/dt = f(x, u, p), y = g(x, u, p), min(p) <= x <= max(p).
/// Inputs of the programs: states, inputs u, delayed inputs, ripples of outputs, parameters (which are fixed during a run).
struct StateModel {
  Machine machine;
  std::vector<std::string> effects;  ///< ids, those that are part of the model
  std::vector<StateParameter> parameters;
  std::vector<int> inputs;  ///< machine signal of each u
  std::vector<DelayedInput> delays;
  std::vector<int> ripples;  ///< machine signals whose ripple with the shaft drives the states (RippleName)
  std::vector<int> outputs;  ///< machine signal of each y
  Equations dynamics, output;
  Equations limits;   ///< min of each state, then max of each; of parameters alone
  Equations initial;  ///< of the machine's signals and the parameters; of estimated ones what they lie near
  std::vector<bool> estimated;  ///< per state: its initial value is estimated
  std::vector<bool> near;       ///< ... and `initial` says near what
  /// Per state: the output that is this very state, -1 if there is none.
  std::vector<int> measured_by;
  /// Per state: the state that is its rate, -1 if none is: where the former stops, the latter is 0.
  std::vector<int> rate_of;

  int states() const { return dynamics.rows; }
  /// Inputs of the programs between states and parameters.
  int driving() const {
    return static_cast<int>(
        inputs.size() + delays.size() * static_cast<std::size_t>(DelayedInput::kRegisters) + ripples.size());
  }
  int parameter_count() const { return static_cast<int>(parameters.size()); }
};

/// The model with the effects of these ids (StateEffectsOf). Its texts were checked when the file was read, those of built-in
/// machines by their conformance test. Errors: an unknown id (suggests the nearest), more than kMaxParameters
/// parameters, a parameter that no equation reads.
Result<std::shared_ptr<const StateModel>> BuildStateModel(const Machine& machine,
                                                          const std::vector<std::string>& effects);

}  // namespace hydroscope
