#pragma once

#include <string>
#include <string_view>

#include "diagnosis/drift/watched_model.h"
#include "models/machine_kind.h"

namespace hydroscope {

/// How a parameter is shown to people: shown = SI * factor + offset.
struct ParameterInfo {
  std::string id;        ///< "Q_vn"
  std::string symbol;    ///< with subscript marks: "Q_{vn}"
  std::string name;      ///< "nominal valve flow"
  std::string sentence;  ///< for the glossary; "" if nothing is known
  std::string unit;      ///< "l/min"
  double factor = 1, offset = 0;
  /// Changes are told in % of the value; otherwise in the unit (y_0 is near zero by nature).
  bool relative = true;

  double Shown(double si) const { return si * factor + offset; }
};

/// As the kind of machine says (MachineParameter); any other parameter is shown by its id in DisplayUnitFor(si_unit).
/// `typical` (SI) chooses between l and cm3.
ParameterInfo InfoFor(const MachineKind& kind, const std::string& parameter, std::string_view si_unit,
                      double typical);

/// The same for a quantity of the drift watch: sizes of effects in the unit people read them in.
ParameterInfo InfoForQuantity(const MachineKind& kind, const drift::Quantity& quantity, double typical);

/// "Bulk modulus K (bar)", as the axis of a plot says it.
std::string AxisLabel(const ParameterInfo& info);

}  // namespace hydroscope
