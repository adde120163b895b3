#include "workbench/states/measured_otherwise.h"

#include <algorithm>
#include <utility>

namespace hydroscope {
namespace {

constexpr SamplingOptions kOnAllCores = {.threads = 0};

/// A file that says nothing means straight lines, and outputs read when inputs are: another way is taken in place of these alone.
bool IsTaken(const OtherSampling& other, const LogFormat& stated) {
  return !other.holds_otherwise || stated.hold == LogFormat().hold;
}

/// Asked of the set found, and of single effects that do nearly as well: an imitator may bend to a wrong sampling, so that another
/// takes nothing of its error away.
std::optional<OtherSampling> SamplingOf(const StatesExplanation& x, std::span<const Episode> fitted) {
  auto other = FindOtherSampling(x.final.fit, fitted, LeftBySampling::kDoubt, kOnAllCores);
  for (const StateCandidate& rival : x.ranking)
    if (!other && rival.fitted() && rival.added != x.final.added && rival.fit.runs.size() == fitted.size() &&
        rival.held_out <= kOnAllCores.rivals * x.final.held_out)
      other = FindOtherSampling(rival.fit, fitted, LeftBySampling::kDoubt, kOnAllCores);
  return other;
}

/// Asked of the set found, and where that has several effects, of the best single one: a constant that does as well as a further
/// effect stands in its place.
std::optional<MissingZeros> ZerosOf(const StatesExplanation& x, std::span<const Episode> fitted) {
  if (auto zeros = FindMissingZeros(x.final.fit, fitted)) return zeros;
  if (x.final.added.size() < 2) return std::nullopt;
  const StateCandidate& single = x.ranking.front();
  if (!single.fitted() || single.fit.runs.size() != fitted.size()) return std::nullopt;
  auto zeros = FindMissingZeros(single.fit, fitted);
  const bool does_as_well = zeros && zeros->error * zeros->error * single.held_out <= x.final.held_out;
  return does_as_well ? zeros : std::nullopt;
}

}  // namespace

MeasuredOtherwise FindMeasuredOtherwise(const StateFit& fit, std::span<const Episode> episodes,
                                        LeftBySampling left) {
  MeasuredOtherwise otherwise{FindOtherSampling(fit, episodes, left, kOnAllCores), {}};
  if (left == LeftBySampling::kDoubt) otherwise.zeros = FindMissingZeros(fit, episodes);
  return otherwise;
}

MeasuredOtherwise FindMeasuredOtherwise(const StatesExplanation& found, std::span<const Episode> fitted) {
  MeasuredOtherwise otherwise;
  const bool in_doubt = found.verdict == Verdict::kUnknown || found.partial;
  otherwise.sampling = in_doubt
                           ? SamplingOf(found, fitted)
                           : FindOtherSampling(found.final.fit, fitted, LeftBySampling::kNoise, kOnAllCores);
  if (in_doubt || found.final.added.size() > 1) otherwise.zeros = ZerosOf(found, fitted);
  return otherwise;
}

TakenOtherwise TakeOtherwise(const MeasuredOtherwise& otherwise, EpisodeLog& log) {
  const auto& [sampling, zeros] = otherwise;
  const bool samples = sampling && IsTaken(*sampling, log.machine.log);
  if (zeros && !(samples && sampling->error < zeros->error)) {
    log.warnings.push_back(MissingZerosText(*zeros, log.machine));
    log.machine = WithZeros(std::move(log.machine), *zeros);
    return TakenOtherwise::kZeros;
  }
  if (!samples) return TakenOtherwise::kNothing;
  log.warnings.push_back(TakenSamplingText(*sampling));
  log.machine.log.hold = sampling->hold;
  if (sampling->is_late) log.machine.log.outputs_late = sampling->late;
  return TakenOtherwise::kSampling;
}

}  // namespace hydroscope
