#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/result.h"

namespace hydroscope {

/// A whole number from 0 to 2^53 under `name` of a query; nothing if absent. Error: it is none.
Result<std::optional<std::int64_t>> WholeNumberOf(const std::map<std::string, std::string>& query,
                                                  const char* name);

/// What is asked of a trend.
struct TrendQuestion {
  static constexpr std::int64_t kMostBins = 4000;

  std::string machine, parameter;
  std::int64_t first = 0, end = -1;  ///< strokes; end -1: all there are
  std::int64_t bins = 1000;
};
/// Of the query `machine`, `parameter`, `first`, `end`, `bins`. Errors name the key and what was expected.
Result<TrendQuestion> ParseTrendQuestion(const std::map<std::string, std::string>& query);

}  // namespace hydroscope
