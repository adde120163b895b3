#pragma once

/// Strokes that several effects ask for (Effect::shown_by, Effect::separations).
namespace hydroscope::effects {

inline constexpr const char* kPressureSteps =
    "strokes at one slow ram speed and clearly different cushion pressures (for example 60, 120 and 200 bar)";
inline constexpr const char* kRodSide =
    "strokes at the same cushion pressure but different pressure in chamber B, or a hold with the ram at "
    "rest while chamber B is relieved";
inline constexpr const char* kHoldAndSpeeds =
    "a pressure hold with the ram at rest, and strokes at different ram speeds";
inline constexpr const char* kOpenings =
    "strokes with the same flow at different spool openings: a fast ram at high "
    "pressure and the same ram speed at low pressure";
inline constexpr const char* kSteps =
    "quick steps: of the valve command while the ram moves steadily, and of the "
    "ram speed while the valve stands still";
inline constexpr const char* kLowPressure =
    "strokes that start from a few bar and rise to working pressure, so that "
    "the stiffness is seen at low pressure too";
inline constexpr const char* kRelieved =
    "the pressure sensor with chamber A relieved to tank (it must read zero), "
    "then strokes at clearly different pressures";

}  // namespace hydroscope::effects
