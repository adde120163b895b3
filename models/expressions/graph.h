#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "models/expressions/syntax.h"

namespace hydroscope {

/// What computes one value of an expression from at most three others.
enum class Operation : std::uint8_t {
  kInput,
  kConstant,
  kNegate,
  kNot,
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kPower,
  kLess,
  kLessEqual,
  kGreater,
  kGreaterEqual,
  kEqual,
  kNotEqual,
  kAnd,
  kOr,
  kSelect,  ///< a != 0 ? b : c
  kMin,
  kMax,
  kAbs,
  kSign,
  kSqrt,
  kExp,
  kLn,
  kLog10,
  kSin,
  kCos,
  kTan,
  kAsin,
  kAcos,
  kAtan,
  kAtan2,
  kSinh,
  kCosh,
  kTanh,
  kProductPlus,   ///< a*b + c; these three stand in programs alone
  kProductMinus,  ///< a*b - c
  kMinusProduct,  ///< c - a*b
};

/// One value: an input, a constant, or an operation on values before it.
struct GraphValue {
  Operation operation = Operation::kConstant;
  int a = 0, b = 0, c = 0;  ///< operands; of an input: a is its number
  double constant = 0;
};

/// Expressions as values computed from each other, each kept once, so that what they share is computed once.
/// Derivatives are exact: the rules of forward differentiation (Griewank and Walther 2008, chapter 3) applied to each
/// value give new values of the same graph, and those that are zero vanish.
///
/// Where a function has no derivative it has that of one side: abs and sign 0 at 0, min and max that of the argument
/// taken, sqrt, and a power with respect to its exponent, or to its base unless the exponent is a constant of 1 or more, 0 at 0.
class ExpressionGraph {
 public:
  /// The value of an expression without ddt. `input_of` has the number of every name in it.
  int Add(const ExpressionNode& expression, const std::map<std::string, int>& input_of);
  int Input(int number);
  int Constant(double number);
  int Sum(int a, int b);
  /// Derivative of a value with respect to an input.
  int Derivative(int value, int input);

  const std::vector<GraphValue>& values() const { return values_; }
  bool IsZero(int value) const;

 private:
  int Value(Operation operation, int a, int b = 0, int c = 0);
  int Power(int a, int b);
  int Product(int a, int b);
  int Difference(int a, int b);
  int Quotient(int a, int b);
  int Chain(const GraphValue& value, int self, int input);
  int ChainOfFunction(const GraphValue& value, int self, int da, int db);
  int ChainOfPower(const GraphValue& value, int self, int da, int db);
  bool IsNumber(int value, double number) const;

  std::vector<GraphValue> values_;
  std::map<std::tuple<Operation, int, int, int, std::uint64_t>, int> known_;
  std::map<std::pair<int, int>, int> derivative_;  ///< (value, input) -> value
};

}  // namespace hydroscope
