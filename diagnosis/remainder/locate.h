#pragma once

#include <string>
#include <vector>

#include "diagnosis/remainder/residuals.h"
#include "estimation/floor_trust.h"

namespace hydroscope {

/// What a located error is. `p_floor` is a chance, the rest keeps bins from speaking that hold too little: simulated errors are located,
/// noise alone in a hundred logs is not (diagnosis/remainder/locate_test.cc).
struct LocateOptions {
  int bins = 8;       ///< of equally many windows, one-signal maps
  int pair_bins = 5;  ///< per signal, two-signal maps
  /// Chance of calling any bin of sensor noise alone an error (Bonferroni over all bins).
  double p_floor = 0.01;
  double floor_excess = kFloorExcess;
  /// located: model error energy over that of the rest of the map, whichever stroke is left out.
  double above_rest = 1.5;
  double overlap = 4;       ///< windows that share noise: 2 half windows of WindowSamples, in blocks
  double min_windows = 30;  ///< fewer windows or ...
  int min_strokes = 3;      ///< ... fewer strokes in a bin say nothing
};

/// Model error in one cell of a map. Bands are clustered by stroke.
struct MapCell {
  std::vector<double> from, to;  ///< per signal, SI
  double windows = 0;
  int strokes = 0;    ///< with windows in the cell
  double noise = 0;   ///< output unit squared, mean squared error that sensor noise causes
  double excess = 0;  ///< output unit squared, mean squared error less what sensor noise causes
  double excess_std = 0;
  double mean = 0, mean_std = 0;  ///< output unit, mean of measured - modelled and its standard error
  bool above_floor = false;       ///< significantly more than sensor noise
};

/// The model error over one or two signals.
struct ErrorMap {
  std::vector<int> signals;  ///< indices into Residuals::signals
  std::vector<MapCell> cells;
  /// Share of the model error's energy that the map's cell means predict on strokes left out, at most 1; 0 or
  /// below: the error does not follow these signals.
  double explained = 0;
};

/// A range in which the model errs more than elsewhere, in units as shown.
struct Located {
  std::string signal;
  double from = 0, to = 0;
  std::string unit;
  double rms = 0;          ///< output unit, model error in the range, sensor noise taken out
  double mean = 0;         ///< output unit, mean of measured - modelled
  double share_error = 0;  ///< share of the model error's energy in the range
  double share_windows = 0;
};

struct ErrorLocation {
  double excess = 0;      ///< output unit squared, mean model error energy, sensor noise taken out
  double excess_std = 0;  ///< clustered by stroke
  std::vector<ErrorMap> single, pairs;  ///< best explained first
  std::vector<Located> located;         ///< most of the error in least of the data first; empty: a flat map
};

/// Where in the operating space the error lives. Bins are quantiles. A bin is above the floor if its excess
/// is more than Gaussian sensor noise of known variance gives, and more than floor_excess. It is located if
/// it also errs above_rest times as much as the rest of the map, and still does when any one stroke is left
/// out; neighbours are merged.
ErrorLocation Locate(const Residuals& residuals, const LocateOptions& options = {});

}  // namespace hydroscope
