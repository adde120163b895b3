#include "estimation/closed_loop/input_limit.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>

namespace hydroscope {
namespace {

constexpr double kSharesCutOff[] = {0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5};
// Gain in log likelihood. On records of healthy plants it stays below 4 (`hydroscope benchmark test-cylinder`).
constexpr double kLikelierThanNone = 15;
constexpr int kBitsOfLimit = 10;  // a limit to a thousandth is more than the data hold
constexpr double kSharesBelow[] = {0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5};
// Readings exactly at an end, and so many times those within a two-hundredth of it: the peaks of a sine have as many there.
constexpr std::size_t kFewestAtEnd = 30;
constexpr std::size_t kTimesNearEnd = 5;
constexpr double kNearEnd = 0.005;
// Coherence of set point and output at the bins that limit and dead band are sought in.
constexpr double kLeastOfLimit = 0.3;

/// Log likelihood of what is left, up to a constant.
double LikelihoodOf(const LoopSpectra& spectra, const std::vector<std::size_t>& used) {
  double sum = 0;
  for (const std::size_t bin : used) {
    const LoopSums& sums = spectra.bins[bin];
    sum -= std::log(std::max(sums.Residual(sums.Ratio()), 1e-12 * sums.yy));
  }
  return sum * spectra.segments * kIndependentShareOfSegment;
}

/// Likelihoods of a record over what of its input's magnitude reaches the plant.
class LikelihoodOver {
 public:
  /// `bound`: LoopSpectraOptions::limit or ::dead_band. All arguments must outlive it.
  LikelihoodOver(const FrequencyRecord& record, const LoopSpectraOptions& options, const LoopSpectra& spectra,
                 const std::vector<std::size_t>& used, double LoopSpectraOptions::*bound)
      : record_(record), options_(options), used_(used), bound_(bound) {
    options_.segment_length = spectra.segment_length;
    for (const SignalRun& run : record.runs)
      for (const double u : run.input) magnitudes_.push_back(std::abs(u));
    std::ranges::sort(magnitudes_);
  }

  double operator()(double at) const {
    LoopSpectraOptions bounded = options_;
    bounded.*bound_ = at;
    const auto spectra = AverageLoopSpectra(record_, bounded);
    return spectra ? LikelihoodOf(*spectra, used_) : -std::numeric_limits<double>::infinity();
  }
  /// The magnitude that a share of the rows is below.
  double MagnitudeAbove(double share) const {
    return magnitudes_[share * static_cast<double>(magnitudes_.size() - 1)];
  }
  double largest() const { return magnitudes_.back(); }

 private:
  const FrequencyRecord& record_;
  LoopSpectraOptions options_;
  const std::vector<std::size_t>& used_;
  double LoopSpectraOptions::*bound_;
  std::vector<double> magnitudes_;
};

/// Where the likelihood is largest between two magnitudes. They are searched as shares of the higher one: the search has an
/// absolute tolerance beside the relative one.
double Likeliest(const LikelihoodOver& likelihood, double low, double high) {
  return high * boost::math::tools::brent_find_minima([&](double share) { return -likelihood(share * high); },
                                                      low / high, 1.0, kBitsOfLimit)
                    .first;
}

}  // namespace

std::optional<double> FindInputLimit(const FrequencyRecord& record, const LoopSpectraOptions& options,
                                     const LoopSpectra& spectra, const std::vector<std::size_t>& used) {
  const LikelihoodOver likelihood(record, options, spectra, used, &LoopSpectraOptions::limit);
  std::vector<double> limits, values;
  for (const double share : kSharesCutOff) limits.push_back(likelihood.MagnitudeAbove(1 - share));
  for (const double limit : limits) values.push_back(likelihood(limit));
  const auto best = static_cast<std::size_t>(std::ranges::max_element(values) - values.begin());
  if (values[best] < LikelihoodOf(spectra, used) + kLikelierThanNone) return std::nullopt;
  return Likeliest(likelihood, limits[std::min(best + 1, limits.size() - 1)],
                   best == 0 ? likelihood.largest() : limits[best - 1]);
}

std::optional<double> FindDeadBand(const FrequencyRecord& record, const LoopSpectraOptions& options,
                                   const LoopSpectra& spectra, const std::vector<std::size_t>& used) {
  const LikelihoodOver likelihood(record, options, spectra, used, &LoopSpectraOptions::dead_band);
  std::vector<double> bands;
  for (const double share : kSharesBelow) bands.push_back(likelihood.MagnitudeAbove(share));
  double best = likelihood(bands.front());
  if (best < LikelihoodOf(spectra, used) + kLikelierThanNone)
    return std::nullopt;  // a part of the true one is likelier than none, too
  std::size_t at = 0;
  while (at + 1 < bands.size()) {
    const double next = likelihood(bands[at + 1]);
    if (next <= best) break;
    best = next;
    ++at;
  }
  return Likeliest(likelihood, at == 0 ? 0 : bands[at - 1], bands[std::min(at + 1, bands.size() - 1)]);
}

std::optional<double> FindEndOfReadings(const FrequencyRecord& record) {
  double end = 0;
  for (const SignalRun& run : record.runs)
    for (const double u : run.input) end = std::max(end, std::abs(u));
  std::size_t at = 0, near = 0;
  for (const SignalRun& run : record.runs)
    for (const double u : run.input) {
      at += std::abs(u) == end;
      near += std::abs(u) < end && std::abs(u) > (1 - kNearEnd) * end;
    }
  if (at < kFewestAtEnd || at < kTimesNearEnd * near) return std::nullopt;
  return end;
}

InputRange FindInputRange(const FrequencyRecord& record, const LoopSpectraOptions& options,
                          const LoopSpectra& spectra, const std::vector<std::size_t>& used) {
  InputRange range{.readings_end = FindEndOfReadings(record)};
  std::vector<std::size_t> loud;
  for (const std::size_t bin : used)
    if (spectra.bins[bin].CoherenceOfOutput() >= kLeastOfLimit) loud.push_back(bin);
  if (loud.empty()) return range;
  range.input_limit = FindInputLimit(record, options, spectra, loud);
  if (!range.readings_end && !range.input_limit)
    range.dead_band = FindDeadBand(record, options, spectra, loud);
  return range;
}

Told InputLimitText(const ClosedLoopPlant& plant, double limit) {
  return Tell("{} beyond {:.3g} {} does not reach the plant: {}; the rest is measured with it cut off there",
              "{} über {:.3g} {} erreicht die Strecke nicht: {}; der Rest ist damit abgeschnitten gemessen",
              plant.input, limit, plant.input_unit, plant.limit.sentence);
}

std::vector<Told> NonlinearInputTexts(const ClosedLoopPlant& plant, const InputRange& range) {
  std::vector<Told> texts;
  if (range.dead_band)
    texts.push_back(Tell(
        "small inputs move {} by a smaller share than large ones, as with a dead band of {:.2g} {} of {}: overlap of the valve, "
        "or friction that does not grow with speed. Gain and damping then hold at this excitation alone; measure at half and "
        "at twice of it, friction changes the damping more than the gain",
        "kleine Eingänge bewegen {} um einen kleineren Anteil als große, wie bei einem Totband von {:.2g} {} von {}: "
        "Überdeckung des Ventils, oder Reibung, die nicht mit der Geschwindigkeit wächst. Verstärkung und Dämpfung gelten "
        "dann nur bei dieser Anregung; bei der halben und der doppelten messen, Reibung ändert mehr die Dämpfung",
        plant.output, *range.dead_band, plant.input_unit, plant.input));
  if (range.readings_end)
    texts.push_back(Tell(
        "{} never reads more than {:.3g} {}, and often exactly that: where the controller ends there all is well; where the "
        "logger or the amplifier's monitor does, the valve gets more and the gain comes out too high. Excite less",
        "{} zeigt nie mehr als {:.3g} {} und oft genau das: endet der Regler dort, ist alles gut; endet dort der Logger oder "
        "der Messausgang des Verstärkers, bekommt das Ventil mehr, und die Verstärkung kommt zu groß heraus. Weniger anregen",
        plant.input, *range.readings_end, plant.input_unit));
  return texts;
}

std::vector<Told> InputDoubtsOf(const ClosedLoopPlant& plant, const InputRange& range) {
  std::vector<Told> doubts = NonlinearInputTexts(plant, range);
  if (range.input_limit)
    doubts.push_back(
        Tell("{} beyond {:.3g} {} does not reach the plant: {}; that passes for a lower gain here",
             "{} über {:.3g} {} erreicht die Strecke nicht: {}; das sieht hier wie weniger Verstärkung aus",
             plant.input, *range.input_limit, plant.input_unit, plant.limit.sentence));
  return doubts;
}

}  // namespace hydroscope
