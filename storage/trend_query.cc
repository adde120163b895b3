#include <algorithm>
#include <bit>
#include <map>

#include "core/records/quality.h"
#include "storage/connection.h"
#include "storage/database.h"
#include "storage/stroke_row.h"

namespace hydroscope {
namespace {

struct ParameterRow {
  std::string name, unit;
};

/// Those of a name, or all of a machine (""), by their number in the database.
std::map<std::int64_t, ParameterRow> FindParameters(Connection& connection, std::int64_t machine,
                                                    const std::string& name) {
  Query query(connection,
              "SELECT id, name, unit FROM parameter WHERE machine = ?1 AND (?2 = '' OR name = ?2)", machine,
              name);
  std::map<std::int64_t, ParameterRow> rows;
  while (query.Step()) rows[query.Int(0)] = {query.Text(1), query.Text(2)};
  return rows;
}

EstimateReason ReasonFromName(const std::string& name) {
  for (const EstimateReason reason :
       {EstimateReason::kUpdated, EstimateReason::kNoStroke, EstimateReason::kTooShort,
        EstimateReason::kNotExcited, EstimateReason::kConfounded, EstimateReason::kOutsidePhysics,
        EstimateReason::kPoorSignal})
    if (name == ReasonName(reason)) return reason;
  return EstimateReason::kNoStroke;
}

/// Estimates of strokes from ... to - 1 of a run.
void ReadTrend(Connection& connection, const RunRow& run,
               const std::map<std::int64_t, ParameterRow>& parameters, std::int64_t from, std::int64_t to,
               std::vector<TrendPoint>& points) {
  Query query(
      connection,
      "SELECT s.stroke, s.end_s, s.oil_temperature_K, e.parameter, e.value, e.std, e.excitation, "
      "e.last_excited_s, e.reason, e.oil_temperature_K FROM stroke s JOIN estimate e ON e.run = s.run AND "
      "e.stroke = s.stroke WHERE s.run = ? AND s.stroke >= ? AND s.stroke < ? ORDER BY s.stroke, e.parameter",
      run.id, from, to);
  while (query.Step()) {
    const auto parameter = parameters.find(query.Int(3));
    if (parameter == parameters.end()) continue;
    TrendPoint point{run.id,        query.Int(0),  run.first_sequence + query.Int(0),
                     query.Real(1), query.Real(2), {}};
    point.estimate = {parameter->second.name,        query.Real(4), query.Real(5),
                      parameter->second.unit,        query.Real(6), query.Real(7),
                      ReasonFromName(query.Text(8)), query.Real(9)};
    points.push_back(std::move(point));
  }
}

/// Bit of a flag name in `stroke_flag`; 16 if the name is unknown.
std::size_t FlagBit(const std::string& name) {
  for (const auto& [flag, flag_name] : quality::kFlagNames)
    if (flag_name == name) return static_cast<std::size_t>(std::countr_zero(flag));
  if (name.rfind("bit_", 0) == 0) return std::min<std::size_t>(std::stoul(name.substr(4)), 16);
  return 16;
}

void ReadFlags(Connection& connection, std::int64_t run, std::vector<StrokeSummary>& strokes) {
  Query query(connection, "SELECT stroke, flag, rows FROM stroke_flag WHERE run = ?", run);
  while (query.Step()) {
    const auto stroke = static_cast<std::size_t>(query.Int(0));
    const std::size_t bit = FlagBit(query.Text(1));
    if (stroke < strokes.size() && bit < 16) strokes[stroke].counters.flagged[bit] = query.Int(2);
  }
}

}  // namespace

Result<std::vector<TrendPoint>> Database::Trend(std::int64_t machine, const std::string& parameter,
                                                std::int64_t first, std::int64_t end) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<TrendPoint>> {
    SQLite::Transaction one_snapshot(impl_->db);
    const auto parameters = FindParameters(*impl_, machine, parameter);
    std::vector<TrendPoint> points;
    for (const RunRow& run : impl_->RunsOf(machine)) {
      const std::int64_t from = std::max<std::int64_t>(first - run.first_sequence, 0);
      const std::int64_t to = std::min(end - run.first_sequence, run.strokes);
      if (from < to) ReadTrend(*impl_, run, parameters, from, to, points);
    }
    return points;
  });
}

Result<std::vector<std::string>> Database::ParameterNames(std::int64_t machine) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<std::string>> {
    std::vector<std::string> names;
    for (const auto& [id, row] : FindParameters(*impl_, machine, "")) names.push_back(row.name);
    return names;
  });
}

Result<std::vector<StrokeSummary>> Database::Strokes(std::int64_t run) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<StrokeSummary>> {
    TRY(impl_->FindRun(run));
    const std::string select =
        fmt::format("SELECT stroke, {} FROM stroke WHERE run = ? ORDER BY stroke", kStrokeColumns);
    Query query(*impl_, select.c_str(), run);
    std::vector<StrokeSummary> strokes;
    while (query.Step()) strokes.push_back(ReadStrokeRow(query, 1, query.Int(0)));
    ReadFlags(*impl_, run, strokes);
    return strokes;
  });
}

}  // namespace hydroscope
