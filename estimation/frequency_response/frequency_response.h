#pragma once

#include <complex>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "core/records/valve_check.h"
#include "core/result.h"
#include "core/told.h"

namespace hydroscope {

/// Frequency response of a valve (or any single-input single-output system) from a log of its command and its
/// response, and the second-order model with dead time fitted to it (docs/frequency_response.md).
///
///   G(jw) = K_v exp(-jw T_dead) / (1 - (w/w0)^2 + 2 D j w/w0)
///
/// Stepped sines are evaluated by orthogonal correlation (Isermann and Muenchhof, Identification of Dynamic
/// Systems, 2011, sec. 4.3), broadband signals by averaged cross spectra (Welch, 1967; Bendat and Piersol,
/// Random Data, 4th ed. 2010, eq. 9.52 ff.). A command that is held from sample to sample is recognised by
/// its effect on the fit; any other delay between the sampling instants of the two channels appears as dead time.

enum class FrequencyResponseMethod {
  kAuto,   ///< stepped sine if held frequencies cover most of the excitation, else Welch
  kSine,   ///< stepped sines: orthogonal correlation per held frequency
  kWelch,  ///< chirp or noise: averaged cross spectra
};
/// "auto", "sine", "welch".
const char* MethodName(FrequencyResponseMethod method);

/// Why a measured point does or does not take part in the model fit.
enum class PointReason {
  kUsed,
  kTooShort,      ///< fewer than two whole periods are left after the transient
  kNoResponse,    ///< the response at this frequency does not stand out of its noise
  kLowCoherence,  ///< coherence below the limit: noise, nonlinearity or no excitation
  kClipped,       ///< command or response sits on a rail for a part of each period
  kNoPower,       ///< the command has hardly any power there: coherent by accident or by a disturbance
  kDisturbed,     ///< a weak command, and another law than elsewhere: a disturbance of both channels
  kOffTheOthers,  ///< far off the model that describes all others: a disturbance of the response at this frequency
  kOutsideRange,  ///< outside the range of frequencies asked for
};
/// Short machine name ("used", "too_short", ...).
const char* PointReasonName(PointReason reason);

/// One frequency of the response.
struct FrequencyPoint {
  double frequency = 0;           ///< Hz
  std::complex<double> response;  ///< output / input
  double phase = 0;               ///< rad, unwrapped over frequency
  double variance = 0;            ///< of real and of imaginary part, each
  double dof = 1;                 ///< degrees of freedom behind `variance`; infinity if well known
  double coherence = 1;           ///< 0...1 (stepped sine: share of the output's power that is the sine)
  double amplitude = 0;  ///< input amplitude U0 in input units (Welch: rms in the bin's noise bandwidth)
  double output_amplitude = 0;                                         ///< output units
  double input_distortion = std::numeric_limits<double>::quiet_NaN();  ///< harmonics 2 and 3 over the first
  /// NaN if above the Nyquist frequency.
  double output_distortion = std::numeric_limits<double>::quiet_NaN();
  double distortion_std = std::numeric_limits<double>::quiet_NaN();  ///< of output_distortion
  double begin = 0, end = 0;  ///< s, evaluated part of the log (Welch: the whole log)
  double periods = 0;         ///< evaluated whole periods, or effective number of averages
  double dropped = 0;         ///< s of transient left out before `begin`
  PointReason reason = PointReason::kUsed;

  double gain() const { return std::abs(response); }
  /// Standard deviation of the gain such that +-1.96 of it is the 95 % interval also with few degrees of freedom.
  double GainStd() const;
  /// The same of the phase, rad.
  double PhaseStd() const;
  /// Harmonic share of the response beyond that of the command; 0 where it does not stand out of its noise.
  double OwnDistortion() const;
};

/// Second-order model with dead time. SI.
struct ValveModel {
  ValueWithStd natural_frequency;  ///< f0, Hz
  ValueWithStd damping;            ///< D, 1
  ValueWithStd gain;               ///< K_v, output per input
  ValueWithStd dead_time;          ///< s; may come out slightly negative where the truth is zero
  ValueWithStd bandwidth;          ///< Hz, gain 3 dB (factor 1/sqrt 2) below K_v
  ValueWithStd phase_90;           ///< Hz, phase -90 degrees, dead time included
  ValueWithStd rise_time_90;  ///< s, step response first reaches 90 % of its final value, dead time included
  double chi_squared = 0;     ///< weighted sum of squares of the misfit; expected about `degrees_of_freedom`
  int degrees_of_freedom = 0;
  double inflation = 1;      ///< factor on all std because the misfit exceeds the noise (1: it does not)
  bool first_order = false;  ///< D ran to its limit of 5: only the corner frequency f0/(2 D) is determined
  double command_hold = 0;   ///< s the command is held between samples; 0: continuous. Part of Response(),
                             ///< not of the figures above
  double lowest = 0, highest = 0;  ///< Hz, range of the points used

  std::complex<double> Response(double frequency) const;
  /// rad, continuous over frequency (second-order part -180...0 degrees, then dead time).
  double Phase(double frequency) const;
};

/// Command and response without a gap, at equal steps.
struct SignalRun {
  double start = 0;           ///< s, time of the first sample
  std::vector<double> input;  ///< share of full command, or SI
  std::vector<double> output;
  std::vector<double> set_point = {};  ///< closed loop: what excites it from outside; else empty
};

struct FrequencyRecord {
  double sample_period = 0;     ///< s
  std::vector<SignalRun> runs;  ///< the log, cut at gaps
  bool shares = false;          ///< of full command and of the stroke: the gain of a valve is about 1
};

/// Whether segments and frequencies of `options` make sense; a segment has `least_segment` samples or more.
template <typename Options>
Status ValidateSpectra(const Options& options, std::size_t least_segment) {
  if (options.segment_length != 0 &&
      (options.segment_length < least_segment || options.segment_length % 2 != 0))
    return UsageError("segment length {} samples: an even number of at least {} is needed (0 chooses it)",
                      options.segment_length, least_segment);
  if (!(options.min_coherence > 0 && options.min_coherence < 1))
    return UsageError("minimum coherence {}: a number between 0 and 1 is needed", options.min_coherence);
  if (!(options.lowest >= 0 && options.highest > options.lowest))
    return UsageError("frequencies from {:g} to {:g} Hz: the second must be the larger one, both positive",
                      options.lowest, options.highest);
  return {};
}

struct FrequencyResponseOptions {
  FrequencyResponseMethod method = FrequencyResponseMethod::kAuto;
  /// Samples per Welch segment; 0: largest power of two with 8 in the record.
  std::size_t segment_length = 0;
  double min_coherence = 0.8;                                ///< points below take no part in the fit
  double lowest = 0;                                         ///< Hz, points below take no part in the fit
  double highest = std::numeric_limits<double>::infinity();  ///< Hz, nor do points above
  /// s left out at the start of every held frequency; NaN: found from the fitted model and the block scatter
  double settle_time = std::numeric_limits<double>::quiet_NaN();

  Status Validate() const;
};

struct FrequencyResponse {
  FrequencyResponseMethod method = FrequencyResponseMethod::kSine;  ///< the one that was used
  std::vector<FrequencyPoint> points;  ///< in order of frequency; `reason` says which take part in the fit
  std::optional<ValveModel> model;     ///< absent: `model_reason` says why
  Told model_reason;
  std::size_t segment_length = 0;  ///< Welch: samples per segment
  std::vector<Told> warnings;      ///< what the reader of the result should know, one sentence each
};

/// Marks points outside the range of frequencies asked for.
void LeaveOutOfRange(std::vector<FrequencyPoint>& points, const FrequencyResponseOptions& options);

/// Response and model. Bad input (too short, constant input, no steady frequency, no coherence, everything clipped) is
/// an error that says what was found and what to do; too few points for a model is not: see `model_reason`.
Result<FrequencyResponse> MeasureFrequencyResponse(const FrequencyRecord& record,
                                                   const FrequencyResponseOptions& options = {});

/// The record of a response that has a model; nullopt if it has none.
std::optional<ValveCheck> MakeValveCheck(const FrequencyResponse& response, double time,
                                         double supply_pressure, double oil_temperature);

/// Share of the fundamental above which harmonics of the response are told: a valve well inside its limits stays below.
inline constexpr double kNotableDistortion = 0.02;

/// Largest distortion of the response that exceeds that of the command and its own noise (4 std); 0 if none.
double WorstDistortion(const std::vector<FrequencyPoint>& points);

}  // namespace hydroscope
