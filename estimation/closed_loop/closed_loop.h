#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "estimation/closed_loop/input_limit.h"
#include "estimation/closed_loop/transfer_fit.h"
#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {

/// How far the direct ratio of output to input lies beside the ratio of cross spectra, mean over an octave.
struct DirectBias {
  double lowest = 0, highest = 0;  ///< Hz
  double gain = 0;                 ///< relative
};

struct LoopOptions {
  std::size_t segment_length = 0;  ///< samples; 0: two seconds
  double min_coherence = 0.8;  ///< of set point and output, from which a point is shown; the fit weighs all
  double lowest = 0;           ///< Hz
  double highest = std::numeric_limits<double>::infinity();

  /// SI, as ClosedLoopPlant::parameters, NaN where nothing is known: of poles that can be shared out in several ways those
  /// nearest to it are taken. Empty: nothing is known.
  std::vector<double> known = {};

  Status Validate() const;
};

/// A plant in closed loop: its frequency response and the parameters of its transfer function. With an input limit the rest is
/// measured with the input cut off there; with a dead band figures are those of a plant without one, at this excitation.
struct LoopResponse : InputRange {
  std::vector<FrequencyPoint> points;        ///< P_ry/P_ru; in order of frequency
  std::vector<std::complex<double>> direct;  ///< P_uy/P_uu beside each point
  std::optional<DirectBias> direct_bias;     ///< where it is largest; nothing: too few points
  std::optional<TransferFit> fit;            ///< absent: `no_fit` says why
  Told no_fit;
  std::vector<ValueWithStd> parameters;  ///< SI, as ClosedLoopPlant::parameters; empty without fit
  std::size_t segment_length = 0;
  int segments = 0;
  double seconds = 0;         ///< of the record
  double seconds_needed = 0;  ///< of such a record for LoopParameter::wanted of all, in 99 of 100 records
  std::string needed_for;     ///< the parameter that needs the longest
  std::vector<Told> warnings;
};

/// Measures and fits. Error (kBadInput): no set point, nothing that moves, too short, set point and input not related.
Result<LoopResponse> MeasureClosedLoop(const FrequencyRecord& record, const TransferModel& model,
                                       const LoopOptions& options = {});

}  // namespace hydroscope
