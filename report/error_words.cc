#include "report/error_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "diagnosis/remainder/locate.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "report/svg_text.h"

namespace hydroscope {
namespace {

// Error over noise floor up to which it is called "about down to" the floor, and up to which "some" behaviour is missing. Words
// alone hang on them: what is missing, `explain` decides.
constexpr double kAtTheFloor = 1.3, kSomeMissing = 2;
constexpr double kWorthASentence = 0.1;  // change of that ratio, of its size at first

}  // namespace

std::set<int> VersionsOf(const std::vector<RunInfo>& runs) {
  std::set<int> versions;
  for (const RunInfo& run : runs)
    if (run.strokes > 0) versions.insert(run.model_version);
  return versions;
}

ModelErrors OverallErrors(const ReportInput& input, const TrendAnalysis& analysis) {
  const auto known = [](double given, double median) {
    return given > 0 ? given : std::isfinite(median) ? median : 0;
  };
  return {known(input.rms_holdout, analysis.error.median_rms),
          known(input.noise_floor, analysis.error.median_floor)};
}

bool ErrorGrew(const ThirdsComparison& ratio) {
  return SignificanceOf(ratio.change) == Significance::kClear &&
         ratio.change.value > kFloorExcess * ratio.first;
}

void AddErrorSentence(std::vector<std::string>& out, const ReportInput& input,
                      const TrendAnalysis& analysis) {
  const CountedWords counted = CountedWordsOf(input.machine);
  if (const std::set<int> versions = VersionsOf(input.runs); versions.size() > 1)
    out.push_back(fmt::format(
        "The record mixes versions {} of the model: the error of each {} is that of the version it was recorded with.",
        fmt::join(versions, ", "), counted.one));
  for (const Told& unusual : input.unusual) out.push_back(EscapeText(unusual.english) + ".");
  if (!input.not_judged.empty()) {
    out.push_back(fmt::format("The model cannot be judged on these {}: {}.", counted.many,
                              EscapeText(input.not_judged)));
    return;
  }
  const ModelErrors errors = OverallErrors(input, analysis);
  if (!(errors.floor > 0) || !(errors.rms > 0)) return;
  const double ratio = errors.rms / errors.floor;
  const std::string times = FormatFixed(ratio, ratio < 10 ? 1 : 0);
  if (input.found == ErrorFinding::kMayBeNoise)
    out.push_back(fmt::format(
        "The model error is {} times what the noise between rows would leave, and nothing predicts it: the noise is not white, "
        "or the model misses something and the parameters may have absorbed part of it.",
        times));
  else if (ratio <= kAtTheFloor && input.found == ErrorFinding::kMore)
    out.push_back(fmt::format(
        "The model error is {} times what sensor noise alone leaves; single values hardly show it, but summed "
        "over the {} the model misses something, and the parameters may have absorbed part of it.",
        times, counted.many));
  else if (ratio > kAtTheFloor && input.found == ErrorFinding::kNoise)
    out.push_back(fmt::format(
        "The model error is {} times what white sensor noise would leave, and nothing in it goes with any "
        "signal: the noise is not white.",
        times));
  else if (ratio <= kAtTheFloor)
    out.push_back(
        fmt::format("The model explains the measured {} about down to what sensor noise "
                    "leaves ({} times the noise floor).",
                    EscapeText(WordsOf(input.machine).output.english), times));
  else if (InEpisodes(KindOf(input.machine)))  // whose effects are tried on logs alone
    out.push_back(fmt::format(
        "The model error is {} times what white sensor noise would leave: the noise is not white, or "
        "the model misses something and the parameters may have absorbed part of it. "
        "<code>hydroscope explain</code> with the logs tells which.",
        times));
  else if (ratio <= kSomeMissing)
    out.push_back(
        fmt::format("The model error is {} times what sensor noise alone leaves: some of the machine's "
                    "behaviour is not in the model.",
                    times));
  else
    out.push_back(
        fmt::format("The model error is {} times what sensor noise alone leaves: the model misses something, "
                    "and the parameters may have absorbed part of it. Read their changes with that in mind.",
                    times));
  const ThirdsComparison& trend = analysis.error.ratio;
  if (SignificanceOf(trend.change) == Significance::kClear &&
      std::abs(trend.change.value) > kWorthASentence * trend.first)
    out.push_back(
        fmt::format("The model error {} over the record, from {} to {} times the noise floor: the model fits "
                    "the machine {} at the end than at the start.",
                    trend.change.value > 0 ? "grew" : "shrank", FormatFixed(trend.first, 1),
                    FormatFixed(trend.last, 1), trend.change.value > 0 ? "less well" : "better"));
}

}  // namespace hydroscope
