#pragma once

#include <algorithm>
#include <cmath>

#include "models/expressions/elementary.h"
#include "models/expressions/graph.h"

namespace hydroscope {

/// Functions of one number, and powers.
[[gnu::always_inline]] inline double ComputeFunction(Operation operation, double a, double b) {
  switch (operation) {
    case Operation::kPower:
      return std::pow(a, b);
    case Operation::kAbs:
      return std::abs(a);
    case Operation::kSign:
      return (a > 0) - (a < 0);
    case Operation::kSqrt:
      return std::sqrt(a);
    case Operation::kExp:
      return std::exp(a);
    case Operation::kLn:
      return std::log(a);
    case Operation::kLog10:
      return std::log10(a);
    case Operation::kSin:
      return std::sin(a);
    case Operation::kCos:
      return std::cos(a);
    case Operation::kTan:
      return std::tan(a);
    case Operation::kAsin:
      return std::asin(a);
    case Operation::kAcos:
      return std::acos(a);
    case Operation::kAtan:
      return std::atan(a);
    case Operation::kAtan2:
      return std::atan2(a, b);
    case Operation::kSinh:
      return std::sinh(a);
    case Operation::kCosh:
      return std::cosh(a);
    case Operation::kTanh:
      return Tanh(a);
    default:
      return a;
  }
}

/// Comparisons, truth (anything but 0) and choices.
[[gnu::always_inline]] inline double ComputeChoice(Operation operation, double a, double b, double c) {
  switch (operation) {
    case Operation::kNot:
      return a == 0;
    case Operation::kLess:
      return a < b;
    case Operation::kLessEqual:
      return a <= b;
    case Operation::kGreater:
      return a > b;
    case Operation::kGreaterEqual:
      return a >= b;
    case Operation::kEqual:
      return a == b;
    case Operation::kNotEqual:
      return a != b;
    case Operation::kAnd:
      return a != 0 && b != 0;
    case Operation::kOr:
      return a != 0 || b != 0;
    case Operation::kSelect:
      return a != 0 ? b : c;
    case Operation::kMin:
      return std::min(a, b);
    case Operation::kMax:
      return std::max(a, b);
    default:
      return ComputeFunction(operation, a, b);
  }
}

/// The operation on numbers. Not finite (division by zero, root of a negative value) comes out as IEEE 754 has it. Of an
/// operation known to the compiler nothing but that is left.
[[gnu::always_inline]] inline double Compute(Operation operation, double a, double b, double c) {
  switch (operation) {
    case Operation::kInput:
    case Operation::kConstant:
      return a;
    case Operation::kNegate:
      return -a;
    case Operation::kAdd:
      return a + b;
    case Operation::kSubtract:
      return a - b;
    case Operation::kMultiply:
      return a * b;
    case Operation::kDivide:
      return a / b;
    case Operation::kProductPlus:
      return a * b + c;
    case Operation::kProductMinus:
      return a * b - c;
    case Operation::kMinusProduct:
      return c - a * b;
    default:
      return ComputeChoice(operation, a, b, c);
  }
}

}  // namespace hydroscope
