#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/told.h"
#include "estimation/states/fit.h"

namespace hydroscope {

/// That it is found where it is and told of nowhere else hold diagnosis/states/other_causes/sampling_test.cc and
/// `hydroscope benchmark state-machines`.
struct SamplingOptions {
  int rows = 4000;      ///< that other ways are tried on
  int iterations = 10;  ///< of each fit ...
  /// ... and where what is left seems to be noise: differences are small there, and a fit that is not at its end covers them.
  int iterations_in_noise = 40;
  /// Rms error over that of what the file says, below which another way is told of where a law may be missing: any way takes
  /// something of that away.
  double less_error = 0.8;
  /// Where what is left seems to be noise, or is with another way, that is told of if it takes away as much as an effect must where
  /// nothing is predictable (SetComparison::Better), and this share of the energy: less is not worth a law either
  /// (StateRemainderOptions::min_share).
  double least_share = 0.03;
  double plainer =
      1.1;  ///< a way that leaves so much more than the best, but differs from the file in one thing, is taken
  /// Energy on pieces left out, of what the set of effects found leaves, up to which other effects are asked as well.
  double rivals = 2;
  /// Energy left over that before, foreseen by linearisation, above which no other age of the outputs is tried.
  double foreseen = 0.85;
  int late_steps = 6;           ///< of the search for that age
  double late_rows = 3;         ///< of it at most; more is a dead time of the machine
  double late_settled = 0.001;  ///< row; nearer it need not be known
  int threads = 1;  ///< that ways are tried on, 0: one per core (ThreadsOf); what is found is the same
};

/// Inputs seem to move between rows in another way than `[log] hold` says, or outputs of a row to be older or newer than they.
struct OtherSampling {
  InputHold hold = InputHold::kLinear;
  double late = 0;       ///< LogFormat::outputs_late
  double late_rows = 0;  ///< the same, in rows
  /// Rms of what is left with it, over that without; of several outputs the mean of squares.
  double error = 1;
  bool holds_otherwise = false, is_late = false;  ///< what differs from the file
};

/// Whether what a fit leaves seems to be noise, or a law may be missing in it.
enum class LeftBySampling { kNoise, kDoubt };

/// The way that leaves least, if it leaves clearly less than that of the machine file: the fit is repeated with each from where
/// it ended. What a wrong one leaves looks like a law that is missing, or hides one that is. How old outputs are is looked for only
/// where the file does not say it.
std::optional<OtherSampling> FindOtherSampling(const StateFit& fit, std::span<const Episode> episodes,
                                               LeftBySampling left, const SamplingOptions& options = {});

/// A sentence that says so.
Told OtherSamplingText(const OtherSampling& other);
/// The same where the other way was taken.
Told TakenSamplingText(const OtherSampling& taken);

}  // namespace hydroscope
