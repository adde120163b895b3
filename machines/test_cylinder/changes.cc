#include "machines/test_cylinder/changes.h"

#include <array>

namespace hydroscope {
namespace {

// Changes of the logarithms of f_h, zeta_h, f_sv, K_sv and of T_d (s). Behind them stand
//   w_h^2 = 4 K A^2/(V_t m) c,   2 zeta_h/w_h = B/(m w_h^2),   gain = K_sv/(A c),   c = 1 + K_m V_t/(4 K A^2)
// with bulk modulus K, friction B and a specimen of stiffness K_m (the paper's eq. 9 without leakage).
using Direction = std::array<double, 5>;
constexpr Direction kFlowGain = {0, 0, 0, 1, 0};
constexpr Direction kCorner = {0, 0, 1, 0, 0};
constexpr Direction kFriction = {0, 1, 0, 0, 0};
constexpr Direction kBulkModulus = {0.5, -0.5, 0, 0, 0};
constexpr Direction kSpecimen = {0.5, -0.5, 0, -1, 0};
constexpr Direction kMass = {-0.5, -0.5, 0, 0, 0};
constexpr Direction kDelay = {0, 0, 0, 0, 1};

constexpr std::array<LoopChange, 7> kChanges = {{
    {"valve_gain",
     {"flow gain of the valve", "Durchflussverstärkung des Ventils"},
     {"another valve, another supply pressure, or a worn one",
      "ein anderes Ventil, ein anderer Versorgungsdruck, oder ein verschlissenes Ventil"},
     kFlowGain},
    {"slow_valve",
     {"corner frequency of the valve", "Eckfrequenz des Ventils"},
     {"another valve, a clogged filter of its pilot, low supply pressure",
      "ein anderes Ventil, ein verstopfter Filter der Vorsteuerung, niedriger Versorgungsdruck"},
     kCorner},
    {"friction",
     {"friction of rod and piston", "Reibung von Stange und Kolben"},
     {"guides, seals, side load, or leakage across the piston",
      "Führungen, Dichtungen, Querkraft, oder Leckage über den Kolben"},
     kFriction},
    {"trapped_air",
     {"bulk modulus of oil and chambers", "Kompressionsmodul von Öl und Kammern"},
     {"air in the oil: bleed the cylinder", "Luft im Öl: den Zylinder entlüften"},
     kBulkModulus,
     -1},
    {"specimen_stiffness",
     {"stiffness against which the rod moves, oil's and specimen's together",
      "Steifigkeit, gegen die sich die Stange bewegt, die von Öl und Prüfling zusammen"},
     {"a specimen is clamped, or a stiffer one", "ein Prüfling ist eingespannt, oder ein steiferer"},
     kSpecimen,
     +1},
    {"moving_mass",
     {"moving mass", "bewegte Masse"},
     {"another fixture or specimen on the rod",
      "eine andere Aufnahme oder ein anderer Prüfling an der Stange"},
     kMass},
    {"sensor_delay",
     {"delay of the position's reading", "Totzeit der Positionsanzeige"},
     {"filter or bus of the position sensor", "Filter oder Bus des Positionssensors"},
     kDelay},
}};

}  // namespace

std::span<const LoopChange> TestCylinderChanges() { return kChanges; }

}  // namespace hydroscope
