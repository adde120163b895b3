#pragma once

#include <cstddef>
#include <vector>

namespace hydroscope {

/// How often a column has a new value.
struct Rhythm {
  enum class Kind {
    kNone,      ///< now and then, or too seldom to tell
    kEveryRow,  ///< or nearly
    kHeld,      ///< every few rows, and stands still in between
  } kind = Kind::kNone;
  std::vector<std::size_t> changes;  ///< rows in which it differs from the row before
  double rows = 0;                   ///< between two changes, the middle one
};

/// Whether a reading is another than the one before.
bool Differ(double a, double b);

Rhythm RhythmOf(const std::vector<double>& column);

}  // namespace hydroscope
