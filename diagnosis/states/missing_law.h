#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

/// Of a curve that is shown; what it may claim, `min_share`, is asked for on pieces left out.
struct MissingLawOptions {
  int groups = 8;             ///< of neighbouring pieces, left out in turn
  double ridge = 1e-4;        ///< of the functions, each over its own size
  double min_share = 0.1;     ///< of the error's energy left out that one variable must predict
  int points = 25;            ///< of the curve
  double inner_share = 0.98;  ///< of the values seen: the curve ends there
};

/// What is missing in one equation of a model as a curve over one variable, SI.
struct MissingLaw {
  std::string equation;  ///< state or output to whose equation it adds
  bool of_state = true;
  std::string variable;  ///< state or input
  double share = 0;      ///< of the error's energy on pieces left out
  struct Point {
    double x = 0, value = 0, std = 0;  ///< std: from leaving out groups of pieces
  };
  std::vector<Point> points;
};

/// The curve a person may recognise: powers, a smooth sign and hinges of one variable are added to one equation, as terms whose
/// effect on the outputs is simulated with the fit's own tangent, and their weights found by ridge regression beside the
/// parameters, which stay free. Of the equation `about` (StateRemainder::about) the variable that predicts most of the error on
/// pieces left out. What the parameters can take over is not in it. nullopt: none predicts MissingLawOptions::min_share, or the
/// curve is nowhere clear of zero.
std::optional<MissingLaw> FindMissingLaw(const StateFit& fit, std::span<const Episode> episodes,
                                         const std::string& about, const MissingLawOptions& options = {});

}  // namespace hydroscope
