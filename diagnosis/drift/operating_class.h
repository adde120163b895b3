#pragma once

#include <vector>

#include "core/bytes.h"
#include "diagnosis/drift/watched_model.h"

namespace hydroscope::drift {

/// Kinds of stroke a machine makes: a press, a tool with its speed and pressure profile. Strokes belong together if the
/// conditions that the machine declares differ by no more than some tens of percent (leader clustering, Hartigan 1975, in
/// logarithms). `model` declares them, the same one in every call.
class OperatingClasses {
 public:
  static constexpr int kMostClasses = 64;

  /// Class of a stroke, -1 if it is like none.
  int Find(const WatchedModel& model, const StrokeEvidence& stroke) const;
  /// The same, a new class if it is like none; -1 if there are kMostClasses already.
  int FindOrAdd(const WatchedModel& model, const StrokeEvidence& stroke);
  /// Whether the conditions lie within those of the classes, or no farther outside than a class is wide.
  bool Encloses(const WatchedModel& model, const StrokeEvidence& stroke) const;
  int count() const { return static_cast<int>(centres_.size()); }

  void Save(ByteWriter& out) const;
  bool Restore(ByteReader& in);

 private:
  using Features = std::vector<double>;  ///< logarithms of the conditions
  static Features FeaturesOf(const WatchedModel& model, const StrokeEvidence& stroke);
  std::vector<Features> centres_;
};

}  // namespace hydroscope::drift
