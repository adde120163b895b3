#include "report/report_parameters.h"

#include <array>
#include <cmath>

#include "core/effect_units.h"
#include "core/units.h"
#include "models/parameter_unit.h"

namespace hydroscope {
namespace {

/// "mm2" -> "mm²", "m3/s" -> "m³/s" for people.
std::string PrettyUnit(std::string unit) {
  for (const auto& [plain, pretty] : {std::pair{"m3", "m³"}, {"m2", "m²"}})
    for (std::size_t at = unit.find(plain); at != unit.npos; at = unit.find(plain, at + 3))
      unit.replace(at, 2, pretty);
  return unit == "1" ? "" : unit;
}

/// A unit with a power of ten where numbers would begin or end in a row of zeros: "10⁻⁹ N s/m".
void ChooseExponent(ParameterInfo& info, double typical) {
  const double size = std::abs(typical * info.factor);
  if (!std::isfinite(size) || size == 0 || (size >= 1e-3 && size < 1e6) || info.offset != 0) return;
  static constexpr std::array<const char*, 10> kRaised = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  const int exponent = 3 * static_cast<int>(std::floor(std::log10(size) / 3));
  info.factor *= std::pow(10.0, -exponent);
  std::string power = exponent < 0 ? "⁻" : "";
  for (const char digit : std::to_string(std::abs(exponent))) power += kRaised[digit - '0'];
  info.unit = "10" + power + (info.unit.empty() ? "" : " " + info.unit);
}

void ChooseUnit(ParameterInfo& info, std::string_view si_unit, double typical) {
  const DisplayUnit unit = DisplayUnitFor(si_unit);
  info.factor = unit.factor;
  info.offset = unit.offset;
  info.unit = PrettyUnit(std::string(unit.name));
  if (si_unit == "m3" && std::abs(typical) < 1e-4) info.factor = 1e6, info.unit = "cm³";
  ChooseExponent(info, typical);
}

}  // namespace

ParameterInfo InfoFor(const MachineKind& kind, const std::string& parameter, std::string_view si_unit,
                      double typical) {
  ParameterInfo info;
  info.id = info.symbol = parameter;
  ChooseUnit(info, si_unit, typical);
  info.relative = ToldInPercent(kind, parameter, si_unit);
  const MachineParameter* known = FindParameter(kind, parameter);
  if (known == nullptr) return info;
  if (!known->symbol.empty()) info.symbol = known->symbol;
  info.name = known->meaning;
  info.sentence = known->sentence;
  if (!known->shown.empty()) {
    info.unit = known->shown;
    info.factor = known->factor;
  }
  return info;
}

ParameterInfo InfoForQuantity(const MachineKind& kind, const drift::Quantity& quantity, double typical) {
  ParameterInfo info = InfoFor(kind, quantity.name, quantity.unit, typical);
  if (!quantity.effect) return info;
  const EffectUnit unit = EffectUnitFor(quantity.unit);
  info.unit = unit.name;
  info.factor = unit.factor;
  info.offset = 0;
  return info;
}

std::string AxisLabel(const ParameterInfo& info) {
  const std::string name = info.name.empty() ? info.symbol : info.name + " " + info.symbol;
  return info.unit.empty() ? name : name + " (" + info.unit + ")";
}

}  // namespace hydroscope
