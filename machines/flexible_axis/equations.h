#pragma once

#include <string>

/// Parts of the axis's equations, as texts over its states, parameters and geometry; effects are said with them too.
/// Numbers of equations: Yousefi, Handroos and Soleymani (Mechatronics 18, 2008), errata in docs/flexible_axis.md.
namespace hydroscope::flexible_axis {

/// N; LuGre friction that the bristles carry once they slip, g of equation 5 without sigma_0.
std::string SlipForce();
/// m/s; rate of the bristles' deflection, equation 4.
std::string BristleRate();
/// N; spring and damper between piston and load.
std::string SpringForce();
/// m/s^2; equation 2.
std::string Acceleration();
/// Pa; equation 9 through its values at p_low and p_high.
std::string BulkModulus(const std::string& pressure);
/// Pa/m^3; bulk modulus over the volume of chamber 1 or 2, equation 10.
std::string Stiffness(int chamber);
/// 1; root of a pressure difference over dp_n, in its sign.
std::string Root(const std::string& difference);
/// m^3/s; flow of the valve into chamber 1 or 2 with the spool at `spool`, V; equations 11 and 12.
std::string Flow(int chamber, const std::string& spool);
/// Pa/s; equation 7.
std::string PressureRate(int chamber);

}  // namespace hydroscope::flexible_axis
