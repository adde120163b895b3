#pragma once

#include <limits>
#include <span>
#include <vector>

namespace hydroscope::drift {

/// What an operating class adds to the reference of one quantity. A model that misses something small answers
/// each kind of stroke with its own small offset.
struct ClassOffset {
  double offset = 0;   ///< SI
  double std = 0;      ///< SI, of the offset
  double scatter = 1;  ///< variance of a stroke's deviation over what its information promises, neighbours'
                       ///< correlation included
};

/// One stroke's deviation of one quantity from the curves, SI, and its information, 1/SI^2 in units of the
/// equations' noise variance.
struct ClassDeviation {
  double value = 0, information = 0;
};

/// Median weighted by information, its std and the strokes' scatter about it. `scatter`, if above zero, is
/// that of all classes together, for classes with too few strokes for one of their own.
ClassOffset MeasureOffset(std::span<const ClassDeviation> strokes, double scatter = 0);

/// Variance of standardised deviations, in their order: the larger of single strokes and of blocks of ten
/// neighbours, so that correlation between strokes counts; single bad strokes are clipped.
double Scatter(const std::vector<double>& standardised);

/// How offsets differ from class to class: the prior of a class that has shown few strokes, or none.
struct OffsetSpread {
  double mean = 0, mean_std = 0;  ///< SI
  double std = 0;                 ///< SI, between classes; infinite if fewer than two were measured
};

/// Random-effects mean (DerSimonian and Laird 1986) and an upper limit of the variance between classes: that
/// at which the offsets would scatter as little as they do in one case of ten (Viechtbauer 2007, Q-profile).
OffsetSpread SpreadOf(std::span<const ClassOffset> classes);

/// Oil temperatures, K, that strokes were seen at.
struct TemperatureRange {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();

  void Take(double temperature);
  /// The temperature itself inside, else the edge it lies beyond; itself where either is not known.
  double Nearest(double temperature) const;
};

/// A measured offset and the prior combined (empirical Bayes).
ClassOffset Combine(const ClassOffset& measured, const OffsetSpread& prior);

}  // namespace hydroscope::drift
