#include <algorithm>
#include <bit>

#include "core/quality.h"
#include "storage/connection.h"
#include "storage/database.h"

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

void AppendTrend(Connection& connection, const ParameterRow& parameter, std::vector<TrendPoint>& points) {
  Query query(
      connection,
      "SELECT e.run, e.stroke, r.first_sequence + e.stroke, s.end_s, s.oil_temperature_K, e.value, e.std, "
      "e.excitation, e.last_excited_s, e.reason FROM estimate e JOIN run r ON r.id = e.run "
      "JOIN stroke s ON s.run = e.run AND s.stroke = e.stroke WHERE e.parameter = ? ORDER BY e.run, e.stroke",
      parameter.id);
  while (query.Step()) {
    TrendPoint point{query.Int(0), query.Int(1), query.Int(2), query.Real(3), query.Real(4), {}};
    point.estimate = {parameter.name,
                      query.Real(5),
                      query.Real(6),
                      parameter.unit,
                      query.Real(7),
                      query.Real(8),
                      ReasonFromName(query.Text(9))};
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

Result<std::vector<TrendPoint>> Database::Trend(std::int64_t machine, const std::string& parameter) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<TrendPoint>> {
    std::vector<TrendPoint> points;
    const auto parameters = FindParameters(*impl_, machine, parameter);
    for (const ParameterRow& row : parameters) AppendTrend(*impl_, row, points);
    if (parameters.size() > 1)
      std::stable_sort(points.begin(), points.end(),
                       [](const TrendPoint& a, const TrendPoint& b) { return a.sequence < b.sequence; });
    return points;
  });
}

Result<std::vector<StrokeSummary>> Database::Strokes(std::int64_t run) const {
  return Guarded(impl_->path, &impl_->db, [&]() -> Result<std::vector<StrokeSummary>> {
    if (const auto row = impl_->FindRun(run); !row) return tl::unexpected(row.error());
    Query query(
        *impl_,
        "SELECT stroke, begin_s, end_s, oil_temperature_K, mean_speed_m_s, mean_pressure_Pa, "
        "max_pressure_Pa, "
        "rms_error_m3_s, noise_floor_m3_s, rows_seen, rows_gated, rows_used FROM stroke WHERE run = ? "
        "ORDER BY stroke",
        run);
    std::vector<StrokeSummary> strokes;
    while (query.Step()) {
      StrokeSummary s{query.Int(0),  query.Real(1), query.Real(2), query.Real(3), query.Real(4),
                      query.Real(5), query.Real(6), query.Real(7), query.Real(8), {}};
      s.counters.samples = query.Int(9);
      s.counters.gated = query.Int(10);
      s.counters.used = query.Int(11);
      strokes.push_back(s);
    }
    ReadFlags(*impl_, run, strokes);
    return strokes;
  });
}

}  // namespace hydroscope
