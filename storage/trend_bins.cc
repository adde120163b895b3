#include <algorithm>

#include "core/constants.h"
#include "storage/connection.h"
#include "storage/database.h"

namespace hydroscope {
namespace {

/// When a stroke ended, and how warm the oil was.
struct StrokeEnd {
  double time = kNaN, oil_temperature = kNaN;
};

StrokeEnd EndOf(Connection& connection, std::int64_t run, std::int64_t stroke) {
  Query query(connection, "SELECT end_s, oil_temperature_K FROM stroke WHERE run = ? AND stroke = ?", run,
              stroke);
  return query.Step() ? StrokeEnd{query.Real(0), query.Real(1)} : StrokeEnd{};
}

/// Strokes from ... to - 1 of a run, of which those before `looked_to` are looked at.
TrendBin BinOf(Connection& connection, const RunRow& run, const std::string& parameter, std::int64_t from,
               std::int64_t to, std::int64_t looked_to) {
  TrendBin bin;
  {
    // A parameter that changed its unit has several rows in `parameter`; each stroke belongs to one of them.
    Query query(
        connection,
        "SELECT count(e.value), min(e.value), max(e.value), avg(e.value), avg(e.std), "
        "avg(e.oil_temperature_K) FROM parameter p CROSS JOIN stroke s CROSS JOIN estimate e ON e.run = "
        "s.run AND e.stroke = s.stroke AND e.parameter = p.id WHERE p.machine = ? AND p.name = ? AND "
        "s.run = ? AND s.stroke >= ? AND s.stroke < ?",
        run.machine, parameter, run.id, from, looked_to);
    query.Step();
    bin = {run.id,
           run.first_sequence + from,
           run.first_sequence + to - 1,
           query.Int(0),
           0,
           0,
           query.Real(1),
           query.Real(2),
           query.Real(3),
           query.Real(4),
           query.Real(5)};
  }
  const StrokeEnd first = EndOf(connection, run.id, from);
  const StrokeEnd last = to - 1 == from ? first : EndOf(connection, run.id, to - 1);
  bin.begin = first.time;
  bin.end = last.time;
  if (std::isnan(bin.oil_temperature)) bin.oil_temperature = last.oil_temperature;
  return bin;
}

}  // namespace

Result<std::vector<TrendBin>> Database::TrendBins(std::int64_t machine, const std::string& parameter,
                                                  std::int64_t first, std::int64_t end, std::int64_t width,
                                                  std::int64_t most) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<TrendBin>> {
    SQLite::Transaction one_snapshot(impl_->db);
    std::vector<TrendBin> bins;
    for (const RunRow& run : impl_->RunsOf(machine)) {
      const std::int64_t stop = std::min(end - run.first_sequence, run.strokes);
      for (std::int64_t from = std::max<std::int64_t>(first - run.first_sequence, 0); from < stop;) {
        const std::int64_t to = std::min(stop, (from / width + 1) * width);
        const std::int64_t looked_to = most > 0 ? std::min(to, from + most) : to;
        bins.push_back(BinOf(*impl_, run, parameter, from, to, looked_to));
        from = to;
      }
    }
    return bins;
  });
}

Result<std::int64_t> Database::SequenceNear(std::int64_t machine, double time) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::int64_t> {
    SQLite::Transaction one_snapshot(impl_->db);
    std::int64_t end = 0;
    for (const RunRow& run : impl_->RunsOf(machine)) {
      end = run.first_sequence + run.strokes;
      if (run.strokes == 0 || EndOf(*impl_, run.id, run.strokes - 1).time < time) continue;
      std::int64_t low = 0, high = run.strokes - 1;  // the one sought lies among them
      while (low < high) {
        const std::int64_t middle = (low + high) / 2;
        if (EndOf(*impl_, run.id, middle).time < time)
          low = middle + 1;
        else
          high = middle;
      }
      return run.first_sequence + low;
    }
    return end;
  });
}

}  // namespace hydroscope
