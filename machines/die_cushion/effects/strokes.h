#pragma once

#include "core/told.h"

/// Strokes that several effects ask for (Effect::shown_by, Effect::separations).
namespace hydroscope::effects {

inline constexpr Wording kPressureSteps = {
    "strokes at one slow ram speed and clearly different cushion pressures (for example 60, 120 and 200 bar)",
    "Hübe bei einer langsamen Stößelgeschwindigkeit und deutlich verschiedenen Kissendrücken (etwa 60, 120 und 200 bar)"};
inline constexpr Wording kRodSide = {
    "strokes at the same cushion pressure but different pressure in chamber B, or a hold with the ram at rest while chamber B is relieved",
    "Hübe bei gleichem Kissendruck, aber verschiedenem Druck in Kammer B, oder Halten bei ruhendem Stößel mit entlasteter Kammer B"};
inline constexpr Wording kHoldAndSpeeds = {
    "a pressure hold with the ram at rest, and strokes at different ram speeds",
    "Druckhalten bei ruhendem Stößel und Hübe bei verschiedenen Stößelgeschwindigkeiten"};
inline constexpr Wording kOpenings = {
    "strokes with the same flow at different spool openings: a fast ram at high pressure and the same ram speed at low pressure",
    "Hübe mit gleichem Durchfluss bei verschiedenen Schieberöffnungen: ein schneller Stößel bei hohem Druck und dieselbe Geschwindigkeit bei niedrigem"};
inline constexpr Wording kSteps = {
    "quick steps: of the valve command while the ram moves steadily, and of the ram speed while the valve stands still",
    "schnelle Sprünge: des Ventilbefehls, während der Stößel stetig fährt, und der Stößelgeschwindigkeit, während das Ventil stillsteht"};
inline constexpr Wording kLowPressure = {
    "strokes that start from a few bar and rise to working pressure, so that the stiffness is seen at low pressure too",
    "Hübe, die bei wenigen bar beginnen und auf Arbeitsdruck steigen, damit die Steifigkeit auch bei niedrigem Druck zu sehen ist"};
inline constexpr Wording kRelieved = {
    "the pressure sensor with chamber A relieved to tank (it must read zero), then strokes at clearly different pressures",
    "den Drucksensor bei zum Tank entlasteter Kammer A (er muss null zeigen), dann Hübe bei deutlich verschiedenen Drücken"};

}  // namespace hydroscope::effects
