#include "workbench/frequency_response/valve_log.h"

#include <algorithm>

namespace hydroscope {

bool ValveLog::Complete() const {
  if (!response.model || log.left_out > 0) return false;
  if (response.method == FrequencyResponseMethod::kWelch)
    return true;  // bins without excitation are expected
  return std::ranges::all_of(response.points, [](const FrequencyPoint& p) {
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
  TRY(options.Validate());
  auto log = TRY(ReadValveRecord(path, machine));
  auto response = MeasureFrequencyResponse(log.record, options);
  if (!response) {
    const std::string what = fmt::format("{} ({} -> {})", path, machine.valve.input, machine.valve.output);
    return tl::unexpected(NotMeasured(what, response.error(), log));
  }
  return ValveLog{path, std::move(log), std::move(*response)};
}

}  // namespace hydroscope
