#include "machines/flexible_axis/equations.h"

#include <fmt/format.h>

namespace hydroscope::flexible_axis {

std::string SlipForce() { return "(F_c + F_s*exp(-(v_p/v_s)^2))"; }

std::string BristleRate() { return fmt::format("(v_p - abs(v_p)*f/{})", SlipForce()); }

std::string SpringForce() { return "(b*(v_p - v_l) + k*(x_p - x_l))"; }

std::string Acceleration() {
  return fmt::format("(p_1*A_1 - p_2*A_2 - f - sigma_1*{} - k_v*v_p - {})/m_1", BristleRate(), SpringForce());
}

std::string BulkModulus(const std::string& pressure) {
  return fmt::format(
      "(beta_2 + (beta_10 - beta_2)*ln(max({} + p_0, dp_lam)/(p_0 + p_low))/ln((p_0 + p_high)/(p_0 + p_low)))",
      pressure);
}

std::string Stiffness(int chamber) {
  return chamber == 1 ? BulkModulus("p_1") + "/(V_01 + A_1*x_p)"
                      : BulkModulus("p_2") + "/(V_02 + A_2*(L - x_p))";
}

std::string Root(const std::string& difference) {
  return fmt::format("({0})/sqrt((abs({0}) + dp_lam)*dp_n)", difference);
}

std::string Flow(int chamber, const std::string& spool) {
  return chamber == 1 ? fmt::format("Q_n/U_n*(max({0}, 0)*{1} - max(-({0}), 0)*{2})", spool,
                                    Root("p_s - p_1"), Root("p_1 - p_t"))
                      : fmt::format("Q_n/U_n*(max(-({0}), 0)*{1} - max({0}, 0)*{2})", spool,
                                    Root("p_s - p_2"), Root("p_2 - p_t"));
}

std::string PressureRate(int chamber) {
  const char* rest = chamber == 1 ? "- A_1*v_p + L_i*(p_2 - p_1) - L_e1*(p_1 - p_t)"
                                  : "+ A_2*v_p - L_i*(p_2 - p_1) - L_e2*(p_2 - p_t)";
  return fmt::format("{}*({} {})", Stiffness(chamber), Flow(chamber, "x_s"), rest);
}

}  // namespace hydroscope::flexible_axis
