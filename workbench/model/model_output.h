#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "models/machine.h"

namespace hydroscope {

/// The library of effects for people: law, parameter, typical size, what it is confused with and hides in. With a machine
/// those that `explain` tries on it: the library of its balance and the effects of its own.
std::string EffectsText(const Machine* machine = nullptr);
/// The same as the JSON of docs/command_line.md, SI.
nlohmann::json EffectsJson(const Machine* machine = nullptr);

/// The model of a machine file: version, what is known, effects that are part of it.
std::string ModelText(const Machine& machine);
nlohmann::json ModelJson(const Machine& machine);

}  // namespace hydroscope
