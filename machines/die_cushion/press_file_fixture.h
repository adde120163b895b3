#pragma once

#include <string>

namespace hydroscope {

/// [geometry] and [gate] of a press of die cushions, as all tests of presses have them.
inline const std::string kPressGeometryAndGate = R"toml(
[geometry]
A_A = 0.0125
dp_nom = { value = 35, unit = "bar" }
p_t = 0
[gate]
conditions = { y_v = { min = 0.04 }, "ddt(z)" = { max = -0.004, unit = "m/s" } }
stroke_gap = 0.25
min_stroke = 0.3
)toml";

/// A machine file of a press with `axes` ("\"left\", \"right\"") whose signals come over DDS; `live`: further keys of
/// [live], `oil_unit`: of T_oil.
inline std::string PressFile(const std::string& axes, const std::string& live, const std::string& oil_unit) {
  return "[machine]\nname = \"press\"\nmodel = \"die_cushion\"\n[live]\n" + live + "axes = [" + axes +
         R"toml(]
[live.dds]
[signals]
p_A = { dds = "{axis}/p_A", unit = "Pa" }
p_B = { dds = "{axis}/p_B", unit = "Pa", required = false }
p_0 = { dds = "{axis}/p_0", unit = "Pa", required = false }
z   = { dds = "{axis}/z", unit = "m" }
y_v = { dds = "{axis}/y_v", unit = "1" }
U_v = { dds = "{axis}/U_v", unit = "V", stuck_time = 0, required = false }
T_oil = { dds = "{axis}/T_oil", unit = ")toml" +
         oil_unit + "\", stuck_time = 0, required = false }\n" + kPressGeometryAndGate;
}

}  // namespace hydroscope
