#include "storage/stroke_row.h"

namespace hydroscope {

StrokeSummary ReadStrokeRow(const Query& query, int first, std::int64_t index) {
  int column = first;
  StrokeSummary s;
  s.index = index;
  s.begin = query.Real(column++);
  s.end = query.Real(column++);
  s.oil_temperature = query.Real(column++);
  for (double& condition : s.conditions) condition = query.Real(column++);
  s.rms_error = query.Real(column++);
  s.noise_floor = query.Real(column++);
  s.counters.samples = query.Int(column++);
  s.counters.gated = query.Int(column++);
  s.counters.used = query.Int(column++);
  return s;
}

}  // namespace hydroscope
