#include "cli/frequency_response/loop_explain.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/frequency_response/loop_report.h"
#include "diagnosis/closed_loop/change.h"
#include "host/output.h"
#include "models/closed_loop.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

Result<LoopState> StateOf(const LoopLog& measured) {
  if (!measured.response.fit) return BadInput("{}: {}", measured.name, measured.response.no_fit);
  return LoopState{*measured.response.fit, measured.response.input_limit};
}

/// What the machine file calls healthy: references of [monitor], a delay of 0 where it has none.
Result<LoopState> ReferenceState(const Machine& machine, const std::string& machine_file) {
  const ClosedLoopPlant& plant = *ClosedLoopOf(machine);
  const auto count = static_cast<std::ptrdiff_t>(plant.parameters.size());
  LoopState state{{{}, Eigen::MatrixXd::Zero(count, count)}, std::nullopt};
  for (const LoopParameter& parameter : plant.parameters) {
    const auto monitor = std::find_if(machine.monitors.begin(), machine.monitors.end(),
                                      [&](const MonitorSpec& m) { return m.parameter == parameter.name; });
    const bool known = monitor != machine.monitors.end() && monitor->reference;
    if (!known && parameter.kind != LoopParameter::Kind::kDelay)
      return UsageError(
          "explain needs something to compare with: --since OLD, an earlier log, or [monitor.{}] reference in {}",
          parameter.name, machine_file);
    state.parameters.push_back(known ? *monitor->reference : 0);
  }
  return state;
}

}  // namespace

bool IsClosedLoop(const std::string& machine_file) {
  const auto machine = LoadMachine(machine_file);
  return machine && ClosedLoopOf(*machine) != nullptr;
}

Status ExplainClosedLoop(const std::string& log, const std::string& since, const std::string& machine_file,
                         const std::string& json) {
  const auto machine = LoadMachine(machine_file);
  if (!machine) return tl::unexpected(machine.error());
  Result<LoopState> before = LoopState{};
  if (since.empty()) {
    before = ReferenceState(*machine, machine_file);
  } else {
    const auto old = MeasureLoopLog(since, *machine);
    if (!old) return tl::unexpected(old.error());
    before = StateOf(*old);
  }
  if (!before) return tl::unexpected(before.error());
  const auto measured = MeasureLoopLog(log, *machine);
  if (!measured) return tl::unexpected(measured.error());
  const auto after = StateOf(*measured);
  if (!after) return tl::unexpected(after.error());
  const LoopComparison comparison = CompareLoopStates(*ClosedLoopOf(*machine), *before, *after);
  return Answer(LoopChangeText(comparison, *measured, *machine, since),
                LoopChangeJson(comparison, *measured, *machine, since), json);
}

}  // namespace hydroscope
