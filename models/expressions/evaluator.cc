#include "models/expressions/evaluator.h"

#include <array>

#include "models/expressions/check.h"
#include "models/expressions/limits.h"

namespace hydroscope {
namespace {

std::vector<int> ChannelsOf(const ExpressionNode& expression, const std::map<std::string, int>& channel_of) {
  std::vector<int> channels;
  for (const std::string& name : NamesIn(expression)) channels.push_back(channel_of.at(name));
  return channels;
}

ExpressionProgram ProgramOf(const ExpressionNode& expression) {
  std::map<std::string, int> input_of;
  for (const std::string& name : NamesIn(expression)) {
    const auto next = static_cast<int>(input_of.size());
    input_of[name] = next;
  }
  ExpressionGraph graph;
  const int value = graph.Add(expression, input_of);
  return {graph, {value}, static_cast<int>(input_of.size())};
}

}  // namespace

ExpressionEvaluator::ExpressionEvaluator(const ExpressionNode& expression,
                                         const std::map<std::string, int>& channel_of)
    : channels_(ChannelsOf(expression, channel_of)), program_(ProgramOf(expression)) {}

void ExpressionEvaluator::Values(const std::vector<std::vector<double>>& channels, int first,
                                 std::span<double> values) const {
  std::array<const double*, kMaxExpressionOperators + 1> inputs{};
  for (std::size_t i = 0; i < channels_.size(); ++i)
    inputs[i] = channels[static_cast<std::size_t>(channels_[i])].data() + first;
  program_.RunColumns(inputs.data(), values.size(), values.data());
}

}  // namespace hydroscope
