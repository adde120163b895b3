#include "estimation/closed_loop/cross_spectra.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/constants.h"
#include "core/told_error.h"
#include "estimation/frequency_response/segment_transform.h"

namespace hydroscope {
namespace {

using Complex = std::complex<double>;

constexpr int kFewestLoopSegments = 8;
constexpr int kMostLoopBlocks = 32;  // a variance from as many is known to a quarter
constexpr std::size_t kShortestLoopSegment = 64;
constexpr std::size_t kFirstBin = 2;       // those of mean and trend are left out
constexpr double kHighestOfNyquist = 0.8;  // beyond, filters of converters act
// Coherence of set point and input: below, most of the input is not ours.
constexpr double kLeastOfInput = 0.5;

/// Rows of a run that have a difference to the row before.
std::size_t UsableRows(const SignalRun& run) { return run.input.empty() ? 0 : run.input.size() - 1; }

int SegmentsOf(const FrequencyRecord& record, std::size_t length) {
  int segments = 0;
  for (const SignalRun& run : record.runs)
    if (UsableRows(run) >= length)
      segments += 1 + static_cast<int>((UsableRows(run) - length) / (length / 2));
  return segments;
}

/// Adds every segment of the record to its block.
void SumSegments(const FrequencyRecord& record, const LoopSpectraOptions& options, LoopSpectra& spectra) {
  const auto reaches = [&](double input) {
    return std::clamp(input, -options.limit, options.limit) -
           std::clamp(input, -options.dead_band, options.dead_band);
  };
  const std::size_t length = spectra.segment_length;
  SegmentTransform transform(length);
  int segment = 0;
  for (const SignalRun& run : record.runs) {
    for (std::size_t start = 1; start + length <= run.input.size(); start += length / 2) {
      const auto block = static_cast<std::size_t>(segment++) * spectra.blocks.size() /
                         static_cast<std::size_t>(spectra.segments);
      const std::vector<Complex> r = transform([&](std::size_t n) { return run.set_point[start + n]; });
      const std::vector<Complex> u = transform([&](std::size_t n) { return reaches(run.input[start + n]); });
      const std::vector<Complex>& y =
          transform([&](std::size_t n) { return run.output[start + n] - run.output[start + n - 1]; });
      for (std::size_t bin = 0; bin < y.size(); ++bin) {
        spectra.blocks[block][bin] +=
            {std::norm(r[bin]),          std::norm(u[bin]),          std::norm(y[bin]),
             std::conj(r[bin]) * u[bin], std::conj(r[bin]) * y[bin], std::conj(u[bin]) * y[bin]};
      }
    }
  }
}

}  // namespace

LoopSums& LoopSums::operator+=(const LoopSums& other) {
  rr += other.rr;
  uu += other.uu;
  yy += other.yy;
  ru += other.ru;
  ry += other.ry;
  uy += other.uy;
  return *this;
}

double LoopSums::Residual(Complex g) const {
  return std::max(0.0, yy - 2 * (std::conj(g) * uy).real() + std::norm(g) * uu);
}
double LoopSums::CoherenceOfInput() const { return rr > 0 && uu > 0 ? std::norm(ru) / (rr * uu) : 0; }
double LoopSums::CoherenceOfOutput() const { return rr > 0 && yy > 0 ? std::norm(ry) / (rr * yy) : 0; }

double LoopSpectra::Frequency(std::size_t bin) const {
  return static_cast<double>(bin) / (static_cast<double>(segment_length) * sample_period);
}
Complex LoopSpectra::Difference(double frequency) const {
  return 1.0 - std::polar(1.0, -kTwoPi * frequency * sample_period);
}

Result<LoopSpectra> AverageLoopSpectra(const FrequencyRecord& record, const LoopSpectraOptions& options) {
  std::size_t longest = 0;
  for (const SignalRun& run : record.runs) {
    if (run.set_point.size() != run.input.size() || run.output.size() != run.input.size())
      return InternalError("set point, input and output differ in length");
    longest = std::max(longest, UsableRows(run));
  }
  LoopSpectra spectra;
  spectra.sample_period = record.sample_period;
  const auto within = static_cast<std::size_t>(options.segment / record.sample_period);
  const std::size_t most = std::max(kShortestLoopSegment, 2 * longest / (kFewestLoopSegments + 1));
  spectra.segment_length = options.segment_length > 0
                               ? options.segment_length
                               : std::bit_floor(std::min(std::max<std::size_t>(within, 1), most));
  spectra.segments = SegmentsOf(record, spectra.segment_length);
  if (spectra.segments < kFewestLoopSegments || spectra.segment_length < kShortestLoopSegment) {
    return BadInput(Tell(
        "the record is too short for averaged spectra: {} segments of {} samples without a gap, at least {} of {} are "
        "needed; record longer{}",
        "die Aufzeichnung ist zu kurz für gemittelte Spektren: {} Abschnitte von {} Zeilen ohne Lücke, mindestens {} von {} "
        "sind nötig; länger aufzeichnen{}",
        spectra.segments, spectra.segment_length, kFewestLoopSegments, kShortestLoopSegment,
        options.segment_length > 0 ? Told(" or give a shorter --segment", " oder --segment kürzer wählen")
                                   : Told()));
  }
  const auto blocks = static_cast<std::size_t>(std::min(kMostLoopBlocks, spectra.segments / 2));
  const std::size_t bins = spectra.segment_length / 2 + 1;
  spectra.blocks.assign(blocks, std::vector<LoopSums>(bins));
  SumSegments(record, options, spectra);
  spectra.bins.resize(bins);
  for (const std::vector<LoopSums>& block : spectra.blocks)
    for (std::size_t bin = 0; bin < bins; ++bin) spectra.bins[bin] += block[bin];
  return spectra;
}

std::vector<std::size_t> BinsOfSetPoint(const LoopSpectra& spectra, double lowest, double highest) {
  std::vector<std::size_t> bins;
  const double end = std::min(highest, kHighestOfNyquist / (2 * spectra.sample_period));
  for (std::size_t bin = kFirstBin; bin < spectra.bins.size() && spectra.Frequency(bin) <= end; ++bin)
    if (spectra.Frequency(bin) >= lowest && spectra.bins[bin].CoherenceOfInput() >= kLeastOfInput)
      bins.push_back(bin);
  return bins;
}

}  // namespace hydroscope
