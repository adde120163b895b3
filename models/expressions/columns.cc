#include "models/expressions/columns.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "models/smooth_rate.h"

namespace hydroscope {
namespace {

using Kind = ExpressionNode::Kind;

Expression Times(const Expression& factor, const Expression& weight) {
  return weight ? BinaryNode("*", factor, weight) : factor;
}

}  // namespace

int ExpressionChannels::AddChannel(const std::string& name) {
  model_.channel_names.push_back(name);
  return static_cast<int>(model_.channel_names.size()) - 1;
}

Expression ExpressionChannels::Windowed(const Expression& expression) {
  if (!ContainsDdt(*expression)) return expression;
  ExpressionNode copy = *expression;
  for (Expression& arg : copy.args) arg = Windowed(arg);
  if (copy.kind != Kind::kCall || copy.text != "ddt")
    return std::make_shared<const ExpressionNode>(std::move(copy));

  const Expression inner = copy.args[0];
  const std::string name = CanonicalText(copy);
  if (!rate_channel_.contains(name)) {
    Rate rate;
    const auto indices = Indices();
    if (inner->kind == Kind::kName) {
      rate.inner = indices.at(inner->text);
    } else {
      rate.evaluator = std::make_shared<const ExpressionEvaluator>(*inner, indices);
      rate.inner = AddChannel(CanonicalText(*inner));
    }
    rate.channel = AddChannel(name);
    rate_channel_[name] = rate.channel;
    rates_.push_back(std::move(rate));
  }
  return NameNode(name);
}

std::vector<ExpressionPart> ExpressionChannels::Parts(const Expression& expression) {
  if (!ContainsDdt(*expression)) return {{expression, nullptr}};
  const ExpressionNode& node = *expression;
  if (node.kind == Kind::kCall && node.text == "ddt") return {{nullptr, Windowed(node.args[0])}};
  if (node.kind == Kind::kNegate) {
    std::vector<ExpressionPart> parts = Parts(node.args[0]);
    for (ExpressionPart& part : parts) part.weight = Times(NumberNode(-1), part.weight);
    return parts;
  }
  if (node.kind == Kind::kBinary && (node.text == "+" || node.text == "-")) {
    std::vector<ExpressionPart> parts = Parts(node.args[0]);
    const Expression right = node.text == "+" ? node.args[1] : NegateNode(node.args[1]);
    for (ExpressionPart& part : Parts(right)) parts.push_back(std::move(part));
    return parts;
  }
  const bool left = !node.args.empty() && ContainsDdt(*node.args[0]);
  const bool right = node.args.size() > 1 && ContainsDdt(*node.args[1]);
  const bool product = node.kind == Kind::kBinary && node.text == "*" && left != right;
  const bool quotient = node.kind == Kind::kBinary && node.text == "/" && left && !right;
  if (product || quotient) {
    std::vector<ExpressionPart> parts = Parts(node.args[left ? 0 : 1]);
    const Expression factor =
        quotient ? BinaryNode("/", NumberNode(1), node.args[1]) : node.args[left ? 1 : 0];
    for (ExpressionPart& part : parts) part.weight = Times(factor, part.weight);
    return parts;
  }
  return {{Windowed(expression), nullptr}};
}

std::map<std::string, int> ExpressionChannels::Indices() const {
  std::map<std::string, int> indices;
  for (std::size_t c = 0; c < model_.channel_names.size(); ++c)
    indices[model_.channel_names[c]] = static_cast<int>(c);
  return indices;
}

std::function<void(Stretch&)> ExpressionChannels::Derivation() const {
  return [rates = rates_, half_width = half_width_](Stretch& s) {
    const int half = std::max(1, static_cast<int>(std::lround(half_width / s.period)));
    for (const Rate& rate : rates) {
      double* const inner = s[rate.inner];
      if (rate.evaluator) {
        const auto count = static_cast<std::size_t>(s.before + s.samples + s.after);
        rate.evaluator->Values(s.channel, 0, std::span(inner - s.before, count));
      }
      SmoothRate(inner - s.before, s.before + s.samples + s.after, half, s.period, Ends::kHold,
                 s[rate.channel] - s.before);
    }
  };
}

bool HasLevel(const std::vector<ExpressionPart>& parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [](const ExpressionPart& part) { return part.level != nullptr; });
}

ExpressionParts::ExpressionParts(const std::vector<ExpressionPart>& parts,
                                 const std::map<std::string, int>& channel_of) {
  const auto compiled = [&](const Expression& e) {
    return e ? std::make_unique<const ExpressionEvaluator>(*e, channel_of) : nullptr;
  };
  for (const ExpressionPart& part : parts) parts_.push_back({compiled(part.weight), compiled(part.level)});
}

void ExpressionParts::Increments(const Stretch& s, std::span<double> increments) const {
  std::fill(increments.begin(), increments.end(), 0.0);
  const int steps = static_cast<int>(increments.size());
  std::array<double, kChunk + 1> weight, level;
  // Trapezoid by trapezoid: mean weight times the step of the level, or of time.
  for (const Compiled& part : parts_)
    for (int first = 0; first < steps; first += kChunk) {
      const auto count = static_cast<std::size_t>(std::min(kChunk, steps - first));
      weight.fill(1);
      if (part.weight) part.weight->Values(s.channel, s.before + first, std::span(weight).first(count + 1));
      if (part.level)
        part.level->Values(s.channel, s.before + first, std::span(level).first(count + 1));
      else
        for (std::size_t k = 0; k <= count; ++k) level[k] = (first + static_cast<int>(k)) * s.period;
      for (std::size_t k = 0; k < count; ++k)
        increments[static_cast<std::size_t>(first) + k] +=
            0.5 * (weight[k] + weight[k + 1]) * (level[k + 1] - level[k]);
    }
}

void ExpressionParts::Values(const Stretch& s, std::span<double> values) const {
  std::fill(values.begin(), values.end(), 0.0);
  std::array<double, kChunk> weight;
  for (const Compiled& part : parts_)
    for (std::size_t first = 0; first < values.size(); first += kChunk) {
      const std::size_t count = std::min<std::size_t>(kChunk, values.size() - first);
      part.weight->Values(s.channel, s.before + static_cast<int>(first), std::span(weight).first(count));
      for (std::size_t k = 0; k < count; ++k) values[first + k] += weight[k];
    }
}

double ExpressionParts::Contrast(const Stretch& s, int sample) const {
  double sum = 0;
  std::array<double, 4> weight;
  for (const Compiled& part : parts_) {
    if (part.level) continue;
    part.weight->Values(s.channel, s.before + sample - 2, weight);
    sum += weight[0] - weight[1] - weight[2] + weight[3];
  }
  return 0.5 * sum;
}

Column::Fill FillOf(std::shared_ptr<const ExpressionParts> parts, bool level_form) {
  return [parts = std::move(parts), level_form](const Stretch& s, double&, std::span<double> out) {
    if (level_form)
      parts->Values(s, out);
    else
      parts->Increments(s, out);
  };
}

}  // namespace hydroscope
