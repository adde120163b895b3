#pragma once

#include <cstdint>
#include <string>

#include "core/result.h"
#include "models/counted_words.h"

namespace hydroscope {

struct StoredReport {
  std::string machine;
  std::int64_t strokes = 0;
  CountedWords counted;  ///< what these are
  std::size_t runs = 0;
  std::int64_t alarms = 0;  ///< that are active
};

/// Writes the maintenance report of a machine of a database: what was recorded, what stands in its journal, and what
/// `explain` finds in its strokes. Only reads, so that a service may write meanwhile. `machine`: "" = the only one. `not_stored`:
/// why that service can store nothing now, which leads the page; "" = it can.
/// Errors: no database, no such machine or several, no strokes, the page cannot be written.
Result<StoredReport> WriteStoredReport(const std::string& database, const std::string& machine,
                                       const std::string& page, const std::string& not_stored = "");

}  // namespace hydroscope
