#include "machines/pump/equations.h"

#include <fmt/format.h>

namespace hydroscope::pump {
namespace {

/// 1; root of a pressure difference over dp_n, in its sign.
std::string RootOf(const std::string& difference) {
  return fmt::format("({0})/sqrt(sqrt(({0})^2 + dp_lam^2)*dp_n)", difference);
}

}  // namespace

std::string LineStiffness() { return "(E/V_t)"; }

std::string ChamberStiffness() { return "E/(V_c + A_p*x_p)"; }

std::string OutletPressure() { return fmt::format("(p - T_q*load_flow*{})", LineStiffness()); }

std::string EdgeOpening(const std::string& deflection, bool round) {
  const std::string sharp = "max(" + deflection + ", 0)";
  return round ? "(" + sharp + " + r_e*ln(1 + exp(-abs(x_v)/r_e)))" : sharp;
}

std::string FlowIn(bool round) {
  return "K_q*" + EdgeOpening("x_v", round) + "*" + RootOf(OutletPressure() + " - p_c");
}

std::string FlowOut(bool round) { return "K_q*" + EdgeOpening("-x_v", round) + "*" + RootOf("p_c - p_t"); }

std::string DryFriction(const std::string& force, const std::string& speed, const std::string& sets_in) {
  return fmt::format("{}*{}/sqrt(({})^2 + ({})^2)", force, speed, speed, sets_in);
}

std::string Delivered() { return "shaft_speed*D_max*(1 - x_p/X_p)"; }

}  // namespace hydroscope::pump
