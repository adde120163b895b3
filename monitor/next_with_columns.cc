#include "monitor/next_with_columns.h"

#include <algorithm>
#include <map>

namespace hydroscope {

Result<std::int64_t> NextWithColumns(const Database& database, std::int64_t machine, int columns,
                                     std::int64_t sequence) {
  const auto runs = database.Runs(machine);
  if (!runs) return tl::unexpected(runs.error());
  std::map<int, bool> fits;  // by version
  for (const RunInfo& run : *runs) {
    const std::int64_t end = run.first_sequence + run.strokes;
    if (end <= sequence) continue;
    if (!fits.contains(run.model_version)) {
      const auto version = database.GetModelVersion(machine, run.model_version);
      if (!version) return tl::unexpected(version.error());
      fits[run.model_version] =
          version->columns.empty() || static_cast<int>(version->columns.size()) == columns;
    }
    if (fits[run.model_version]) return std::max(sequence, run.first_sequence);
    sequence = end;
  }
  return sequence;
}

}  // namespace hydroscope
