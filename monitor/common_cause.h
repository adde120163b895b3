#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "diagnosis/drift/rules.h"
#include "monitor/finding_history.h"

namespace hydroscope {

/// Strokes during which several axes showed what a rule about several axes asks for.
struct CommonCause {
  struct Member {
    int axis = 0;  ///< index of its history
    StandingFinding finding;
  };
  std::int64_t from = 0, to = StandingFinding::kStillStands;
  double from_time = 0, to_time = 0;  ///< s, machine time
  std::vector<Member> members;        ///< in order of their changes; those of the last stroke of it

  bool StillStands() const { return to == StandingFinding::kStillStands; }
};

/// When at least `rule.axes` axes had findings that match the rule and began within `rule.within` strokes, in
/// order of time. Strokes are counted by each axis for itself: axes of one press are taken to have made the
/// same strokes. A pure function of what stood when: it does not matter in which order the axes were judged.
std::vector<CommonCause> CommonCauses(const drift::Rule& rule, std::span<const FindingHistory* const> axes);

}  // namespace hydroscope
