#pragma once

#include <span>
#include <string>
#include <vector>

#include "estimation/states/simulation.h"
#include "models/linear_form.h"
#include "models/machine.h"

namespace hydroscope {

struct WindowEquationOptions {
  /// s, a box of the window; four in a row weigh the record (a cubic B-spline), so that what is a rate is a difference of three
  /// boxes, and no signal is differenced from row to row. Well below the fastest motion asked for, well above a row.
  double box = 0.075;
  /// s, of the rates that enter as values: below it their noise turns dry friction about (a tanh of the speed), far above it
  /// they are late against pressures.
  double rate_half_width = 0.008;
};

/// A linear form over windows of a record: one row per window and equation.
struct WindowEquations {
  /// Per equation: rows x parameters of the form, and what is known.
  std::vector<Eigen::MatrixXd> regressor;
  std::vector<Eigen::VectorXd> known;
  std::vector<double> time;  ///< s, centre of each window
};

/// Rows with a signal that is no good reading (NaN) give no window. Texts were checked with the kind.
WindowEquations WindowsOf(const LinearForm& form, const Machine& machine, std::span<const Episode> episodes,
                          const WindowEquationOptions& options = {});

}  // namespace hydroscope
