#include "replay/rhythm.h"

#include <algorithm>
#include <cmath>

#include "core/quantile.h"

namespace hydroscope {
namespace {

constexpr std::size_t kLeastChanges = 50;  // that tell a rhythm
// Of the rows between two changes: so many lie within one row of the middle one, and hardly one follows the other at once.
constexpr double kInRhythm = 0.8, kAtOnce = 0.1;

}  // namespace

bool Differ(double a, double b) { return a != b && !(std::isnan(a) && std::isnan(b)); }

Rhythm RhythmOf(const std::vector<double>& column) {
  Rhythm rhythm;
  for (std::size_t row = 1; row < column.size(); ++row)
    if (Differ(column[row], column[row - 1])) rhythm.changes.push_back(row);
  if (rhythm.changes.size() < kLeastChanges) return rhythm;
  std::vector<double> apart;
  for (std::size_t k = 1; k < rhythm.changes.size(); ++k)
    apart.push_back(static_cast<double>(rhythm.changes[k] - rhythm.changes[k - 1]));
  rhythm.rows = Median(apart, 0);
  const auto share = [&](auto&& holds) {
    return static_cast<double>(std::ranges::count_if(apart, holds)) / static_cast<double>(apart.size());
  };
  if (share([](double rows) { return rows == 1; }) > kAtOnce)
    rhythm.kind = Rhythm::Kind::kEveryRow;
  else if (share([&](double rows) { return std::abs(rows - rhythm.rows) <= 1; }) >= kInRhythm)
    rhythm.kind = Rhythm::Kind::kHeld;
  return rhythm;
}

}  // namespace hydroscope
