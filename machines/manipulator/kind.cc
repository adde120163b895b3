#include "machines/manipulator/kind.h"

#include <array>

#include "machines/inputs.h"
#include "machines/manipulator/effects/effects.h"
#include "machines/manipulator/equations.h"

namespace hydroscope {
namespace {

constexpr MachineInput Angle(std::string_view name, Wording meaning) {
  return Measured(name, "rad", meaning, PlausibleSize{0, 7});
}
constexpr MachineInput Pressure(std::string_view name, Wording meaning) {
  return Measured(name, "Pa", meaning, PlausibleSize{5e5, 1e8});
}
constexpr MachineInput Spool(std::string_view name, Wording meaning) {
  return Measured(name, "1", meaning, PlausibleSize{0, 1.5});
}

constexpr std::array<MachineInput, 9> kArmSignals = {
    Angle("q_1", {"angle of joint 1", "Winkel von Gelenk 1"}),
    Pressure("p_11",
             {"pressure on the piston side of cylinder 1", "Druck auf der Kolbenseite von Zylinder 1"}),
    Pressure("p_12", {"pressure on the rod side of cylinder 1", "Druck auf der Stangenseite von Zylinder 1"}),
    Spool("y_1", {"spool of valve 1, -1 to 1", "Schieber von Ventil 1, -1 bis 1"}),
    Angle("q_2", {"angle of joint 2", "Winkel von Gelenk 2"}),
    Pressure("p_21",
             {"pressure on the piston side of cylinder 2", "Druck auf der Kolbenseite von Zylinder 2"}),
    Pressure("p_22", {"pressure on the rod side of cylinder 2", "Druck auf der Stangenseite von Zylinder 2"}),
    Spool("y_2", {"spool of valve 2, -1 to 1", "Schieber von Ventil 2, -1 bis 1"}),
    Pressure("p_s", {"supply pressure", "Versorgungsdruck"}),
};

constexpr MachineInput Distance(std::string_view name, Wording meaning, double lowest, double highest,
                                bool required = true) {
  MachineInput distance = Known(name, "m", meaning, lowest, highest);
  distance.required = required;
  return distance;
}
constexpr MachineInput PinDistance(std::string_view name, Wording meaning) {
  return Distance(name, meaning, 0.02, 10);
}
constexpr MachineInput LeverAngle(std::string_view name, Wording meaning) {
  return {.name = name,
          .si = "rad",
          .required = true,
          .meaning = meaning,
          .lowest = -6.3,
          .highest = 6.3,
          .unit = "rad"};
}
constexpr MachineInput PistonArea(std::string_view name, Wording meaning) {
  return Known(name, "m2", meaning, 1e-4, 1, "cm2");
}
constexpr MachineInput LineVolume(std::string_view name, Wording meaning) {
  return {.name = name,
          .si = "m3",
          .required = false,
          .meaning = meaning,
          .lowest = 0,
          .highest = 0.1,
          .unit = "l",
          .otherwise = 0.0};
}
constexpr MachineInput BaseParameter(std::string_view name, std::string_view si, double lowest) {
  return {
      .name = name,
      .si = si,
      .required = false,
      .meaning =
          {"base parameter, once identified: what it is then is known and no longer fitted",
           "Basisparameter, einmal identifiziert: er gilt dann als bekannt und wird nicht mehr angepasst"},
      .lowest = lowest,
      .highest = 1e6,
      .unit = si};
}

constexpr std::array<MachineInput, 26> kArmGeometry = {
    Distance("a_1", {"length of link 1, from joint to joint", "Länge von Glied 1, von Gelenk zu Gelenk"},
             0.05, 20),
    Distance("a_2", {"length of link 2, to the tip", "Länge von Glied 2, bis zur Spitze"}, 0.05, 20, false),
    PinDistance("l1_1", {"distance of the cylinder's base pin from joint 1",
                         "Abstand des Fußbolzens des Zylinders von Gelenk 1"}),
    PinDistance("l2_1",
                {"distance of the rod's pin from joint 1", "Abstand des Stangenbolzens von Gelenk 1"}),
    LeverAngle("q0_1",
               {"angle between these two where q_1 is 0", "Winkel zwischen diesen beiden, wo q_1 0 ist"}),
    PinDistance("x0_1", {"length of cylinder 1 retracted, between its pins",
                         "Länge des eingefahrenen Zylinders 1, zwischen seinen Bolzen"}),
    Distance("S_1", {"stroke of cylinder 1", "Hub von Zylinder 1"}, 0.01, 10),
    PistonArea("A1_1", {"area of cylinder 1, piston side", "Fläche von Zylinder 1, Kolbenseite"}),
    PistonArea("A2_1", {"area of cylinder 1, rod side", "Fläche von Zylinder 1, Stangenseite"}),
    LineVolume("V_1", {"oil between valve and each chamber of cylinder 1",
                       "Öl zwischen Ventil und jeder Kammer von Zylinder 1"}),
    PinDistance("l1_2", {"distance of the cylinder's base pin from joint 2",
                         "Abstand des Fußbolzens des Zylinders von Gelenk 2"}),
    PinDistance("l2_2",
                {"distance of the rod's pin from joint 2", "Abstand des Stangenbolzens von Gelenk 2"}),
    LeverAngle("q0_2",
               {"angle between these two where q_2 is 0", "Winkel zwischen diesen beiden, wo q_2 0 ist"}),
    PinDistance("x0_2", {"length of cylinder 2 retracted, between its pins",
                         "Länge des eingefahrenen Zylinders 2, zwischen seinen Bolzen"}),
    Distance("S_2", {"stroke of cylinder 2", "Hub von Zylinder 2"}, 0.01, 10),
    PistonArea("A1_2", {"area of cylinder 2, piston side", "Fläche von Zylinder 2, Kolbenseite"}),
    PistonArea("A2_2", {"area of cylinder 2, rod side", "Fläche von Zylinder 2, Stangenseite"}),
    LineVolume("V_2", {"oil between valve and each chamber of cylinder 2",
                       "Öl zwischen Ventil und jeder Kammer von Zylinder 2"}),
    TankPressure(),
    MachineInput{.name = "g",
                 .si = "m/s2",
                 .required = false,
                 .meaning = {"gravity", "Fallbeschleunigung"},
                 .lowest = 0,
                 .highest = 30,
                 .unit = "m/s2",
                 .otherwise = 9.81},
    BaseParameter("mx_1", "kg m", 1),
    BaseParameter("my_1", "kg m", -1e5),
    BaseParameter("J_1", "kg m2", 1),
    BaseParameter("mx_2", "kg m", 1),
    BaseParameter("my_2", "kg m", -1e5),
    BaseParameter("J_2", "kg m2", 1),
};

constexpr Wording kAcross{"How far the centre of mass lies beside the line of the link.",
                          "Wie weit der Schwerpunkt neben der Linie des Glieds liegt."};
constexpr Wording kViscous{
    "Friction of the piston that grows with its speed; it moves with the oil temperature.",
    "Reibung des Kolbens, die mit seiner Geschwindigkeit wächst; sie ändert sich mit der Öltemperatur."};
constexpr Wording kCoulomb{
    "Friction of the seals at any speed; it moves with wear, pressure and side loads.",
    "Reibung der Dichtungen bei jeder Geschwindigkeit; sie ändert sich mit Verschleiß, Druck und Querkräften."};
constexpr Wording kOil{"How stiff the oil is, hoses included; it falls when air enters the oil.",
                       "Wie steif das Öl samt Schläuchen ist; er fällt, wenn Luft ins Öl kommt."};

constexpr MachineParameter Edge(std::string_view name, Wording meaning) {
  return Identified(
      name, "m3/(s sqrt(Pa))", meaning,
      {"What the edge passes per root of its pressure difference at full opening; it moves with wear, "
       "dirt and the oil's density.",
       "Was die Kante je Wurzel ihres Druckunterschieds ganz offen durchlässt; es ändert sich mit Verschleiß, "
       "Schmutz und der Dichte des Öls."});
}

constexpr std::array<MachineParameter, 20> kArmParameters = {
    Identified("mx_1", "kg m",
               {"moment of mass along link 1, with m_2 a_1", "Massenmoment längs Glied 1, mit m_2 a_1"},
               {"What weighs on joint 1 along the link; it moves with what the arm carries.",
                "Was längs des Glieds auf Gelenk 1 lastet; es ändert sich mit dem, was der Arm trägt."}),
    Identified("my_1", "kg m", {"moment of mass across link 1", "Massenmoment quer zu Glied 1"}, kAcross),
    Identified("J_1", "kg m2",
               {"inertia about joint 1, with m_2 a_1^2", "Trägheit um Gelenk 1, mit m_2 a_1^2"},
               {"What link 1 opposes to acceleration; it moves with what the arm carries.",
                "Was Glied 1 der Beschleunigung entgegensetzt; es ändert sich mit dem, was der Arm trägt."}),
    Identified("b_1", "N s/m", {"viscous friction of cylinder 1", "viskose Reibung von Zylinder 1"},
               kViscous),
    Identified("F_c_1", "N", {"Coulomb friction of cylinder 1", "Coulombsche Reibung von Zylinder 1"},
               kCoulomb),
    Identified("K_1", "Pa",
               {"bulk modulus of the oil in cylinder 1", "Kompressionsmodul des Öls in Zylinder 1"}, kOil),
    Edge("C_PA_1",
         {"edge PA of valve 1, supply to piston side", "Kante PA von Ventil 1, Versorgung zur Kolbenseite"}),
    Edge("C_AT_1",
         {"edge AT of valve 1, piston side to tank", "Kante AT von Ventil 1, Kolbenseite zum Tank"}),
    Edge("C_PB_1",
         {"edge PB of valve 1, supply to rod side", "Kante PB von Ventil 1, Versorgung zur Stangenseite"}),
    Edge("C_BT_1", {"edge BT of valve 1, rod side to tank", "Kante BT von Ventil 1, Stangenseite zum Tank"}),
    Identified("mx_2", "kg m", {"moment of mass along link 2", "Massenmoment längs Glied 2"},
               {"What weighs on joint 2 along the link; it moves with what the arm carries.",
                "Was längs des Glieds auf Gelenk 2 lastet; es ändert sich mit dem, was der Arm trägt."}),
    Identified("my_2", "kg m", {"moment of mass across link 2", "Massenmoment quer zu Glied 2"}, kAcross),
    Identified("J_2", "kg m2", {"inertia about joint 2", "Trägheit um Gelenk 2"},
               {"What link 2 opposes to acceleration; it moves with what the arm carries.",
                "Was Glied 2 der Beschleunigung entgegensetzt; es ändert sich mit dem, was der Arm trägt."}),
    Identified("b_2", "N s/m", {"viscous friction of cylinder 2", "viskose Reibung von Zylinder 2"},
               kViscous),
    Identified("F_c_2", "N", {"Coulomb friction of cylinder 2", "Coulombsche Reibung von Zylinder 2"},
               kCoulomb),
    Identified("K_2", "Pa",
               {"bulk modulus of the oil in cylinder 2", "Kompressionsmodul des Öls in Zylinder 2"}, kOil),
    Edge("C_PA_2",
         {"edge PA of valve 2, supply to piston side", "Kante PA von Ventil 2, Versorgung zur Kolbenseite"}),
    Edge("C_AT_2",
         {"edge AT of valve 2, piston side to tank", "Kante AT von Ventil 2, Kolbenseite zum Tank"}),
    Edge("C_PB_2",
         {"edge PB of valve 2, supply to rod side", "Kante PB von Ventil 2, Versorgung zur Stangenseite"}),
    Edge("C_BT_2", {"edge BT of valve 2, rod side to tank", "Kante BT von Ventil 2, Stangenseite zum Tank"}),
};

MachineWords ArmWords(const Machine&) {
  return {.output = {"angles and pressures", "Winkel und Drücke"},
          .stroke = {"episode", "Episode"},
          .vary = {"positions and speeds of both joints", "Stellungen und Geschwindigkeiten beider Gelenke"}};
}

}  // namespace

const MachineKind kManipulator = {.id = "manipulator",
                                  .title = {"hydraulic manipulator", "hydraulischer Manipulator"},
                                  .signals = kArmSignals,
                                  .geometry = kArmGeometry,
                                  .parameters = kArmParameters,
                                  .has_states = true,
                                  .states = manipulator::States,
                                  .words = ArmWords,
                                  .picture = ManipulatorPicture,
                                  .supply = "p_s",
                                  .effects = manipulator::Effects,
                                  .linear_form = manipulator::Linear};

}  // namespace hydroscope
