#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// One run of the live service against the replay of its raw rows.
struct VerifiedRun {
  std::string axis;
  std::int64_t run = 0, rows = 0, strokes = 0;
  enum class Outcome { kSame, kDiffers, kNotKept } outcome = Outcome::kSame;
  std::string detail;  ///< what differs, or why it could not be compared
};

/// Replays every run of the service whose raw rows are all kept, with the machine file and the starting state
/// the run had, and compares strokes, estimates and Grams with what is stored, to the last bit.
Result<std::vector<VerifiedRun>> VerifyLive(const std::string& database);

}  // namespace hydroscope
