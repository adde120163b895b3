#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "core/told_error.h"
#include "storage/connection.h"
#include "storage/database.h"
#include "storage/stroke_row.h"

namespace hydroscope {

Result<std::int64_t> Database::EndSequence(std::int64_t machine) const {
  return Guarded(impl_->path, &impl_->db,
                 [&]() -> Result<std::int64_t> { return NextSequence(impl_->RunsOf(machine)); });
}

Result<StoredCounts> Database::CountStored() const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<StoredCounts> {
    SQLite::Transaction one_snapshot(impl_->db);
    StoredCounts counts;
    Query runs(*impl_, "SELECT count(*), coalesce(sum(strokes), 0) FROM run");
    runs.Step();
    runs.Read(0, counts.runs, counts.strokes);
    Query checks(
        *impl_,
        "SELECT coalesce(sum((SELECT max(number) FROM valve_check WHERE machine = m.id)), 0) FROM machine m");
    checks.Step();
    counts.valve_checks = checks.Int(0);
    return counts;
  });
}

Result<std::int64_t> Database::SequenceAt(std::int64_t machine, double time) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::int64_t> {
    SQLite::Transaction one_snapshot(impl_->db);
    const auto runs = impl_->RunsOf(machine);
    double before = -std::numeric_limits<double>::infinity();
    std::optional<std::int64_t> found;
    for (const RunRow& run : runs) {
      if (run.strokes == 0) continue;
      Query ends(*impl_, "SELECT min(begin_s), max(end_s) FROM stroke WHERE run = ?", run.id);
      ends.Step();
      if (ends.Real(0) < before)
        return BadInput(Tell(
            "{}: the time of log {} (run {}) begins at {:.6g} s, before the log ahead of it ended ({:.6g} "
            "s), so a time does not tell which log is meant; give its "
            "number, or run:{} for where a log begins",
            "{}: die Zeit von Log {} (Lauf {}) beginnt bei {:.6g} s, bevor das Log davor endete ({:.6g} s); eine Zeit "
            "sagt also nicht, welches gemeint ist: seine Nummer angeben, oder run:{} für seinen Beginn",
            impl_->path, run.source, run.id, ends.Real(0), before, run.id));
      before = ends.Real(1);
      if (found || before < time) continue;
      Query first(*impl_, "SELECT min(stroke) FROM stroke WHERE run = ? AND end_s >= ?", run.id, time);
      first.Step();
      found = run.first_sequence + first.Int(0);
    }
    return found.value_or(NextSequence(runs));
  });
}

Result<std::vector<StrokeSummary>> Database::SummariesOf(std::int64_t machine, std::int64_t first,
                                                         std::int64_t last, std::int64_t most) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<StrokeSummary>> {
    SQLite::Transaction one_snapshot(impl_->db);
    const auto runs = impl_->RunsOf(machine);
    first = std::max<std::int64_t>(first, 0);
    last = std::min(last, NextSequence(runs));
    const std::int64_t step =
        std::max<std::int64_t>(1, (last - first + most - 1) / std::max<std::int64_t>(most, 1));
    const std::string select =
        fmt::format("SELECT {} FROM stroke WHERE run = ? AND stroke = ?", kStrokeColumns);
    std::vector<StrokeSummary> summaries;
    for (const RunRow& run : runs)
      for (std::int64_t at =
               first + (std::max(run.first_sequence - first, std::int64_t{0}) + step - 1) / step * step;
           at < std::min(last, run.first_sequence + run.strokes); at += step) {
        Query query(*impl_, select.c_str(), run.id, at - run.first_sequence);
        if (query.Step()) summaries.push_back(ReadStrokeRow(query, 0, at));
      }
    return summaries;
  });
}

}  // namespace hydroscope
