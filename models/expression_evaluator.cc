#include "models/expression_evaluator.h"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <limits>
#include <set>

namespace hydroscope {
namespace {

using Kind = ExpressionNode::Kind;

void CollectNames(const ExpressionNode& node, std::set<std::string>& names) {
  if (node.kind == Kind::kName) names.insert(node.text);
  for (const Expression& arg : node.args) CollectNames(*arg, names);
}

/// Text for muParser, fully bracketed, with variables x0, x1, ... in place of names, so that neither
/// precedence nor a name of its own can mean something else.
std::string MuText(const ExpressionNode& node, const std::map<std::string, std::string>& variable) {
  const auto arg = [&](std::size_t i) { return MuText(*node.args[i], variable); };
  switch (node.kind) {
    case Kind::kNumber:
      return fmt::format("({:.17g})", node.number);
    case Kind::kName:
      return variable.at(node.text);
    case Kind::kNegate:
      return fmt::format("(0-{})", arg(0));
    case Kind::kNot:
      return fmt::format("({}==0)", arg(0));
    case Kind::kBinary:
      return fmt::format("({}{}{})", arg(0), node.text, arg(1));
    case Kind::kConditional:
      return fmt::format("(({}!=0)?{}:{})", arg(0), arg(1), arg(2));
    case Kind::kCall:
      break;
  }
  std::string list;
  for (std::size_t i = 0; i < node.args.size(); ++i) list += (i == 0 ? "" : ",") + arg(i);
  return fmt::format("{}({})", node.text, list);
}

}  // namespace

struct ExpressionEvaluator::Compiled {
  mu::Parser parser;
  bool usable = false;
};

ExpressionEvaluator::ExpressionEvaluator(const ExpressionNode& expression,
                                         const std::map<std::string, int>& channel_of)
    : compiled_(std::make_unique<Compiled>()) {
  std::set<std::string> names;
  CollectNames(expression, names);
  std::map<std::string, std::string> variable;
  for (const std::string& name : names) {
    variable[name] = fmt::format("x{}", channels_.size());
    channels_.push_back(channel_of.at(name));
  }
  value_.assign(channels_.size(), 0.0);
  source_.assign(channels_.size(), nullptr);
  try {
    for (std::size_t i = 0; i < value_.size(); ++i)
      compiled_->parser.DefineVar(fmt::format("x{}", i), &value_[i]);
    compiled_->parser.SetExpr(MuText(expression, variable));
    compiled_->parser.Eval();
    compiled_->usable = true;
  } catch (const mu::Parser::exception_type&) {
    compiled_->usable = false;  // every value is then not a number, which flags the rows
  }
}

ExpressionEvaluator::~ExpressionEvaluator() = default;

ExpressionEvaluator::Run ExpressionEvaluator::Over(const std::vector<std::vector<double>>& channels,
                                                   int first) const {
  Run run(*this);
  for (std::size_t i = 0; i < channels_.size(); ++i)
    source_[i] = channels[static_cast<std::size_t>(channels_[i])].data() + first;
  return run;
}

double ExpressionEvaluator::Run::At(int sample) const {
  if (!evaluator_.compiled_->usable) return std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < evaluator_.value_.size(); ++i)
    evaluator_.value_[i] = evaluator_.source_[i][sample];
  return evaluator_.compiled_->parser.Eval();
}

}  // namespace hydroscope
