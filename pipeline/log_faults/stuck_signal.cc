#include "pipeline/log_faults/stuck_signal.h"

namespace hydroscope {
namespace {

constexpr double kMostRowsStuck =
    0.5;  ///< share of the rows; the rest is what a reading may stand still for before it is flagged

}  // namespace

Told StuckSignal(const RunSummary& summary, const Machine& machine, const ModelStructure& model) {
  for (const int s : model.needed_signals) {
    const SignalSpec& spec = machine.signals[static_cast<std::size_t>(s)];
    const auto channel = summary.flagged.find(spec.name);
    if (channel == summary.flagged.end()) continue;
    const auto stuck = channel->second.find("stuck");
    if (stuck == channel->second.end() || summary.rows == 0) continue;
    const double share = static_cast<double>(stuck->second) / static_cast<double>(summary.rows);
    if (share > kMostRowsStuck)
      return Tell(
          "{} (column {}): one and the same reading in {:.0f} % of the rows; is the sensor connected?",
          "{} (Spalte {}): ein und derselbe Wert in {:.0f} % der Zeilen; ist der Sensor angeschlossen?",
          spec.name, spec.column, 100 * share);
  }
  return {};
}

}  // namespace hydroscope
