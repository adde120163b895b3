#include "models/expressions/graph.h"

#include <bit>
#include <cmath>
#include <numbers>

#include "models/expressions/operation.h"

namespace hydroscope {
namespace {

using Kind = ExpressionNode::Kind;

Operation OperationOf(const std::string& text) {
  static const std::map<std::string, Operation> operations = {
      {"+", Operation::kAdd},        {"-", Operation::kSubtract},  {"*", Operation::kMultiply},
      {"/", Operation::kDivide},     {"^", Operation::kPower},     {"<", Operation::kLess},
      {"<=", Operation::kLessEqual}, {">", Operation::kGreater},   {">=", Operation::kGreaterEqual},
      {"==", Operation::kEqual},     {"!=", Operation::kNotEqual}, {"&&", Operation::kAnd},
      {"||", Operation::kOr},        {"min", Operation::kMin},     {"max", Operation::kMax},
      {"abs", Operation::kAbs},      {"sign", Operation::kSign},   {"sqrt", Operation::kSqrt},
      {"exp", Operation::kExp},      {"ln", Operation::kLn},       {"log10", Operation::kLog10},
      {"sin", Operation::kSin},      {"cos", Operation::kCos},     {"tan", Operation::kTan},
      {"asin", Operation::kAsin},    {"acos", Operation::kAcos},   {"atan", Operation::kAtan},
      {"atan2", Operation::kAtan2},  {"sinh", Operation::kSinh},   {"cosh", Operation::kCosh},
      {"tanh", Operation::kTanh}};
  return operations.at(text);
}

}  // namespace

int ExpressionGraph::Input(int number) { return Value(Operation::kInput, number); }

int ExpressionGraph::Constant(double number) {
  const auto [entry, is_new] =
      known_.try_emplace({Operation::kConstant, 0, 0, 0, std::bit_cast<std::uint64_t>(number)},
                         static_cast<int>(values_.size()));
  if (is_new) values_.push_back({Operation::kConstant, 0, 0, 0, number});
  return entry->second;
}

int ExpressionGraph::Value(Operation operation, int a, int b, int c) {
  if (operation != Operation::kInput) {
    const auto constant = [&](int v) {
      return values_[static_cast<std::size_t>(v)].operation == Operation::kConstant;
    };
    const auto number = [&](int v) { return values_[static_cast<std::size_t>(v)].constant; };
    // Operands that an operation does not have repeat its first, so that all three can be looked at.
    if (constant(a) && constant(b) && constant(c))
      return Constant(Compute(operation, number(a), number(b), number(c)));
  }
  const auto [entry, is_new] = known_.try_emplace({operation, a, b, c, 0}, static_cast<int>(values_.size()));
  if (is_new) values_.push_back({operation, a, b, c, 0});
  return entry->second;
}

int ExpressionGraph::Add(const ExpressionNode& node, const std::map<std::string, int>& input_of) {
  const auto arg = [&](std::size_t i) { return Add(*node.args[i], input_of); };
  switch (node.kind) {
    case Kind::kNumber:
      return Constant(node.number);
    case Kind::kName:
      return Input(input_of.at(node.text));
    case Kind::kNegate: {
      const int a = arg(0);
      return Value(Operation::kNegate, a, a, a);
    }
    case Kind::kNot: {
      const int a = arg(0);
      return Value(Operation::kNot, a, a, a);
    }
    case Kind::kConditional: {
      const int condition = arg(0), yes = arg(1), no = arg(2);
      return Value(Operation::kSelect, condition, yes, no);
    }
    case Kind::kBinary:
    case Kind::kCall:
      break;
  }
  int value = arg(0);
  const Operation operation = OperationOf(node.text);
  if (node.args.size() == 1) return Value(operation, value, value, value);
  for (std::size_t i = 1; i < node.args.size(); ++i) {
    const int next = arg(i);
    value = operation == Operation::kPower ? Power(value, next) : Value(operation, value, next, value);
  }
  return value;
}

/// Small whole powers are products.
int ExpressionGraph::Power(int a, int b) {
  for (int whole = 1; whole <= 4; ++whole) {
    if (!IsNumber(b, whole)) continue;
    int power = a;
    for (int k = 1; k < whole; ++k) power = Value(Operation::kMultiply, power, a, power);
    return power;
  }
  return Value(Operation::kPower, a, b, a);
}

bool ExpressionGraph::IsNumber(int value, double number) const {
  const GraphValue& v = values_[static_cast<std::size_t>(value)];
  return v.operation == Operation::kConstant && v.constant == number;
}
bool ExpressionGraph::IsZero(int value) const { return IsNumber(value, 0); }

int ExpressionGraph::Sum(int a, int b) {
  if (IsZero(a)) return b;
  return IsZero(b) ? a : Value(Operation::kAdd, a, b, a);
}
int ExpressionGraph::Difference(int a, int b) {
  if (IsZero(b)) return a;
  return IsZero(a) ? Value(Operation::kNegate, b, b, b) : Value(Operation::kSubtract, a, b, a);
}
int ExpressionGraph::Product(int a, int b) {
  if (IsZero(a) || IsZero(b)) return Constant(0);
  if (IsNumber(a, 1)) return b;
  return IsNumber(b, 1) ? a : Value(Operation::kMultiply, a, b, a);
}
int ExpressionGraph::Quotient(int a, int b) {
  return IsZero(a) || IsNumber(b, 1) ? a : Value(Operation::kDivide, a, b, a);
}

int ExpressionGraph::Derivative(int value, int input) {
  if (const auto known = derivative_.find({value, input}); known != derivative_.end()) return known->second;
  const GraphValue copy = values_[static_cast<std::size_t>(value)];
  const int derivative = Chain(copy, value, input);
  derivative_[{value, input}] = derivative;
  return derivative;
}

/// a^b: b a^(b-1) a' + a^b ln(a) b', the former 0 at a = 0, where it has no end if b is below 1.
int ExpressionGraph::ChainOfPower(const GraphValue& v, int self, int da, int db) {
  const auto unless_zero = [&](int slope) {
    const GraphValue& exponent = values_[static_cast<std::size_t>(v.b)];
    if (IsZero(slope) || (exponent.operation == Operation::kConstant && exponent.constant >= 1)) return slope;
    const int zero = Constant(0), moved = Value(Operation::kNotEqual, v.a, zero, v.a);
    return Value(Operation::kSelect, moved, slope, zero);
  };
  const int lower = Value(Operation::kSubtract, v.b, Constant(1), v.b);
  const int by_base = IsZero(da) ? da : unless_zero(Product(Product(v.b, Power(v.a, lower)), da));
  if (IsZero(db)) return by_base;
  const int log = Value(Operation::kLn, v.a, v.a, v.a);
  const int positive = Value(Operation::kGreater, v.a, Constant(0), v.a);
  return Sum(by_base, Value(Operation::kSelect, positive, Product(Product(self, log), db), Constant(0)));
}

int ExpressionGraph::Chain(const GraphValue& v, int self, int input) {
  if (v.operation == Operation::kConstant) return Constant(0);
  if (v.operation == Operation::kInput) return Constant(v.a == input ? 1 : 0);
  const int da = Derivative(v.a, input), db = Derivative(v.b, input);
  switch (v.operation) {
    case Operation::kSelect: {
      const int dc = Derivative(v.c, input);
      return db == dc ? db : Value(Operation::kSelect, v.a, db, dc);
    }
    case Operation::kAdd:
      return Sum(da, db);
    case Operation::kSubtract:
      return Difference(da, db);
    case Operation::kMultiply:
      return Sum(Product(da, v.b), Product(v.a, db));
    case Operation::kDivide:
      return Quotient(Difference(da, Product(self, db)), v.b);
    case Operation::kNegate:
      return Difference(Constant(0), da);
    default:
      return IsZero(da) && IsZero(db) ? Constant(0) : ChainOfFunction(v, self, da, db);
  }
}

int ExpressionGraph::ChainOfFunction(const GraphValue& v, int self, int da, int db) {
  const auto of = [&](Operation operation, int a) { return Value(operation, a, a, a); };
  const int one = Constant(1);
  const auto square = [&](int a) { return Product(a, a); };
  switch (v.operation) {
    case Operation::kPower:
      return ChainOfPower(v, self, da, db);
    case Operation::kMin:
      return Value(Operation::kSelect, Value(Operation::kLess, v.b, v.a, v.b), db, da);
    case Operation::kMax:
      return Value(Operation::kSelect, Value(Operation::kLess, v.a, v.b, v.a), db, da);
    case Operation::kAbs:
      return Product(of(Operation::kSign, v.a), da);
    case Operation::kSqrt: {
      const int slope = Quotient(da, Product(Constant(2), self));
      return Value(Operation::kSelect, Value(Operation::kGreater, v.a, Constant(0), v.a), slope, Constant(0));
    }
    case Operation::kExp:
      return Product(self, da);
    case Operation::kLn:
      return Quotient(da, v.a);
    case Operation::kLog10:
      return Quotient(da, Product(v.a, Constant(std::numbers::ln10)));
    case Operation::kSin:
      return Product(of(Operation::kCos, v.a), da);
    case Operation::kCos:
      return Difference(Constant(0), Product(of(Operation::kSin, v.a), da));
    case Operation::kTan:
      return Product(Sum(one, square(self)), da);
    case Operation::kAsin:
      return Quotient(da, of(Operation::kSqrt, Difference(one, square(v.a))));
    case Operation::kAcos:
      return Difference(Constant(0), Quotient(da, of(Operation::kSqrt, Difference(one, square(v.a)))));
    case Operation::kAtan:
      return Quotient(da, Sum(one, square(v.a)));
    case Operation::kAtan2:
      return Quotient(Difference(Product(v.b, da), Product(v.a, db)), Sum(square(v.a), square(v.b)));
    case Operation::kSinh:
      return Product(of(Operation::kCosh, v.a), da);
    case Operation::kCosh:
      return Product(of(Operation::kSinh, v.a), da);
    case Operation::kTanh:
      return Product(Difference(one, square(self)), da);
    default:
      return Constant(0);  // sign, comparisons and what joins them: flat but for their steps
  }
}

}  // namespace hydroscope
