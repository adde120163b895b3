#pragma once

#include <span>
#include <vector>

#include "core/told.h"
#include "estimation/episode.h"
#include "models/state_model.h"

namespace hydroscope {

/// That they are told of no healthy log and of each reversed signal holds diagnosis/states/other_causes/reversed_signal_test.cc.
struct ReversedSignalOptions {
  int least_window = 16;   ///< rows of the shortest windows that tied signals are compared over
  int least_windows = 20;  ///< so many at least: chance hardly makes them go together as much as `together`
  /// Correlation over windows beyond which no noise hides which way round signals count.
  double together = 0.9;
  int rows = 400;     ///< that a model is fitted to, from where its outputs move on
  double moves = 10;  ///< of an output's white noise: so far it is from where it began
  /// Rms error over the white noise of the outputs as the log is, below which no sign is tried, ...
  double astray = 2.5;
  double follows = 3;  ///< ... with one signal reversed at most so much, ...
  double left = 0.15;  ///< ... and of what the log as it is has beyond 1 at most this share
  /// Of what the log as it is leaves of a balance: with one signal reversed at most so much of one of them, ...
  double balance = 0.3;
  double other_balances = 1.2;  ///< ... and of none of the others more than so much
  /// Of its largest reading, that a signal reaches on the other side of 0 to be tried at all.
  double least_side = 0.05;
};

/// Two outputs that time alone ties, whatever the parameters: `rate` is the `order`-th derivative of `of`, signals of the machine.
struct TiedSignals {
  int of = 0, rate = 0, order = 1;

  bool operator==(const TiedSignals&) const = default;
};
/// Outputs that are a state, with outputs that are its rate or the rate of that.
std::vector<TiedSignals> TiedSignalsOf(const StateModel& model);

/// That a signal counts the other way round than the machine file says, a sentence; "" if none is seen to:
///   - of tied signals what one is weighted with over windows goes against what the other is with the derivative of the weight
///     (modulating functions, Shinbrot 1957), in windows of every length that show it;
///   - the balances of a machine's linear form close far better with one signal reversed, where parameters are out of their ranges
///     as it is;
///   - of other models a fit to the first rows that move goes astray, and with one signal reversed it follows.
/// A fit of the whole log with such a signal takes long to end nowhere.
Told ReversedSignalIn(const Machine& machine, std::span<const Episode> episodes,
                      const ReversedSignalOptions& options = {});

}  // namespace hydroscope
