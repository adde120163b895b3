#include "models/expressions/guard.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "models/expressions/check.h"
#include "models/stretch.h"

namespace hydroscope {
namespace {

using Kind = ExpressionNode::Kind;

/// Operations that give a finite number for finite operands.
bool AlwaysFinite(const ExpressionNode& node) {
  static const std::set<std::string> harmless = {"abs", "sign", "min",  "max",  "ddt",
                                                 "sin", "cos",  "tanh", "atan", "atan2"};
  if (node.kind == Kind::kCall && !harmless.contains(node.text)) return false;
  if (node.kind == Kind::kBinary && (node.text == "*" || node.text == "/" || node.text == "^")) return false;
  return std::all_of(node.args.begin(), node.args.end(),
                     [](const Expression& a) { return AlwaysFinite(*a); });
}

/// Arguments of ddt(...), which must be finite themselves.
void CollectRates(const ExpressionNode& node, std::vector<Expression>& rates) {
  if (node.kind == Kind::kCall && node.text == "ddt") rates.push_back(node.args[0]);
  for (const Expression& arg : node.args) CollectRates(*arg, rates);
}

/// The expression with the effect's constants at their lower or upper limits.
Expression AtLimits(const Expression& expression, const UserEffectSpec& effect, bool upper) {
  std::map<std::string, double> values;
  for (const ShapeSpec& s : effect.shape) values[s.name] = upper ? s.max : s.min;
  return WithValues(expression, values);
}

}  // namespace

std::shared_ptr<const ExpressionGuard> ExpressionGuard::For(const Machine& machine) {
  ExpressionGuard guard;
  const auto watch = [&](const std::string& text) {
    const ExpressionNames names = ExpressionNamesOf(machine);
    if (const auto checked = CheckExpression(text, names))
      guard.Watch(machine, WithValues(checked->tree, names.constants));
  };
  if (!machine.balance.output.empty()) watch(machine.balance.output);
  for (const TermSpec& term : machine.balance.terms) watch(term.expression);
  for (const UserEffectSpec& effect : machine.user_effects)
    for (const TermSpec& term : effect.terms) {
      const ExpressionNames names = ExpressionNamesOf(machine, effect);
      const auto checked = CheckExpression(term.expression, names);
      if (!checked) continue;
      const Expression tree = WithValues(checked->tree, names.constants);
      guard.Watch(machine, AtLimits(tree, effect, false));
      if (!effect.shape.empty()) guard.Watch(machine, AtLimits(tree, effect, true));
    }
  return guard.watched_.empty() ? nullptr : std::make_shared<const ExpressionGuard>(std::move(guard));
}

void ExpressionGuard::Watch(const Machine& machine, const Expression& expression) {
  std::map<std::string, int> index;
  for (std::size_t s = 0; s < machine.signals.size(); ++s)
    index[machine.signals[s].name] = static_cast<int>(s);
  std::vector<Expression> pieces;
  CollectRates(*expression, pieces);
  pieces.push_back(WithRates(expression, 1));
  if (ContainsDdt(*expression)) pieces.push_back(WithRates(expression, -1));
  for (const Expression& piece : pieces) {
    const Expression value = WithRates(piece, 1);
    if (AlwaysFinite(*value) || NamesIn(*value).empty()) continue;
    watched_.push_back(std::make_unique<const ExpressionEvaluator>(*value, index));
  }
}

void ExpressionGuard::Flag(SampleBlock& block, std::size_t rows) const {
  for (const auto& expression : watched_) {
    const std::vector<int>& signals = expression->channels();
    std::array<double, kChunk> value;
    for (std::size_t row = 0; row < rows; ++row) {
      if (row % kChunk == 0)
        expression->Values(block.signal, static_cast<int>(row),
                           std::span(value).first(std::min<std::size_t>(kChunk, rows - row)));
      if (std::isfinite(value[row % kChunk])) continue;
      const bool good = std::all_of(signals.begin(), signals.end(), [&](int s) {
        return (block.quality[static_cast<std::size_t>(s)][row] & ~quality::kExpression) == quality::kGood;
      });
      if (good) block.quality[static_cast<std::size_t>(signals.front())][row] |= quality::kExpression;
    }
  }
}

}  // namespace hydroscope
