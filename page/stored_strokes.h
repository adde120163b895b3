#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "page/api_arguments.h"

namespace hydroscope {

/// Strokes of a stretch that can be worked on: the newest whose raw rows are kept.
struct KeptStrokes {
  static constexpr std::int64_t kMost = 200;  ///< more make the workbench slow and tell little that is new

  struct Piece {
    std::int64_t first = 0, last = 0;
    std::string log;  ///< piece of the raw window (ParseRawName)
  };
  std::vector<Piece> pieces;  ///< one of each run
  std::string definition;     ///< machine file with the model in force
};
/// Errors: no such machine or strokes, the database cannot be read, or no raw rows of them are kept.
Result<KeptStrokes> FindKeptStrokes(const std::string& database, const StrokeStretch& stretch);

/// A model for a machine of a trend database.
struct Promotion {
  std::string database, machine;
  std::string text;           ///< machine file
  std::string user, comment;  ///< for the alarm journal beside the database
};
/// Makes it the model of replay and service (Database::PromoteModel) and tells it to the alarm journal, if there is one.
/// Errors: the machine file is wrong, no such machine, database or journal cannot be written.
Status Promote(const Promotion& promotion);

}  // namespace hydroscope
