#include "estimation/frequency_response_welch.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace hydroscope {
namespace {

using Complex = std::complex<double>;
// Independent averages per segment with a Hann window and half overlap: 1 / (1 + 2/36).
constexpr double kIndependentShare = 1 / (1 + 2.0 / 36);
constexpr std::size_t kShortest = 32;
constexpr int kFewestSegments = 4;

std::vector<double> HannWindow(std::size_t length) {
  std::vector<double> window(length);
  for (std::size_t n = 0; n < length; ++n) {
    window[n] =
        0.5 - 0.5 * std::cos(2 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(length));
  }
  return window;
}

/// Half spectrum of one segment, its mean taken off, windowed.
std::vector<Complex> SegmentSpectrum(Eigen::FFT<double>& fft, const double* first,
                                     const std::vector<double>& window) {
  double mean = 0;
  for (std::size_t n = 0; n < window.size(); ++n) mean += first[n];
  mean /= static_cast<double>(window.size());
  std::vector<double> windowed(window.size());
  for (std::size_t n = 0; n < window.size(); ++n) windowed[n] = (first[n] - mean) * window[n];
  std::vector<Complex> spectrum;
  fft.fwd(spectrum, windowed);
  return spectrum;
}

struct SegmentPair {
  std::vector<Complex> input, output;
};

std::vector<SegmentPair> AllSegments(const FrequencyRecord& record, std::size_t length) {
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  const std::vector<double> window = HannWindow(length);
  std::vector<SegmentPair> segments;
  for (const SignalRun& run : record.runs) {
    for (std::size_t start = 0; start + length <= run.input.size(); start += length / 2) {
      segments.push_back({SegmentSpectrum(fft, run.input.data() + start, window),
                          SegmentSpectrum(fft, run.output.data() + start, window)});
    }
  }
  return segments;
}

/// H1, coherence and variance of one bin.
FrequencyPoint EvaluateBin(const std::vector<SegmentPair>& segments, std::size_t bin) {
  double uu = 0, yy = 0;
  Complex uy = 0;
  for (const SegmentPair& s : segments) {
    uu += std::norm(s.input[bin]);
    yy += std::norm(s.output[bin]);
    uy += std::conj(s.input[bin]) * s.output[bin];
  }
  FrequencyPoint point;
  point.coherence = uu > 0 && yy > 0 ? std::norm(uy) / (uu * yy) : 0;
  point.reason = PointReason::kLowCoherence;
  if (!(point.coherence > 0)) return point;
  point.response = uy / uu;
  const double averages = std::max(2.0, static_cast<double>(segments.size()) * kIndependentShare);
  const double stationary =
      std::norm(point.response) * (1 - point.coherence) / (2 * (averages - 1) * point.coherence);
  double consistent = 0, fourth = 0;
  for (const SegmentPair& s : segments) {
    const double leverage = std::norm(s.input[bin]) / uu;
    const double residual = std::norm(s.output[bin] - point.response * s.input[bin]);
    consistent += std::norm(s.input[bin]) * residual / std::max(1 - leverage, 0.1);
    fourth += leverage * leverage;
  }
  consistent /= 2 * uu * uu * kIndependentShare;
  point.variance = std::max({stationary, consistent, 1e-12 * std::norm(point.response)});
  point.periods = averages;
  point.dof = std::clamp(2 / fourth - 2, 1.0, 2 * (averages - 1));
  return point;
}

/// Noise spectra are smooth: averages each used bin's noise over its neighbours, which gives the variance the
/// degrees of freedom that a frequency passed once by a chirp lacks.
void SmoothNoise(std::vector<FrequencyPoint>& points) {
  constexpr std::ptrdiff_t kNeighbours = 4;
  const std::vector<FrequencyPoint> raw = points;
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    if (raw[i].reason != PointReason::kUsed) continue;
    double noise = 0, dof = 0;
    for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - kNeighbours);
         j <= std::min(count - 1, i + kNeighbours); ++j) {
      if (raw[j].reason != PointReason::kUsed) continue;
      noise += raw[j].dof * raw[j].variance * raw[j].amplitude * raw[j].amplitude;
      dof += raw[j].dof;
    }
    points[i].variance = noise / dof / (raw[i].amplitude * raw[i].amplitude);
    points[i].dof = std::max(raw[i].dof, dof / kHannCorrelation);
  }
}

/// Coherence that two unrelated signals exceed in one of a hundred cases.
double ChanceCoherence(double averages) { return 1 - std::pow(0.01, 1 / std::max(1.0, averages - 1)); }

}  // namespace

Result<WelchSpectra> EstimateByWelch(const FrequencyRecord& record, const FrequencyResponseOptions& options) {
  std::size_t longest = 0;
  for (const SignalRun& run : record.runs) longest = std::max(longest, run.input.size());
  WelchSpectra spectra;
  spectra.segment_length = options.segment_length > 0 ? options.segment_length : std::bit_floor(longest / 8);
  if (spectra.segment_length < kShortest || spectra.segment_length > longest) {
    return BadInput(
        "the record is too short for averaged spectra: its longest stretch without a gap has {} samples, {} "
        "are "
        "needed{}; record longer",
        longest, options.segment_length > 0 ? options.segment_length : 8 * kShortest,
        options.segment_length > 0 ? " for one segment (give a shorter --segment)" : "");
  }
  const std::vector<SegmentPair> segments = AllSegments(record, spectra.segment_length);
  spectra.segments = static_cast<int>(segments.size());
  if (spectra.segments < kFewestSegments) {
    return BadInput(
        "only {} segments of {} samples fit into the record, at least {} are needed to judge coherence; "
        "record longer or give a shorter --segment",
        spectra.segments, spectra.segment_length, kFewestSegments);
  }
  const double length = static_cast<double>(spectra.segment_length);
  const double averages = spectra.segments * kIndependentShare;
  const double limit = std::max(options.min_coherence, ChanceCoherence(averages));
  for (std::size_t bin = 2; bin < spectra.segment_length / 2; ++bin) {
    FrequencyPoint point = EvaluateBin(segments, bin);
    point.frequency = static_cast<double>(bin) / (length * record.sample_period);
    double power = 0, response_power = 0;
    for (const SegmentPair& s : segments) {
      power += std::norm(s.input[bin]);
      response_power += std::norm(s.output[bin]);
    }
    // Mean square in the window's noise bandwidth (1.5 bins): sum w = n/2.
    const double scale = 2 / (length * length / 4) / spectra.segments;
    point.amplitude = std::sqrt(power * scale);
    point.output_amplitude = std::sqrt(response_power * scale);
    point.begin = record.runs.front().start;
    point.end = record.runs.back().start +
                static_cast<double>(record.runs.back().input.size()) * record.sample_period;
    point.reason = point.coherence >= limit ? PointReason::kUsed : PointReason::kLowCoherence;
    spectra.points.push_back(point);
  }
  SmoothNoise(spectra.points);
  return spectra;
}

}  // namespace hydroscope
