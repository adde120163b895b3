#pragma once

#include <string>

/// Parts of the pump's equations, as texts over its states, parameters and geometry; effects are said with them too.
/// Numbers of equations: paper of docs/pump.md, errata there.
namespace hydroscope::pump {

/// Pa; pressure at the outlet: its state is `p`, that pressure plus what the lag of the flow sensor holds back (docs/pump.md).
std::string OutletPressure();
/// m; how far the spool opens an edge by a deflection, "x_v" or "-x_v". `round`: near the null over r_e, exactly 0 only far beyond.
std::string EdgeOpening(const std::string& deflection, bool round);
/// m^3/s; through the metering edges of the compensator from outlet to control chamber, and from there to tank: equation 2.
std::string FlowIn(bool round);
std::string FlowOut(bool round);
/// m^3/s; what the pistons deliver, equation 5.
std::string Delivered();
/// N; dry friction that sets in over a speed.
std::string DryFriction(const std::string& force, const std::string& speed, const std::string& sets_in);
/// Pa/m^3; of the line at the outlet, equation 6, and of the control chamber, equation 4.
std::string LineStiffness();
std::string ChamberStiffness();

}  // namespace hydroscope::pump
