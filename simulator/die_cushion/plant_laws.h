#pragma once

#include <cstdint>
#include <vector>

#include "simulator/die_cushion/imperfections.h"

namespace hydroscope {

/// Imperfections of the machine that hold all through a log, as plain numbers; 0 = absent.
struct PlantLaws {
  double return_line = 0;    ///< Pa/(m^3/s), laminar drop between the edge and the tank
  double tank_shift = 0;     ///< Pa, of the tank line above what is known of it
  double check_valve = 0;    ///< Pa, opening pressure of a check valve in the tank line
  double laminar_edge = 0;   ///< Pa, pressure difference well below which an edge is laminar
  double modulus_slope = 0;  ///< 1, dK/dp
  double relief_square = 0, relief_crack = 0;                ///< m^3/(s Pa^2), Pa
  double zone_leakage = 0, zone_centre = 0, zone_width = 0;  ///< m^3/(s Pa), m, m
  double supply_leakage = 0;         ///< m^3/(s sqrt(Pa)), from the supply into chamber A
  double second_gain = 0, knee = 0;  ///< 1, gain beyond the knee less 1; opening of the knee
  double area_error = 0;             ///< 1, true over known piston area, less 1

  /// Leakage out of chamber A that only the position and the pressures decide, m^3/s.
  double Leakage(double p_A, double p_B, double p_0, double z) const;
  /// The opening that meters, of a spool with two gains.
  double Opening(double opening) const;
  /// Flow at the pressure difference `dp` over an edge (to the tank: with the line behind it), m^3/s, for a
  /// conductance in m^3/(s sqrt(Pa)) whose sign is that of the opening. Viscous and inertial drops add:
  /// dp = return_line Q + (Q/conductance)^2, solved for Q.
  double EdgeFlow(double conductance, double dp) const;
  /// The pressure difference that this flow takes; the inverse of EdgeFlow, Pa with the sign of the flow.
  double EdgeDrop(double conductance, double flow) const;
  bool acts_on_edges() const { return return_line != 0 || laminar_edge != 0 || check_valve != 0; }
  bool leaks() const { return relief_square != 0 || zone_leakage != 0 || supply_leakage != 0; }
};

/// What moves within a log.
class PlantMoments {
 public:
  /// `seconds`: length of the log; `seed` draws the strokes of intermittent faults.
  PlantMoments(const std::vector<Imperfection>& list, double seconds, std::uint64_t seed);

  struct Moment {
    double K_factor = 1, V0_factor = 1, gain = 1;  ///< 1, of K, V0 and Q_vn
    double y_0_shift = 0;                          ///< 1
    double leakage = 0;                            ///< m^3/(s Pa), times p_A - p_B
    bool effects_on = true;
  };
  /// At time `t`, s, with the oil at `temperature`, K, while stroke number `stroke` is on or has been.
  Moment At(double t, double temperature, std::int64_t stroke) const;
  /// Flow of the ripple out of chamber A, m^3/s.
  double Ripple(double t) const;
  bool ripples() const;
  /// The largest leakage that may come, m^3/(s Pa): the integration step is chosen for it.
  double most_leakage() const;

 private:
  bool Chosen(double share, std::int64_t stroke) const;

  std::vector<Imperfection> list_;
  double seconds_;
  std::uint64_t seed_;
};

PlantLaws PlantLawsOf(const std::vector<Imperfection>& list);

}  // namespace hydroscope
