#include "page/work/response_options.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/told_error.h"
#include "page/http/json_arguments.h"

namespace hydroscope {
namespace {

/// Puts the number under `key`, if there is one, into `value`. Error: it lies outside.
Status Take(const nlohmann::json& object, const char* key, double low, double high, double& value) {
  const auto number = TRY(NumberOf(object, key));
  if (!number) return {};
  if (*number < low || *number > high)
    return BadInput(Tell("{}: found {:g}, expected {:g} to {:g}", "{}: gefunden {:g}, erwartet {:g} bis {:g}",
                         key, *number, low, high));
  value = *number;
  return {};
}

}  // namespace

Result<FrequencyResponseOptions> ParseResponseOptions(const nlohmann::json& object) {
  constexpr double kMost = 1e5, kLongestSegment = 1 << 24;
  FrequencyResponseOptions options;
  const auto method = TRY(TextOf(object, "method"));
  if (method == "sine")
    options.method = FrequencyResponseMethod::kSine;
  else if (method == "welch")
    options.method = FrequencyResponseMethod::kWelch;
  else if (!method.empty() && method != "auto")
    return BadInput("method: found '{}', expected one of auto, sine, welch", method);
  double segment = 0;
  for (const Status& taken :
       {Take(object, "segment", 0, kLongestSegment, segment),
        Take(object, "min_coherence", 0, 1, options.min_coherence),
        Take(object, "from", 0, kMost, options.lowest), Take(object, "to", 1e-4, kMost, options.highest),
        Take(object, "settle", 0, kMost, options.settle_time)})
    if (!taken) return tl::unexpected(taken.error());
  options.segment_length = static_cast<std::size_t>(std::llround(segment));
  return options;
}

}  // namespace hydroscope
