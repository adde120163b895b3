#include "workbench/frequency_response/loop_change.h"

#include <algorithm>
#include <cmath>

#include "core/told_error.h"
#include "models/closed_loop.h"

namespace hydroscope {
namespace {

Result<LoopState> LoopStateOf(const LoopLog& measured) {
  if (!measured.response.fit)
    return BadInput(Tell("{}: {}", "{}: {}", measured.name, measured.response.no_fit));
  return StateOf(measured.response);
}

/// What the machine file calls healthy: references of [monitor].
Result<LoopState> ReferenceState(const Machine& machine) {
  const ClosedLoopPlant& plant = *ClosedLoopOf(machine);
  const auto count = static_cast<std::ptrdiff_t>(plant.parameters.size());
  LoopState state{{{}, Eigen::MatrixXd::Zero(count, count)}, {}};
  for (const LoopParameter& parameter : plant.parameters) {
    const auto monitor = std::ranges::find_if(
        machine.monitors, [&](const MonitorSpec& m) { return m.parameter == parameter.name; });
    const bool known = monitor != machine.monitors.end() && monitor->reference;
    if (!known && parameter.kind != LoopParameter::Kind::kDelay) {
      const Told needed = Tell(
          "explain needs something to compare with: an earlier log (--since OLD), or [monitor.{}] reference in the machine file",
          "zum Vergleich fehlt etwas: ein früheres Log, oder [monitor.{}] reference in der Maschinendatei",
          parameter.name);
      return tl::unexpected(Error{ErrorKind::kUsage, needed.english, needed.german});
    }
    state.parameters.push_back(known ? *monitor->reference : 0);
  }
  return state;
}

/// The factor of its quantity, or ms.
Told SizeOf(const SizedChange& sized) {
  if (sized.change->direction.back() != 0) return Tell("{:.2g} ms", "{:.2g} ms", 1e3 * sized.size);
  constexpr double kMost = 100;  // a factor from which on nothing is known
  const char* sign = sized.size < 0 ? "/" : "x";
  return Tell("{} {:.3g}", "{} {:.3g}", sign, std::min(kMost, std::exp(std::abs(sized.size))));
}

/// Of records that are too short, or too little excited, to show large changes.
Told WouldNotBeSeen(const LoopComparison& comparison) {
  Told list;
  for (const SizedChange& sized : comparison.unseen) {
    const Told one = Tell("{} ({})", "{} ({})", sized.change->quantity, SizeOf(sized));
    list = list.empty() ? one : Tell("{}, {}", "{}, {}", list, one);
  }
  return Tell(
      "no all-clear: of these, a smaller change than the one given would not have been seen in these records: {}; record "
      "longer, or excite more",
      "keine Entwarnung: hiervon wäre eine kleinere Änderung als die genannte in diesen Aufzeichnungen nicht zu sehen gewesen: "
      "{}; länger aufzeichnen oder stärker anregen",
      list);
}

}  // namespace

bool IsClosedLoop(const std::string& machine_file) {
  const auto machine = LoadMachine(machine_file);
  return machine && ClosedLoopOf(*machine) != nullptr;
}

Result<LoopState> LoopStateBefore(const std::string& since, const Machine& machine) {
  if (since.empty()) return ReferenceState(machine);
  const auto old = TRY(MeasureLoopLog(since, machine));
  return LoopStateOf(old);
}

Result<LoopChangeResult> ExplainLoopLog(const std::string& log, const std::string& since,
                                        const std::string& machine_file) {
  auto machine = TRY(LoadMachine(machine_file));
  const auto before = TRY(LoopStateBefore(since, machine));
  auto measured = TRY(MeasureLoopLog(log, machine));
  const auto after = TRY(LoopStateOf(measured));
  LoopComparison comparison = CompareLoopStates(*ClosedLoopOf(machine), before, after);
  if (comparison.verdict == LoopComparison::Verdict::kAdequate && !comparison.unseen.empty())
    measured.response.warnings.insert(measured.response.warnings.begin(), WouldNotBeSeen(comparison));
  return LoopChangeResult{std::move(machine), since, std::move(measured), std::move(comparison)};
}

}  // namespace hydroscope
