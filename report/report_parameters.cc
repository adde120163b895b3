#include "report/report_parameters.h"

#include <cmath>

#include "core/units.h"

namespace hydroscope {
namespace {

/// "mm2" -> "mm²", "m3/s" -> "m³/s" for people.
std::string PrettyUnit(std::string unit) {
  for (const auto& [plain, pretty] : {std::pair{"m3", "m³"}, {"m2", "m²"}})
    for (std::size_t at = unit.find(plain); at != unit.npos; at = unit.find(plain, at + 3))
      unit.replace(at, 2, pretty);
  return unit == "1" ? "" : unit;
}

void ChooseUnit(ParameterInfo& info, std::string_view si_unit, double typical) {
  const DisplayUnit unit = DisplayUnitFor(si_unit);
  info.factor = unit.factor;
  info.offset = unit.offset;
  info.unit = PrettyUnit(std::string(unit.name));
  if (si_unit == "m3" && std::abs(typical) < 1e-4) info.factor = 1e6, info.unit = "cm³";
  if (si_unit == "Pa" && std::abs(typical) > 1e8) info.factor = 1e-9, info.unit = "GPa";
  if (si_unit == "m3/(s Pa)") info.factor = 6e4 * 1e7, info.unit = "l/min per 100 bar";
  if (si_unit == "K") info.relative = false;
}

}  // namespace

ParameterInfo InfoFor(const std::string& parameter, std::string_view si_unit, double typical) {
  ParameterInfo info;
  info.id = info.symbol = parameter;
  ChooseUnit(info, si_unit, typical);
  if (parameter == "K") {
    info.symbol = "K′";
    info.name = "effective bulk modulus";
    info.sentence =
        "How stiff the oil column is, hoses and cylinder walls included; it falls when air enters the oil.";
  } else if (parameter == "V0") {
    info.symbol = "V_{0}";
    info.name = "dead volume";
    info.sentence =
        "Oil volume between valve and piston with the piston at its zero position: lines, fittings, bottom "
        "of the chamber.";
  } else if (parameter == "Q_vn") {
    info.symbol = "Q_{vn}";
    info.name = "nominal valve flow";
    info.sentence =
        "Flow through the fully open valve at its nominal pressure drop; it moves with the oil's viscosity "
        "and density, with "
        "worn or dirty metering edges, and it absorbs leaks that the model does not hold.";
  } else if (parameter == "y_0") {
    info.symbol = "y_{0}";
    info.name = "spool zero offset";
    info.sentence =
        "Spool position at which the metering edge just closes, in % of the full spool stroke; it moves with "
        "wear of the edge and with the "
        "zero of the spool sensor.";
    info.unit = "% of stroke";
    info.factor = 100;
    info.relative = false;
  }
  return info;
}

std::string AxisLabel(const ParameterInfo& info) {
  const std::string name = info.name.empty() ? info.symbol : info.name + " " + info.symbol;
  return info.unit.empty() ? name : name + " (" + info.unit + ")";
}

}  // namespace hydroscope
