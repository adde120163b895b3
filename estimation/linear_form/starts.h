#pragma once

#include <optional>
#include <span>

#include "estimation/linear_form/linear_fit.h"
#include "estimation/states/fit.h"

namespace hydroscope {

/// Where a fit by simulation begins.
struct LinearStart {
  Machine machine;          ///< with the starts that the linear form of its kind gives, within their ranges
  StateFitOptions options;  ///< no further starts are drawn where it gives them
  std::optional<LinearFit> fit;  ///< nothing: the kind has no linear form
};
LinearStart StartOf(const Machine& machine, std::span<const Episode> episodes);

}  // namespace hydroscope
