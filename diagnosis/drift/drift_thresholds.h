#pragma once

#include <cstddef>

namespace hydroscope::drift {

/// All thresholds of the drift watch; what counts as a drift of each quantity stands in the rules file instead. Calibrated by
/// `hydroscope benchmark drift` (false alarms on healthy machines, delay and cause of drifts) unless a source is named.
struct DriftThresholds {
  // Cumulative sums (Page 1954).
  double cusum = 20.0;         ///< log-likelihood: above e^20 strokes between false alarms (Lorden 1971)
  double clip = 4.0;           ///< standard deviations of one stroke: a single bad one adds 6 at most
  double largest_shift = 2.0;  ///< standard deviations the test looks for at most

  // What changed (change_analysis.h), log-likelihoods.
  double least_gain = 12.0;      ///< a further quantity must add so much ...
  double least_share = 0.10;     ///< ... also as a share of the first one's
  double rival_share = 0.003;    ///< a rival explains the same up to this share, or up to ...
  double rival_gain = 6.0;       ///< ... so much: odds of 400 to one
  double most_inflation = 20.0;  ///< of a size's variance by the others: beyond, they cannot be told apart
  int least_to_explain = 6;      ///< strokes after a change before it is explained
  int most_to_explain = 60;      ///< strokes after which it is told undecided

  // Open findings.
  double memory = 0.95;     ///< of sizes of open findings: some 20 strokes
  double gone_share = 0.5;  ///< of the smallest drift: below it a finding is going
  int newest = 5;           ///< strokes whose mean says whether a size followed is behind
  double behind = 3.0;      ///< standard errors of that mean from which on it is

  // Slow trends (slow_trend.h).
  double slope = 5.0;              ///< standard deviations of a slope that is one
  int block_strokes = 500;         ///< judged strokes whose mean is one point of the line
  std::size_t blocks = 90;         ///< points kept
  std::size_t least_blocks = 12;   ///< points a line needs
  double most_correlation = 0.95;  ///< of neighbouring points that a slope's deviation is widened by

  // Reference and operating classes.
  int least_strokes = 100;       ///< of commissioning
  int least_class_strokes = 30;  ///< for a scatter of its own
  int least_offset_strokes = 5;  ///< for an offset of its own
  int least_classes = 5;         ///< for judging strokes between the classes
  double class_radius = 0.25;    ///< distance in logarithms: some 25 % in speed, mean or highest pressure
  double unlikely_offset = 0.1;  ///< chance of class offsets that are none
  double least_oil_range = 4.0;  ///< K, below which only a constant is fitted over the oil temperature
  /// Relative, 1/K, of a quantity that depends on the oil where commissioning saw one temperature only: bulk modulus of
  /// mineral oils falls by some 0.5 %/K, valve flow follows the viscosity by less.
  double unknown_slope = 0.005;

  double valve_check = 4.0;        ///< standard deviations of a valve check beyond ...
  double valve_check_share = 0.5;  ///< ... so much of the smallest drift: half-way, as gone_share
};
inline constexpr DriftThresholds kDriftThresholds{};

}  // namespace hydroscope::drift
