#include "cli/loop_log.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "models/closed_loop.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

TransferModel TransferModelOf(const Machine& machine, double sample_period) {
  const MachineKind& kind = KindOf(machine);
  TransferModel model{ClosedLoopOf(machine), {}, machine.log.hold == InputHold::kZero ? sample_period : 0};
  for (const MachineInput& known : kind.geometry) {
    const auto value = machine.Geometry(std::string(known.name));
    model.geometry.push_back(value ? value->value : known.otherwise.value_or(0));
  }
  return model;
}

/// What the machine file calls healthy; NaN where it says nothing.
std::vector<double> ReferencesOf(const Machine& machine) {
  std::vector<double> references;
  for (const LoopParameter& parameter : ClosedLoopOf(machine)->parameters) {
    const auto monitor = std::find_if(machine.monitors.begin(), machine.monitors.end(),
                                      [&](const MonitorSpec& m) { return m.parameter == parameter.name; });
    references.push_back(monitor == machine.monitors.end() ? kNaN : monitor->reference.value_or(kNaN));
  }
  return references;
}

}  // namespace

Result<LoopLog> MeasureLoopLog(const std::string& path, const Machine& machine, const LoopOptions& options) {
  const ClosedLoopPlant& plant = *ClosedLoopOf(machine);
  auto log = ReadFrfRecord(
      path, machine, {std::string(plant.input), std::string(plant.output), 1, std::string(plant.set_point)});
  if (!log) return tl::unexpected(log.error());
  TransferModel model = TransferModelOf(machine, log->record.sample_period);
  LoopOptions as_known = options;
  as_known.known = ReferencesOf(machine);
  auto response = MeasureClosedLoop(log->record, model, as_known);
  if (!response) {
    Error error = response.error();
    error.text = fmt::format("{}: {}", path, error.text);
    if (log->left_out > 0)
      error.text +=
          fmt::format("; {} of {} rows were left out ({})", log->left_out, log->rows, log->left_out_why);
    return tl::unexpected(error);
  }
  return LoopLog{path, std::move(*log), std::move(model), std::move(*response)};
}

std::vector<std::string> OutsideLimits(const Machine& machine, const LoopResponse& response) {
  std::vector<std::string> outside;
  const ClosedLoopPlant& plant = *ClosedLoopOf(machine);
  for (std::size_t i = 0; i < response.parameters.size(); ++i) {
    const LoopParameter& parameter = plant.parameters[i];
    const auto limits = std::find_if(machine.monitors.begin(), machine.monitors.end(),
                                     [&](const MonitorSpec& m) { return m.parameter == parameter.name; });
    if (limits == machine.monitors.end()) continue;
    const double value = response.parameters[i].value;
    const auto say = [&](const std::optional<double>& limit, bool below, const char* what) {
      if (!limit || (below ? value >= *limit : value <= *limit)) return false;
      outside.push_back(fmt::format("{} is {:.4g} {}, {} {:.4g} of the machine file", parameter.name,
                                    value * parameter.factor, parameter.unit, what,
                                    *limit * parameter.factor));
      return true;
    };
    say(limits->alarm_low, true, "below alarm_low") || say(limits->warn_low, true, "below warn_low");
    say(limits->alarm_high, false, "above alarm_high") || say(limits->warn_high, false, "above warn_high");
  }
  return outside;
}

}  // namespace hydroscope
