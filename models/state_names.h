#pragma once

#include "models/expressions/check.h"

namespace hydroscope {

/// What of an output repeats with the shaft, as equations name it.
std::string RippleName(const std::string& output);
/// What equations of states and outputs may name: states, parameters, [geometry], pi, the signals that are no
/// outputs (inputs), and with a shaft the ripples of outputs. `of_effect`: parameters of an effect, beside them.
ExpressionNames StateNamesOf(const Machine& machine, const std::vector<ParameterSpec>& of_effect = {});
/// What limits may name: parameters and [geometry].
ExpressionNames LimitNamesOf(const Machine& machine);
/// What initial values may name: all signals, parameters and [geometry].
ExpressionNames InitialNamesOf(const Machine& machine);

/// SI unit of a parameter of the machine's states, or of its effects' ("leak.l"); "" if it has none, or none is known.
std::string StateParameterUnit(const Machine& machine, const std::string& parameter);

/// Index of a state; -1 if there is none of that name.
int StateIndex(const Machine& machine, const std::string& name);
/// Index of the output that is this signal, -1 if none is.
int OutputIndex(const Machine& machine, const std::string& signal);

}  // namespace hydroscope
