#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "core/bytes.h"
#include "diagnosis/drift/drift_monitor.h"

namespace hydroscope {

/// A named finding of one axis and the strokes during which it stood.
struct StandingFinding {
  static constexpr std::int64_t kStillStands = std::numeric_limits<std::int64_t>::max();

  std::int64_t number = 0;                   ///< that of drift::DriftFinding
  std::int64_t since = 0;                    ///< first stroke behind the change
  std::int64_t from = 0, to = kStillStands;  ///< named at this stroke, gone at that one
  double from_time = 0, to_time = 0;         ///< s, machine time of these strokes
  std::string alarm;                         ///< id of its alarm
  std::map<std::string, int> movements;      ///< quantity -> +1, -1

  bool StandsAt(std::int64_t stroke) const { return from <= stroke && stroke < to; }
};

/// The named findings of one axis, gone ones too, so that several axes can be compared at any stroke,
/// whichever of them was judged first.
class FindingHistory {
 public:
  static constexpr std::size_t kRemembered = 64;  ///< the newest

  /// What stands after a stroke, to be told after each.
  void Follow(const std::vector<drift::DriftFinding>& findings, std::int64_t stroke, double time);
  /// Nothing stands any more: another reference is in force.
  void EndAll(std::int64_t stroke, double time) { Follow({}, stroke, time); }
  /// In order of being named.
  const std::vector<StandingFinding>& findings() const { return findings_; }

  void Save(ByteWriter& out) const;
  /// False if the bytes are damaged.
  bool Restore(ByteReader& in);

 private:
  std::vector<StandingFinding> findings_;
};

}  // namespace hydroscope
