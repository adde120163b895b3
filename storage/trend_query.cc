#include <algorithm>
#include <bit>
#include <limits>

#include "core/records/quality.h"
#include "storage/connection.h"
#include "storage/database.h"
#include "storage/stroke_row.h"

namespace hydroscope {
namespace {

struct ParameterRow {
  std::int64_t id = 0;
  std::string name, unit;
};

std::vector<ParameterRow> FindParameters(Connection& connection, std::int64_t machine,
                                         const std::string& name) {
  Query query(
      connection,
      "SELECT id, name, unit FROM parameter WHERE machine = ?1 AND (?2 = '' OR name = ?2) ORDER BY id",
      machine, name);
  std::vector<ParameterRow> rows;
  while (query.Step()) rows.push_back({query.Int(0), query.Text(1), query.Text(2)});
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

/// Where the machine-wide stroke `sequence` lies.
struct Place {
  std::int64_t run = 0, stroke = 0;
};

Place FindPlace(const std::vector<RunRow>& runs, std::int64_t sequence) {
  Place place;
  for (const RunRow& run : runs)
    if (run.first_sequence <= sequence) place = {run.id, sequence - run.first_sequence};
  return place;
}

std::vector<TrendPoint> ReadTrend(Connection& connection, const ParameterRow& parameter, const Place& from,
                                  const Place& end) {
  Query query(
      connection,
      "SELECT e.run, e.stroke, r.first_sequence + e.stroke, s.end_s, s.oil_temperature_K, e.value, e.std, "
      "e.excitation, e.last_excited_s, e.reason, e.oil_temperature_K FROM estimate e JOIN run r ON r.id = "
      "e.run JOIN stroke s ON s.run = e.run AND s.stroke = e.stroke WHERE e.parameter = ? AND (e.run, "
      "e.stroke) >= (?, ?) AND (e.run, e.stroke) < (?, ?) ORDER BY e.run, e.stroke",
      parameter.id, from.run, from.stroke, end.run, end.stroke);
  std::vector<TrendPoint> points;
  while (query.Step()) {
    TrendPoint point{query.Int(0), query.Int(1), query.Int(2), query.Real(3), query.Real(4), {}};
    point.estimate = {parameter.name,
                      query.Real(5),
                      query.Real(6),
                      parameter.unit,
                      query.Real(7),
                      query.Real(8),
                      ReasonFromName(query.Text(9)),
                      query.Real(10)};
    points.push_back(std::move(point));
  }
  return points;
}

/// Trends in order of sequence become one, in order of sequence and within a stroke in the order given.
std::vector<TrendPoint> Merged(std::vector<std::vector<TrendPoint>> trends) {
  if (trends.size() == 1) return std::move(trends.front());
  std::size_t size = 0;
  for (const auto& trend : trends) size += trend.size();
  std::vector<std::size_t> next(trends.size(), 0);
  std::vector<TrendPoint> merged;
  merged.reserve(size);
  while (merged.size() < size) {
    std::int64_t sequence = std::numeric_limits<std::int64_t>::max();
    for (std::size_t i = 0; i < trends.size(); ++i)
      if (next[i] < trends[i].size()) sequence = std::min(sequence, trends[i][next[i]].sequence);
    for (std::size_t i = 0; i < trends.size(); ++i)
      if (next[i] < trends[i].size() && trends[i][next[i]].sequence == sequence)
        merged.push_back(std::move(trends[i][next[i]++]));
  }
  return merged;
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
    const std::vector<RunRow> runs = impl_->RunsOf(machine);
    const Place from = FindPlace(runs, first), to = FindPlace(runs, end);
    std::vector<std::vector<TrendPoint>> trends;
    for (const ParameterRow& row : FindParameters(*impl_, machine, parameter))
      trends.push_back(ReadTrend(*impl_, row, from, to));
    return Merged(std::move(trends));
  });
}

Result<std::vector<std::string>> Database::ParameterNames(std::int64_t machine) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<std::string>> {
    std::vector<std::string> names;
    for (const ParameterRow& row : FindParameters(*impl_, machine, "")) names.push_back(row.name);
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
