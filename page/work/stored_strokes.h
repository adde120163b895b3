#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "page/api_arguments.h"
#include "workbench/model/promotion.h"

namespace hydroscope {

/// Strokes of a stretch that can be worked on: the newest whose raw rows are kept.
struct KeptStrokes {
  static constexpr std::int64_t kMost = 200;  ///< more make the workbench slow and tell little that is new

  struct Piece {
    std::int64_t first = 0, last = 0;
    std::string log;  ///< piece of the raw window (ParseRawName), or the whole log that was replayed
  };
  std::vector<Piece> pieces;  ///< one of each run
  std::string definition;     ///< machine file with the model in force
};
/// Errors: no such machine or strokes, the database cannot be read, or neither raw rows of them nor the log they came from are there.
Result<KeptStrokes> FindKeptStrokes(const std::string& database, const StrokeStretch& stretch);

/// Promotes a machine file for a machine of the database at `path`. Errors: no such machine, or as of Promote.
Status PromoteWorkedOn(const std::string& path, Promotion promotion);

}  // namespace hydroscope
