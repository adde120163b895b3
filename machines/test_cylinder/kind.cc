#include "machines/test_cylinder/kind.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "machines/inputs.h"
#include "machines/test_cylinder/response.h"
#include "models/closed_loop.h"

namespace hydroscope {
namespace {

/// A valve or an amplifier that gives out no more than some current.
constexpr LoopChange kValveSaturation = {
    "valve_saturation",
    {"current that the valve follows", "Strom, dem das Ventil folgt"},
    {"the amplifier or the valve is at its end: excite less, or look at its supply",
     "Verstärker oder Ventil sind am Anschlag: weniger anregen, oder die Versorgung ansehen"},
    {}};

// Changes of the logarithms of f_h, zeta_h, f_sv, K_sv and of T_d (s). Behind them stand
//   w_h^2 = 4 K A^2/(V_t m) c,   2 zeta_h/w_h = B/(m w_h^2),   gain = K_sv/(A c),   c = 1 + K_m V_t/(4 K A^2)
// with bulk modulus K, friction B and a specimen of stiffness K_m (the paper's eq. 9 without leakage), or, without a specimen,
//   c = 1 + B C/A^2,   2 zeta_h/w_h = (B/(m w^2) + C m/A^2)/c,   w^2 = w_h^2/c
// with leakage C across the piston.
using Direction = std::array<double, 5>;
constexpr Direction kFlowGain = {0, 0, 0, 1, 0};
constexpr Direction kCorner = {0, 0, 1, 0, 0};
constexpr Direction kFriction = {0, 1, 0, 0, 0};
constexpr Direction kBulkModulus = {0.5, -0.5, 0, 0, 0};
constexpr Direction kSpecimen = {0.5, -0.5, 0, -1, 0};
constexpr Direction kLeakage = {0.5, -0.24, 0, -1, 0};  // of small leakage, at the published damping
constexpr Direction kMass = {-0.5, -0.5, 0, 0, 0};
constexpr Direction kDelay = {0, 0, 0, 0, 1};

/// Leakage that was not there before: what it adds to the damping grows as that of friction is small. `size` is ln c.
void LeakageChord(std::span<const double> from, double size, std::span<double> direction) {
  constexpr double kTangent = 1e-6;
  const double ln_c = std::max(size, kTangent), zeta = from[1];
  std::copy(kLeakage.begin(), kLeakage.end(), direction.begin());
  direction[1] = std::log1p(std::expm1(ln_c) / (4 * zeta * zeta)) / ln_c - 0.5;
}

constexpr std::array<LoopChange, 8> kChanges = {{
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
    {"piston_leakage",
     {"valve flow that a speed of the rod takes, with what leaks across the piston",
      "Durchfluss des Ventils für eine Geschwindigkeit der Stange, mit dem, was über den Kolben leckt"},
     {"piston seal or liner worn, or a bypass left open: look at the drift of the rod with the valve closed",
      "Kolbendichtung oder Rohr verschlissen, oder ein Bypass offen: nachsehen, wie die Stange bei geschlossenem Ventil wandert"},
     kLeakage,
     +1,
     LeakageChord},
    {"moving_mass",
     {"moving mass", "bewegte Masse"},
     {"another fixture or specimen on the rod",
      "eine andere Aufnahme oder ein anderer Prüfling an der Stange"},
     kMass},
    {"sensor_delay",
     {"delay from the current's reading to the position's",
      "Totzeit von der Anzeige des Stroms zu der der Position"},
     {"filter or bus of the position sensor, or columns of current and position that are not of the same moment: a row late "
      "in the log, a slower task",
      "Filter oder Bus des Positionssensors, oder Spalten von Strom und Position, die nicht vom selben Zeitpunkt sind: eine "
      "Zeile später im Log, eine langsamere Task"},
     kDelay},
}};

/// What may happen to a test cylinder between two records, as changes of its parameters.
std::span<const LoopChange> TestCylinderChanges() { return kChanges; }

// Noise on a set point moves the rod by tenths of a millimetre to some centimetres; valves take mA to some tenths of an ampere.
constexpr PlausibleSize kRodTravel{1e-5, 0.1, PlausibleSize::kTravel};

constexpr MachineInput kSignals[] = {
    Measured("z_set", "m",
             {"set point of the position, excited from outside", "Sollwert der Position, von außen angeregt"},
             "zsoll xset xsoll xref zref sollwert setpoint", kRodTravel),
    Measured(
        "I_v", "A",
        {"current of the valve, as the controller gives it out", "Ventilstrom, wie ihn der Regler ausgibt"},
        "i iv ivalve ventilstrom current", PlausibleSize{1e-4, 0.3}),
    Measured("z", "m", {"position of the rod", "Position der Stange"}, "x zist xist position weg istwert",
             kRodTravel),
};
constexpr MachineInput kGeometry[] = {
    {.name = "A",
     .si = "m2",
     .required = true,
     .meaning = {"piston area, the same on both sides", "Kolbenfläche, auf beiden Seiten gleich"},
     .positive = true},
};
constexpr MachineParameter kParameters[] = {
    Identified("f_h", "Hz", {"natural frequency of the oil column", "Eigenfrequenz der Ölsäule"},
               {"Mass of the rod on the oil in the chambers. Air makes it fall, a specimen rise.",
                "Masse der Stange auf dem Öl in den Kammern. Luft lässt sie fallen, ein Prüfling steigen."},
               "f_h"),
    Identified(
        "zeta_h", "1", {"damping of the oil column", "Dämpfung der Ölsäule"},
        {"Friction of guides and seals, and leakage.", "Reibung von Führungen und Dichtungen, und Leckage."},
        "\\zeta_h"),
    Identified("f_sv", "Hz", {"corner frequency of the valve", "Eckfrequenz des Ventils"},
               {"A clogged pilot makes it fall.", "Eine zugesetzte Vorsteuerung lässt sie fallen."},
               "f_{sv}"),
    Identified("K_sv", "m3/(s A)", {"flow gain of the valve", "Durchflussverstärkung des Ventils"},
               {"Size of the valve and supply pressure.", "Größe des Ventils und Versorgungsdruck."},
               "K_{sv}"),
    {.name = "T_d",
     .si = "s",
     .meaning = {"delay from current to reading, beside the hold",
                 "Totzeit vom Strom zur Anzeige, neben dem Halteglied"},
     .symbol = "T_d",
     .sentence = {"Filters and buses.", "Filter und Busse."},
     .shown = "ms",
     .factor = 1e3,
     .relative = false},
};

// Poles of test cylinders and of their valves lie between 30 Hz and 1 kHz; combinations within a factor of two of the truth
// lead to its minimum, and those with the poles swapped are looked at too, since that is a second minimum.
constexpr double kFrequencies[] = {60, 120, 240, 480, 960};
constexpr double kDampings[] = {0.15, 0.5, 1.2};
constexpr LoopParameter kSearched[] = {
    {.name = "f_h", .starts = kFrequencies, .wanted = 0.01, .unit = "Hz"},
    {.name = "zeta_h", .starts = kDampings, .wanted = 0.03},
    {.name = "f_sv", .starts = kFrequencies, .unit = "Hz"},
    {.name = "K_sv", .kind = LoopParameter::Kind::kGain, .wanted = 0.005, .unit = "m3/(s A)"},
    {.name = "T_d", .kind = LoopParameter::Kind::kDelay, .unit = "ms", .factor = 1e3, .scale = 1e-4},
};

void CompleteTestCylinder(const LogSample&, const std::map<std::string, double>&, MachineDraft& draft) {
  draft.machine.log.hold = InputHold::kZero;
  draft.decided.emplace_back("the controller holds the current from row to row",
                             "der Regler hält den Strom von Zeile zu Zeile");
}

MachineWords TestCylinderWords(const Machine&) {
  return {.output = {"position", "Position"},
          .stroke = {"record", "Aufzeichnung"},
          .vary = {"set point", "Sollwert"},
          .hydraulic = true};
}

}  // namespace

const ClosedLoopPlant kTestCylinderPlant = {
    .set_point = "z_set",
    .input = "I_v",
    .output = "z",
    .input_unit = "A",
    .response = TestCylinderResponse,
    .share_out = ShareOutPoles,
    .ways = 3,
    .damping = 1,
    .parameters = kSearched,
    // The published cylinder, set up again with another valve: 2.5 % in zeta_h, 1.8 standard deviations of such a difference.
    .repeatability = 0.01,
    .changes = TestCylinderChanges(),
    .limit = kValveSaturation};

const MachineKind kTestCylinder = {.id = "test_cylinder",
                                   .title = {"test cylinder", "Prüfzylinder"},
                                   .signals = kSignals,
                                   .geometry = kGeometry,
                                   .parameters = kParameters,
                                   .output_unit = "m",
                                   .words = TestCylinderWords,
                                   .picture = TestCylinderPicture,
                                   .draft = {nullptr, CompleteTestCylinder},
                                   .closed_loop = &kTestCylinderPlant};

}  // namespace hydroscope
