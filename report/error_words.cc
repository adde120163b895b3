#include "report/error_words.h"

#include <fmt/format.h>

#include <cmath>

#include "core/constants.h"
#include "core/quantile.h"
#include "diagnosis/remainder/locate.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "report/svg_text.h"

namespace hydroscope {

FlowErrors OverallErrors(const ReportInput& input) {
  std::vector<double> rms, floor;
  for (const StrokeSummary& stroke : input.strokes)
    rms.push_back(stroke.rms_error), floor.push_back(stroke.noise_floor);
  const auto known = [](double given, double median) {
    return given > 0 ? given : std::isfinite(median) ? median : 0;
  };
  return {known(input.rms_holdout, Median(rms, kNaN)), known(input.noise_floor, Median(floor, kNaN))};
}

bool ErrorGrew(const ThirdsComparison& ratio) {
  return SignificanceOf(ratio.change) == Significance::kClear &&
         ratio.change.value > kFloorExcess * ratio.first;
}

void AddErrorSentence(std::vector<std::string>& out, const ReportInput& input,
                      const TrendAnalysis& analysis) {
  const CountedWords counted = CountedWordsOf(input.machine);
  if (!input.not_judged.empty()) {
    out.push_back(fmt::format("The model cannot be judged on these {}: {}.", counted.many,
                              EscapeText(input.not_judged)));
    return;
  }
  const FlowErrors errors = OverallErrors(input);
  if (!(errors.floor > 0) || !(errors.rms > 0)) return;
  const double ratio = errors.rms / errors.floor;
  const std::string times = FormatFixed(ratio, ratio < 10 ? 1 : 0);
  if (input.found == ErrorFinding::kMayBeNoise)
    out.push_back(fmt::format(
        "The model error is {} times what the noise between rows would leave, and nothing predicts it: the noise is not white, "
        "or the model misses something and the parameters may have absorbed part of it.",
        times));
  else if (ratio <= 1.3 && input.found == ErrorFinding::kMore)
    out.push_back(fmt::format(
        "The model error is {} times what sensor noise alone leaves; single flows hardly show it, but summed "
        "over the {} the model misses something, and the parameters may have absorbed part of it.",
        times, counted.many));
  else if (ratio > 1.3 && input.found == ErrorFinding::kNoise)
    out.push_back(fmt::format(
        "The model error is {} times what white sensor noise would leave, and nothing in it goes with any "
        "signal: the noise is not white.",
        times));
  else if (ratio <= 1.3)
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
  else if (ratio <= 2)
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
      std::abs(trend.change.value) > 0.1 * trend.first)
    out.push_back(
        fmt::format("The model error {} over the record, from {} to {} times the noise floor: the model fits "
                    "the machine {} at the end than at the start.",
                    trend.change.value > 0 ? "grew" : "shrank", FormatFixed(trend.first, 1),
                    FormatFixed(trend.last, 1), trend.change.value > 0 ? "less well" : "better"));
}

}  // namespace hydroscope
