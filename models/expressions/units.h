#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "models/expressions/syntax.h"

namespace hydroscope {

/// Powers of kg, m, s, A, K. Angles are pure numbers.
struct Dimension {
  std::array<double, 5> power{};

  bool operator==(const Dimension& other) const;
  Dimension operator*(const Dimension& other) const;
  Dimension operator/(const Dimension& other) const;
  Dimension Power(double exponent) const;
  bool pure() const { return *this == Dimension{}; }
};

/// Reads an SI unit: factors Pa N Nm J W V A K Hz kg m s rad 1, each with an optional exponent ("m3", "s-1"),
/// separated by spaces, * or /, brackets, sqrt(...): "m3/(s Pa)". nullopt for anything else.
std::optional<Dimension> ParseSiUnit(std::string_view text);
/// The name people use ("m3/(s Pa)") or base units ("kg m2/s3").
std::string SiUnitName(const Dimension& dimension);

/// Dimension of an expression. Numbers in the text may carry any unit (0.02 can be 0.02 m), so what is
/// computed with them is not exact.
struct ExpressionUnit {
  Dimension dimension;
  bool exact = true;
};
/// Dimensions of the names an expression uses; a name without one is not exact.
using NameUnits = std::map<std::string, std::optional<Dimension>>;

/// Error where it cannot be right whatever units its numbers carry: p + x, sqrt of a condition, exp(p).
ExpressionResult<ExpressionUnit> UnitOf(const ExpressionNode& node, const NameUnits& names);

}  // namespace hydroscope
