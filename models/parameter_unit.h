#pragma once

#include <string>
#include <string_view>

#include "core/units.h"
#include "models/machine_kind.h"

namespace hydroscope {

/// The unit in which people read a parameter of such a machine: the one its kind tells ("% of stroke" of y_0), else the usual
/// one of the SI unit, of the size of an effect ("internal_leakage.G") that of effects; "-" for a plain number.
DisplayUnit ParameterUnit(const MachineKind& kind, std::string_view parameter, std::string_view si);

/// Whether changes of a parameter are told in per cent: not where its zero is one of many (a null, a temperature).
bool ToldInPercent(const MachineKind& kind, std::string_view parameter, std::string_view si);

/// A parameter, or the size of an effect, with its 95 % interval as people read it.
struct ShownParameter {
  std::string numbers;  ///< "0.803 ± 0.024"
  std::string unit;     ///< "% of stroke", "" of a plain number
};
ShownParameter ShowParameter(const MachineKind& kind, std::string_view parameter, double value, double std,
                             const std::string& si);

/// The same in one piece: "0.803 ± 0.024 % of stroke".
std::string ParameterWithInterval(const MachineKind& kind, std::string_view parameter, double value,
                                  double std, const std::string& si);

}  // namespace hydroscope
