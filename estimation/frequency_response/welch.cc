#include "estimation/frequency_response/welch.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>

#include "core/told_error.h"
#include "estimation/frequency_response/segment_transform.h"

namespace hydroscope {
namespace {

using Complex = std::complex<double>;
// Independent averages per segment with a Hann window and half overlap: 1 / (1 + 2/36).
constexpr double kIndependentShare = 1 / (1 + 2.0 / 36);
constexpr std::size_t kShortest = 32;
constexpr int kFewestSegments = 4;
// Of the typical amplitude of the command. A chirp of a servo press whose card adds
// noise has 0.3 to 1 % beside its band (`hydroscope frf chirp_0A.txt --segment 16384`), 10 % at its edge.
constexpr double kLeastAmplitude = 0.02;

/// Half spectra of all segments, one after the other.
struct SegmentSpectra {
  std::size_t bins = 0;  // of one segment
  int segments = 0;
  std::vector<Complex> input, output;

  std::span<const Complex> Input(int segment) const { return Segment(input, segment); }
  std::span<const Complex> Output(int segment) const { return Segment(output, segment); }

 private:
  std::span<const Complex> Segment(const std::vector<Complex>& all, int segment) const {
    return std::span(all).subspan(static_cast<std::size_t>(segment) * bins, bins);
  }
};

SegmentSpectra Transform(const FrequencyRecord& record, std::size_t length) {
  SegmentSpectra spectra;
  spectra.bins = length / 2 + 1;
  for (const SignalRun& run : record.runs) {
    if (run.input.size() < length) continue;
    spectra.segments += 1 + static_cast<int>((run.input.size() - length) / (length / 2));
  }
  spectra.input.resize(static_cast<std::size_t>(spectra.segments) * spectra.bins);
  spectra.output.resize(spectra.input.size());

  SegmentTransform transform(length);
  std::size_t place = 0;
  const auto put = [&](const std::vector<double>& signal, std::size_t start,
                       std::vector<Complex>& spectra_of) {
    std::ranges::copy(transform([&](std::size_t n) { return signal[start + n]; }),
                      spectra_of.begin() + place);
  };
  for (const SignalRun& run : record.runs)
    for (std::size_t start = 0; start + length <= run.input.size(); start += length / 2) {
      put(run.input, start, spectra.input);
      put(run.output, start, spectra.output);
      place += spectra.bins;
    }
  return spectra;
}

/// Sums over the segments, bin by bin.
struct BinSums {
  double uu = 0, yy = 0;
  Complex uy = 0;
  double consistent = 0;  // sum of |U|^2 |Y - H U|^2 / (1 - leverage)
  double fourth = 0;      // sum of squared leverages
};

std::vector<BinSums> SumOverSegments(const SegmentSpectra& spectra) {
  std::vector<BinSums> sums(spectra.bins);
  for (int s = 0; s < spectra.segments; ++s) {
    const std::span<const Complex> u = spectra.Input(s), y = spectra.Output(s);
    for (std::size_t bin = 0; bin < spectra.bins; ++bin) {
      sums[bin].uu += std::norm(u[bin]);
      sums[bin].yy += std::norm(y[bin]);
      sums[bin].uy += std::conj(u[bin]) * y[bin];
    }
  }
  for (int s = 0; s < spectra.segments; ++s) {
    const std::span<const Complex> u = spectra.Input(s), y = spectra.Output(s);
    for (std::size_t bin = 0; bin < spectra.bins; ++bin) {
      BinSums& sum = sums[bin];
      if (!(sum.uu > 0)) continue;
      const double power = std::norm(u[bin]), leverage = power / sum.uu;
      const double residual = std::norm(y[bin] - sum.uy / sum.uu * u[bin]);
      sum.consistent += power * residual / std::max(1 - leverage, 0.1);
      sum.fourth += leverage * leverage;
    }
  }
  return sums;
}

/// H1, coherence and variance of one bin.
FrequencyPoint EvaluateBin(const BinSums& sums, int segments) {
  FrequencyPoint point;
  point.coherence = sums.uu > 0 && sums.yy > 0 ? std::norm(sums.uy) / (sums.uu * sums.yy) : 0;
  point.reason = PointReason::kLowCoherence;
  if (!(point.coherence > 0)) return point;
  point.response = sums.uy / sums.uu;
  const double averages = std::max(2.0, segments * kIndependentShare);
  const double stationary =
      std::norm(point.response) * (1 - point.coherence) / (2 * (averages - 1) * point.coherence);
  const double consistent = sums.consistent / (2 * sums.uu * sums.uu * kIndependentShare);
  point.variance = std::max({stationary, consistent, 1e-12 * std::norm(point.response)});
  point.periods = averages;
  point.dof = std::clamp(2 / sums.fourth - 2, 1.0, 2 * (averages - 1));
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

/// Coherence that two unrelated signals exceed at any of `bins` frequencies in one of a hundred cases.
double ChanceCoherence(double averages, std::size_t bins) {
  constexpr double kChance = 0.01;
  return 1 - std::pow(kChance / static_cast<double>(bins), 1 / std::max(1.0, averages - 1));
}

/// The amplitude of the command above and below which the coherent frequencies have as much of it. Many frequencies
/// of next to none, beside the band of a chirp, do not count.
double TypicalAmplitude(const std::vector<FrequencyPoint>& points) {
  std::vector<double> amplitudes;
  for (const FrequencyPoint& p : points) {
    if (p.reason == PointReason::kUsed) amplitudes.push_back(p.amplitude);
  }
  std::ranges::sort(amplitudes);
  double above = std::accumulate(amplitudes.begin(), amplitudes.end(), 0.0) / 2;
  for (const double amplitude : amplitudes) {
    above -= amplitude;
    if (above <= 0) return amplitude;
  }
  return 0;
}

/// Coherent points at which the command has hardly any power are accidents, or a disturbance that both channels share.
void LeaveOutPowerless(std::vector<FrequencyPoint>& points) {
  const double least = kLeastAmplitude * TypicalAmplitude(points);
  for (FrequencyPoint& p : points) {
    if (p.reason == PointReason::kUsed && p.amplitude < least) p.reason = PointReason::kNoPower;
  }
}

}  // namespace

Result<WelchSpectra> EstimateByWelch(const FrequencyRecord& record, const FrequencyResponseOptions& options) {
  std::size_t longest = 0;
  for (const SignalRun& run : record.runs) longest = std::max(longest, run.input.size());
  WelchSpectra spectra;
  spectra.segment_length = options.segment_length > 0 ? options.segment_length : std::bit_floor(longest / 8);
  if (spectra.segment_length < kShortest || spectra.segment_length > longest) {
    const Told of_one = options.segment_length > 0 ? Told(" for one segment (give a shorter --segment)",
                                                          " für ein Segment (kürzere wählen, --segment)")
                                                   : Told();
    return BadInput(Tell(
        "the record is too short for averaged spectra: its longest stretch without a gap has {} samples, {} "
        "are needed{}; record longer",
        "die Aufzeichnung ist zu kurz für gemittelte Spektren: ihre längste Strecke ohne Lücke hat {} Werte, nötig sind {}{}; "
        "länger aufzeichnen",
        longest, options.segment_length > 0 ? options.segment_length : 8 * kShortest, of_one));
  }
  const SegmentSpectra segments = Transform(record, spectra.segment_length);
  spectra.segments = segments.segments;
  if (spectra.segments < kFewestSegments) {
    return BadInput(Tell(
        "only {} segments of {} samples fit into the record, at least {} are needed to judge coherence; "
        "record longer or give a shorter --segment",
        "nur {} Segmente von {} Werten passen in die Aufzeichnung, um die Kohärenz zu beurteilen, sind mindestens {} nötig; länger "
        "aufzeichnen oder kürzere Segmente wählen (--segment)",
        spectra.segments, spectra.segment_length, kFewestSegments));
  }
  const double length = static_cast<double>(spectra.segment_length);
  const double averages = spectra.segments * kIndependentShare;
  const double limit = std::max(options.min_coherence, ChanceCoherence(averages, segments.bins));
  const std::vector<BinSums> sums = SumOverSegments(segments);
  for (std::size_t bin = 2; bin < spectra.segment_length / 2; ++bin) {
    FrequencyPoint point = EvaluateBin(sums[bin], spectra.segments);
    point.frequency = static_cast<double>(bin) / (length * record.sample_period);
    // Mean square in the window's noise bandwidth (1.5 bins): sum w = n/2.
    const double scale = 2 / (length * length / 4) / spectra.segments;
    point.amplitude = std::sqrt(sums[bin].uu * scale);
    point.output_amplitude = std::sqrt(sums[bin].yy * scale);
    point.begin = record.runs.front().start;
    point.end = record.runs.back().start +
                static_cast<double>(record.runs.back().input.size()) * record.sample_period;
    if (point.coherence >= limit) point.reason = PointReason::kUsed;
    spectra.points.push_back(point);
  }
  LeaveOutPowerless(spectra.points);
  LeaveOutOfRange(spectra.points, options);
  SmoothNoise(spectra.points);
  return spectra;
}

}  // namespace hydroscope
