#include "machines/die_cushion/kind.h"

#include <array>

#include "machines/die_cushion/balance.h"
#include "machines/die_cushion/library.h"

namespace hydroscope {
namespace {

constexpr std::array<MachineInput, 8> kCushionSignals = {{
    {"p_A", "Pa", true, "pressure in the cylinder chamber A"},
    {"z", "m", true, "position of the cushion"},
    {"y_v", "1", true, "spool position, -1 to 1"},
    {"p_B", "Pa", false, "pressure in chamber B"},
    {"p_0", "Pa", false, "supply pressure"},
    {"p_t", "Pa", false, "tank pressure"},
    {"U_v", "V", false, "valve command"},
    {"T_oil", "K", false, "oil temperature"},
}};
constexpr std::array<MachineInput, 4> kCushionGeometry = {{
    {"A_A", "m2", true, "piston area on side A", true, 1e-4, 1.0, "cm2", true},  // 1 cm2 to 1 m2
    // Valves state their flow at 1 bar (cartridges) to 350 bar.
    {"dp_nom", "Pa", true, "pressure drop at which the valve's nominal flow is stated", true, 1e5, 350e5,
     "bar"},
    {"p_t", "Pa", false, "tank pressure where it is not measured", false, -1e5, 50e5, "bar", false, 0.0},
    {"stroke", "m", false, "working stroke of the cushion", true},
}};
constexpr std::array<MachineInput, 4> kCushionParameters = {{
    {"K", "Pa", true, "effective bulk modulus"},
    {"V0", "m3", true, "dead volume"},
    {"Q_vn", "m3/s", true, "nominal flow of the valve"},
    {"y_0", "1", true, "spool offset"},
}};
MachineWords CushionWords(const Machine&) {
  return {"flow", "drawing stroke", "ram speed and pressure", "whether oil is missing or in surplus", true};
}

std::vector<std::shared_ptr<const Effect>> CushionEffects(const Machine& machine) {
  return DieCushionEffects(CushionGeometryOf(machine));
}

}  // namespace

const MachineKind kDieCushion = {.id = "die_cushion",
                                 .signals = kCushionSignals,
                                 .geometry = kCushionGeometry,
                                 .parameters = kCushionParameters,
                                 .output_unit = "m3/s",
                                 .own_library = false,
                                 .words = CushionWords,
                                 .build = BuildDieCushion,
                                 .effects = CushionEffects};

}  // namespace hydroscope
