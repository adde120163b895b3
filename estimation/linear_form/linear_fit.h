#pragma once

#include "estimation/linear_form/base_parameters.h"
#include "estimation/linear_form/window_equations.h"

namespace hydroscope {

struct LinearFitOptions {
  int pieces = 40;      ///< of the record, left out in turn for the intervals
  int rounds = 4;       ///< of least squares, each with the equations' noise of the one before
  int noise_pairs = 2;  ///< of noisier copies that tell what noise in the regressors does (noisier_copies.h)
  std::uint32_t seed = 1;  ///< of their noise
  WindowEquationOptions windows;
};

/// A linear form fitted to a record: all equations at once, each over its own noise.
struct LinearFit {
  std::string failed;                   ///< why there is no fit, a sentence; "" = there is one
  std::vector<std::string> parameters;  ///< those kept, of LinearForm::parameters
  Eigen::VectorXd value;                ///< SI
  /// SI, of which 1.96 is the 95 % interval: by leaving out pieces of the record (jackknife, Efron 1982).
  Eigen::VectorXd std;
  BaseParameterSet base;      ///< columns are LinearForm::parameters
  std::vector<double> noise;  ///< per equation: rms of what is left
  int windows = 0;

  bool solved() const { return failed.empty(); }
};
LinearFit FitLinearForm(const LinearForm& form, const Machine& machine, std::span<const Episode> episodes,
                        const LinearFitOptions& options = {});

/// What a kept parameter is the sum of, "mx_1 + 1.6 m_2"; alone: its name.
std::string BaseParameterText(const LinearForm& form, const BaseParameterSet& base, std::size_t kept);

}  // namespace hydroscope
