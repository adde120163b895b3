#include "workbench/frequency_response/loop_log.h"

#include <algorithm>

#include "estimation/closed_loop/loop_episodes.h"
#include "models/closed_loop.h"
#include "pipeline/log_faults/physical_sizes.h"

namespace hydroscope {

Result<LoopLog> MeasureLoopLog(const std::string& path, const Machine& machine, const LoopOptions& options) {
  const ClosedLoopPlant& plant = *ClosedLoopOf(machine);
  TRY(JudgeSizes(path, machine));
  auto log = TRY(ReadFrfRecord(
      path, machine, {std::string(plant.input), std::string(plant.output), 1, std::string(plant.set_point)}));
  TransferModel model = TransferModelOf(machine, log.record.sample_period);
  LoopOptions as_known = options;
  as_known.known = ReferencesOf(machine);
  auto response = MeasureClosedLoop(log.record, model, as_known);
  if (!response) return tl::unexpected(NotMeasured(path, response.error(), log));
  return LoopLog{path, std::move(log), std::move(model), std::move(*response)};
}

std::vector<Told> RowWarnings(const FrfRecord& log) {
  std::vector<Told> warnings;
  if (log.left_out > 0)
    warnings.push_back(Tell("{} of {} rows left out ({})", "{} von {} Zeilen ausgelassen ({})", log.left_out,
                            log.rows, log.left_out_why));
  for (const Told& text : {log.time_base, log.twins})
    if (!text.empty()) warnings.push_back(text);
  warnings.insert(warnings.end(), log.outside_declared.begin(), log.outside_declared.end());
  return warnings;
}

std::vector<Told> OutsideLimits(const Machine& machine, const LoopResponse& response) {
  std::vector<Told> outside;
  const ClosedLoopPlant& plant = *ClosedLoopOf(machine);
  for (std::size_t i = 0; i < response.parameters.size(); ++i) {
    const LoopParameter& parameter = plant.parameters[i];
    const auto limits = std::ranges::find_if(
        machine.monitors, [&](const MonitorSpec& m) { return m.parameter == parameter.name; });
    if (limits == machine.monitors.end()) continue;
    const double value = response.parameters[i].value;
    const auto say = [&](const std::optional<double>& limit, bool below, const Wording& what) {
      if (!limit || (below ? value >= *limit : value <= *limit)) return false;
      outside.push_back(Tell("{} is {:.4g} {}, {} {:.4g} of the machine file",
                             "{} ist {:.4g} {}, {} {:.4g} der Maschinendatei", parameter.name,
                             value * parameter.factor, parameter.unit, what, *limit * parameter.factor));
      return true;
    };
    say(limits->alarm_low, true, {"below alarm_low", "unter alarm_low"}) ||
        say(limits->warn_low, true, {"below warn_low", "unter warn_low"});
    say(limits->alarm_high, false, {"above alarm_high", "über alarm_high"}) ||
        say(limits->warn_high, false, {"above warn_high", "über warn_high"});
  }
  return outside;
}

}  // namespace hydroscope
