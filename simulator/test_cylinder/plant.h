#pragma once

#include <array>

#include "simulator/test_cylinder/test_cylinder.h"

namespace hydroscope {

/// The cylinder and its valve, integrated in small steps.
///
///   valve      x' = (i - x) w_sv                          spool, as the current it stands for
///   flow       Q = K_sv x sqrt(1 - sign(x) p/p_s)         or K_sv x
///   chambers   p' = (Q - A v - C p) 4/(V_t (1/K + a(p)))  p: pressure difference of the chambers
///   air        a(p) = phi p_m (1/p_1^2 + 1/p_2^2)/2       p_m: p_s/2; p_1, p_2: p_m +- p/2
///   rod        m v' = A p - B v - F_c tanh(v/v_c) - k z
class TestCylinderPlant {
 public:
  explicit TestCylinderPlant(const TestCylinderOptions& options);

  /// Goes on with other figures.
  void Become(const TestCylinderOptions& options);
  /// Moves on by `seconds` with a constant current, A.
  void Advance(double current, double seconds);
  double position() const { return state_[3]; }  ///< m

  double bulk_modulus() const { return 1 / compressibility_; }  ///< Pa
  double friction() const { return friction_; }                 ///< N s/m
  double leakage() const { return leakage_; }                   ///< m3/(s Pa)

 private:
  using State = std::array<double, 4>;  // spool, pressure difference, speed, position
  State Rates(const State& state, double current) const;

  TestCylinderOptions options_;
  double compressibility_, friction_, leakage_;
  State state_{};
};

}  // namespace hydroscope
