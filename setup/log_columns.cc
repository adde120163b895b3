#include "setup/log_columns.h"

#include <cmath>

#include "core/constants.h"
#include "core/quantile.h"
#include "replay/time_check.h"
#include "setup/log_shape.h"

namespace hydroscope {
namespace {

/// A name that a machine file can hold and that leads back to this column, else the column's number.
std::string ReferenceOf(const LogLayout& layout, std::size_t column) {
  const std::string& name = layout.names[column];
  if (!name.empty() && layout.Find(name) == column) return name;
  return std::to_string(column + 1);
}

double StandardDeviation(const std::vector<double>& values) {
  if (values.empty()) return 0;
  double mean = 0, square = 0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) square += (value - mean) * (value - mean);
  return std::sqrt(square / static_cast<double>(values.size()));
}

/// Mean step from the first to the last change of a column that never falls, whose changes are rarer than its rows: time stamps
/// coarser than these. 0 of any other column.
double StepOfCoarseClock(const std::vector<double>& values) {
  std::size_t first = 0, last = 0;
  for (std::size_t k = 1; k < values.size(); ++k) {
    if (values[k] < values[k - 1]) return 0;
    if (values[k] == values[k - 1]) continue;
    if (first == 0) first = k;
    last = k;
  }
  return last > first ? (values[last] - values[first]) / static_cast<double>(last - first) : 0;
}

void Describe(LogColumn& column) {
  std::vector<double> values, steps;
  std::size_t same = 0;
  column.rising = true;
  for (const double value : column.value) {
    if (std::isnan(value)) continue;
    if (!values.empty()) {
      steps.push_back(value - values.back());
      same += steps.back() == 0;
      column.rising = column.rising && steps.back() > 0;
    }
    values.push_back(value);
  }
  column.rising = column.rising && values.size() > 2;
  const double spread = StandardDeviation(values);
  column.roughness = spread > 0 ? StandardDeviation(steps) / spread : 0;
  column.repeated = steps.empty() ? 0 : static_cast<double>(same) / static_cast<double>(steps.size());
  column.step = steps.empty() ? 0 : Quantile(steps, 0.5, kNaN);
  if (column.repeated >= kCoarseShare)
    if (const double step = StepOfCoarseClock(values); step > 0) column.step = step;
  column.low = Quantile(values, 0.01, kNaN);
  column.high = Quantile(values, 0.99, kNaN);
}

}  // namespace

Result<LogColumns> ReadLogColumns(const std::string& path) {
  auto head = TRY(ReadLogHead(path, kRowsLookedAt));
  TRY(CheckShape(head, path));
  LogColumns log;
  log.path = path;
  log.rows = head.rows();
  log.layout = std::move(head.layout);
  for (std::size_t i = 0; i < log.layout.names.size(); ++i) {
    LogColumn column;
    column.reference = ReferenceOf(log.layout, i);
    column.name = log.layout.names[i];
    column.unit = log.layout.units[i];
    column.date = head.is_date[i];
    column.value = std::move(head.columns[i]);
    for (double& value : column.value)
      if (!std::isfinite(value)) value = kNaN;
    Describe(column);
    log.columns.push_back(std::move(column));
  }
  return log;
}

}  // namespace hydroscope
