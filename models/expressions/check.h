#pragma once

#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "models/expressions/units.h"
#include "models/machine.h"

namespace hydroscope {

/// What values something can take.
struct ValueRange {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

/// What an expression of a machine file may name.
struct ExpressionNames {
  NameUnits units;                          ///< every name
  std::map<std::string, double> constants;  ///< values from [geometry], and pi
  std::map<std::string, ValueRange>
      found;                          ///< names whose value is found from the data, and where: ShapeSpec
  std::set<std::string> delayed;      ///< signals that delay(...) may be of; none: it has no place
  std::set<std::string> delay_times;  ///< names that may say by how long, beside constants
};
/// Signals and [geometry] of the machine, and pi. A signal hides a constant of the same name.
ExpressionNames ExpressionNamesOf(const Machine& machine);
/// The same with the constants of an effect that are found from the data.
ExpressionNames ExpressionNamesOf(const Machine& machine, const UserEffectSpec& effect);

struct CheckedExpression {
  Expression tree;
  ExpressionUnit unit;
};
/// Parses and checks: every name is known (suggests the nearest), units fit, and what is done with a ddt(...)
/// has a finite value whatever its sign and size (a rate passes through zero in every stroke).
ExpressionResult<CheckedExpression> CheckExpression(const std::string& text, const ExpressionNames& names);

/// The expression with names replaced by their values.
Expression WithValues(const Expression& expression, const std::map<std::string, double>& values);
/// The expression with each ddt(...) replaced by a number, for checks.
Expression WithRates(const Expression& expression, double rate);
/// The expression with nodes replaced where `replacement` gives one.
Expression Replaced(const Expression& expression,
                    const std::function<Expression(const ExpressionNode&)>& replacement);
/// Every name the expression uses.
std::set<std::string> NamesIn(const ExpressionNode& node);

}  // namespace hydroscope
