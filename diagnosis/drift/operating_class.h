#pragma once

#include <array>
#include <vector>

#include "core/bytes.h"
#include "diagnosis/drift/watched_model.h"

namespace hydroscope::drift {

/// Kinds of stroke a press makes: a tool with its speed and pressure profile. Strokes belong together if ram
/// speed, mean and highest pressure differ by no more than some tens of percent (leader clustering, Hartigan
/// 1975, in logarithms).
class OperatingClasses {
 public:
  static constexpr double kRadius = 0.25;  ///< distance in logarithms: some 25 % in one of the three
  static constexpr int kMostClasses = 64;

  /// Class of a stroke, -1 if it is like none.
  int Find(const StrokeEvidence& stroke) const;
  /// The same, a new class if it is like none; -1 if there are kMostClasses already.
  int FindOrAdd(const StrokeEvidence& stroke);
  /// Whether speed and pressures lie within those of the classes, or no farther outside than a class is wide.
  bool Encloses(const StrokeEvidence& stroke) const;
  int count() const { return static_cast<int>(centres_.size()); }
  double speed(int index) const;     ///< m/s
  double pressure(int index) const;  ///< Pa, mean

  void Save(ByteWriter& out) const;
  bool Restore(ByteReader& in);

 private:
  using Features = std::array<double, 3>;
  static Features FeaturesOf(const StrokeEvidence& stroke);
  std::vector<Features> centres_;
};

}  // namespace hydroscope::drift
