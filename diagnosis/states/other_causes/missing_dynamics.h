#pragma once

#include <optional>
#include <span>

#include "core/told.h"
#include "diagnosis/states/remainder.h"

namespace hydroscope {

/// That it is found where it is and told of nowhere else hold diagnosis/states/other_causes/missing_dynamics_test.cc and
/// `hydroscope benchmark state-machines`.
struct MissingDynamicsOptions {
  int columns = 240;               ///< at most
  int frequencies = 8;             ///< of the filters, at most ...
  double slowest = 0.003;          ///< ... from so many cycles a row ...
  double fastest = 0.3;            ///< ... to so many
  double damping = 0.2;            ///< of those that swing
  double max_p = 0.01;             ///< beyond: chance
  double min_share = 0.1;          ///< of the error's energy: less is not worth a word
  double beyond_functions = 1.35;  ///< ... and of what functions of the present predict of it
  int feedback_rows = 8;           ///< past of inputs and errors by which feedback is looked for
  /// Share of what an input's past does not foresee that past errors do: it is controlled.
  double feedback = 0.03;
  StateRemainderOptions remainder;
};

/// Share of the energy of a fit's error, on pieces of the log left out, that the past of inputs and simulated states predicts where
/// functions of their present predict (`left`) nothing or far less: dynamics are missing (a lag, a further mode), or a sensor lags.
/// The past is what filters of the first and second order over a range of frequencies remember of them; errors that are noise are
/// independent of it (Ljung 1999, 16.6). Nothing if it is less than that of chance, or if past errors act on an input: noise would
/// come back by it.
std::optional<double> FindMissingDynamics(const StateFit& fit, const StateRemainder& left,
                                          std::span<const Episode> episodes,
                                          const MissingDynamicsOptions& options = {});

/// A sentence that says so.
Told MissingDynamicsText(double share);

}  // namespace hydroscope
