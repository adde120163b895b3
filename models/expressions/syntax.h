#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "core/told.h"

namespace hydroscope {

/// One node of a parsed expression. Nodes are immutable and shared.
struct ExpressionNode {
  enum class Kind { kNumber, kName, kNegate, kNot, kBinary, kConditional, kCall };
  Kind kind = Kind::kNumber;
  double number = 0;
  std::string text;  ///< name, function, or operator: + - * / ^ < <= > >= == != && ||
  std::vector<std::shared_ptr<const ExpressionNode>> args;
  std::size_t at = 0;  ///< first character in the text
};
using Expression = std::shared_ptr<const ExpressionNode>;

/// What is wrong with an expression, and where: `at` counts characters from 0.
struct ExpressionError {
  std::size_t at = 0;
  Told text;
};
template <typename T>
using ExpressionResult = tl::expected<T, ExpressionError>;

/// A function an expression may call.
struct ExpressionFunction {
  std::string_view name;
  std::size_t min_args, max_args;
  std::string_view meaning;
};
/// All of them, ddt included.
const std::vector<ExpressionFunction>& ExpressionFunctions();

/// Brackets of an expression, which bound the depth of its tree; its operators are bounded by models/expressions/limits.h.
inline constexpr int kMaxExpressionParts = 200;

/// Parses `condition ? a : b`, `|| && < <= > >= == != + - * / ! ^` (right associative, before a sign: -x^2 =
/// -(x^2)), numbers, names and function calls. Names are not looked up. Errors: text longer than 2000
/// characters, more than 200 brackets or 500 operators, unknown function (suggests the nearest), wrong number of
/// arguments, anything unexpected.
ExpressionResult<Expression> ParseExpression(const std::string& text);

/// Fully bracketed text that ParseExpression reads back to an equal expression; equal for equal expressions.
std::string CanonicalText(const ExpressionNode& node);

Expression NumberNode(double number);
Expression NameNode(const std::string& name);
Expression BinaryNode(const std::string& op, Expression left, Expression right);
Expression NegateNode(Expression operand);

/// Whether ddt(...) occurs anywhere.
bool ContainsDdt(const ExpressionNode& node);

/// "    text\n    ^" with the mark below character `at`.
std::string CaretLine(const std::string& text, std::size_t at);

}  // namespace hydroscope
