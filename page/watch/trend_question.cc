#include "page/watch/trend_question.h"

#include <algorithm>
#include <charconv>

namespace hydroscope {
namespace {

constexpr std::int64_t kLargest = std::int64_t{1} << 53;  ///< that JSON numbers hold

}  // namespace

Result<std::optional<std::int64_t>> WholeNumberOf(const std::map<std::string, std::string>& query,
                                                  const char* name) {
  const auto found = query.find(name);
  if (found == query.end() || found->second.empty()) return std::optional<std::int64_t>();
  const std::string& text = found->second;
  std::int64_t number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec != std::errc() || read.ptr != text.data() + text.size() || number < 0 || number > kLargest)
    return BadInput("{}: expected a whole number from 0", name);
  return std::optional<std::int64_t>(number);
}

Result<TrendQuestion> ParseTrendQuestion(const std::map<std::string, std::string>& query) {
  const auto text = [&](const char* name) {
    const auto found = query.find(name);
    return found == query.end() ? std::string() : found->second;
  };
  TrendQuestion question;
  question.machine = text("machine");
  question.parameter = text("parameter");
  if (question.parameter.empty()) return BadInput("parameter: expected the name of a parameter");
  const auto first = WholeNumberOf(query, "first"), end = WholeNumberOf(query, "end"),
             bins = WholeNumberOf(query, "bins");
  for (const auto* number : {&first, &end, &bins})
    if (!*number) return tl::unexpected(number->error());
  question.first = first->value_or(question.first);
  question.end = end->value_or(question.end);
  question.bins = std::clamp<std::int64_t>(bins->value_or(question.bins), 1, TrendQuestion::kMostBins);
  return question;
}

}  // namespace hydroscope
