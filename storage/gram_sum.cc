#include <algorithm>
#include <map>

#include "core/told_error.h"
#include "storage/connection.h"
#include "storage/database.h"
#include "storage/gram_rollup.h"

namespace hydroscope {
namespace {

/// Adds Grams of strokes as long as their columns stay the same.
class GramSum {
 public:
  GramSum(Connection& connection, std::int64_t machine) : connection_(connection), machine_(machine) {}

  Status Add(int model_version, std::int64_t sequence, const StrokeGram& gram) {
    if (version_ == 0) version_ = model_version;
    if (!SameColumns(model_version) || !AddGram(sum_, gram))
      return BadInput(Tell(
          "{}: stroke {} was identified with model version {}, whose Gram columns differ from those of "
          "version {} before it; sum the strokes of one model at a time",
          "{}: Hub {} wurde mit Modellversion {} identifiziert, deren Produktsummen andere sind als die der Version "
          "{} davor; nur Hübe eines Modells zusammen nehmen",
          connection_.path, sequence, model_version, version_));
    return {};
  }
  const StrokeGram& sum() const { return sum_; }

 private:
  bool SameColumns(int model_version) {
    if (model_version == version_) return true;
    const auto [entry, added] = same_.try_emplace(model_version, false);
    if (added)
      entry->second = connection_.Columns(machine_, model_version) == connection_.Columns(machine_, version_);
    return entry->second;
  }

  Connection& connection_;
  std::int64_t machine_;
  int version_ = 0;
  std::map<int, bool> same_;
  StrokeGram sum_;
};

/// Adds the largest stored sum that starts at `at` and ends by `last`; returns how many strokes it covers, 0
/// if none.
Result<std::int64_t> AddRollup(Connection& connection, std::int64_t machine, std::int64_t at,
                               std::int64_t last, GramSum& sum) {
  for (auto group = kRollupStrokes.rbegin(); group != kRollupStrokes.rend(); ++group) {
    if (at % *group != 0 || at + *group > last) continue;
    const auto rollup = TRY(FindRollup(connection, machine, *group, at));
    if (!rollup) continue;
    TRY(sum.Add(rollup->model_version, at, rollup->gram));
    return *group;
  }
  return 0;
}

}  // namespace

Result<StrokeGram> Database::SumGrams(std::int64_t machine, std::int64_t first, std::int64_t last) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<StrokeGram> {
    SQLite::Transaction one_snapshot(impl_->db);
    const auto runs = impl_->RunsOf(machine);
    const std::int64_t end =
        runs.empty() ? 0 : std::min(last, runs.back().first_sequence + runs.back().strokes);
    GramSum sum(*impl_, machine);
    for (std::int64_t at = std::max<std::int64_t>(first, 0); at < end;) {
      const auto covered = TRY(AddRollup(*impl_, machine, at, end, sum));
      if (covered > 0) {
        at += covered;
        continue;
      }
      const std::int64_t next = std::min(end, (at / kRollupStrokes[0] + 1) * kRollupStrokes[0]);
      TRY(ForEachGram(*impl_, machine, at, next, [&](const RunRow& run, std::int64_t n, StrokeGram&& g) {
        return sum.Add(run.model_version, n, g);
      }));
      at = next;
    }
    return sum.sum();
  });
}

}  // namespace hydroscope
