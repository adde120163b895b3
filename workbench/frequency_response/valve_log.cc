#include "workbench/frequency_response/valve_log.h"

#include <algorithm>

#include "core/told_error.h"

namespace hydroscope {

bool ValveLog::Complete() const {
  if (!response.model || log.left_out > 0) return false;
  if (response.method == FrequencyResponseMethod::kWelch)
    return true;  // bins without excitation are expected
  return std::all_of(response.points.begin(), response.points.end(), [](const FrequencyPoint& p) {
    return p.reason == PointReason::kUsed || p.reason == PointReason::kOutsideRange;
  });
}

std::vector<const FrequencyPoint*> ValveLog::Used() const {
  std::vector<const FrequencyPoint*> used;
  for (const FrequencyPoint& p : response.points)
    if (p.reason == PointReason::kUsed) used.push_back(&p);
  return used;
}

Result<ValveLog> MeasureValveLog(const std::string& path, const Machine& machine,
                                 const FrequencyResponseOptions& options) {
  if (const Status valid = options.Validate(); !valid) return tl::unexpected(valid.error());
  auto log = ReadValveRecord(path, machine);
  if (!log) return tl::unexpected(log.error());
  auto response = MeasureFrequencyResponse(log->record, options);
  if (!response) {
    const Told left_out = log->left_out > 0 ? Tell("; {} of {} rows were left out ({})",
                                                   "; {} von {} Zeilen wurden ausgelassen ({})",
                                                   log->left_out, log->rows, log->left_out_why)
                                            : Told();
    const Told why = Tell("{} ({} -> {}): {}{}", "{} ({} -> {}): {}{}", path, machine.valve.input,
                          machine.valve.output, ToldOf(response.error()), left_out);
    return tl::unexpected(Error{response.error().kind, why.english, why.german});
  }
  return ValveLog{path, std::move(*log), std::move(*response)};
}

}  // namespace hydroscope
