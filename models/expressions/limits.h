#pragma once

namespace hydroscope {

/// Operators and brackets of an expression, and so its names: the acceleration of an arm of two joints has some 300. Brackets
/// alone, which bound the depth, are at most kMaxExpressionParts.
inline constexpr int kMaxExpressionOperators = 500;

}  // namespace hydroscope
