#include "service/benchmarks/recovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

#include "service/benchmarks/simulated_strokes.h"
#include "service/explain_log.h"
#include "service/machine_model.h"
#include "service/output.h"
#include "simulator/effects.h"

namespace hydroscope {
namespace {

constexpr double kMostDeviation = 3;

bool NeedsBothEdges(const std::string& effect) {
  return effect == "valve_flow_asymmetry" || effect == "spool_overlap";
}

PressOptions OptionsFor(const EffectInfo& effect, double seconds, std::uint64_t seed) {
  PressOptions options;
  options.seconds = seconds;
  options.seed = seed;
  options.oil_start = 303.15;
  options.oil_end = 323.15;
  options.effects = {{effect.id, effect.typical_size, {}}};
  return options;
}

Machine ExtendedMachine(const PressOptions& options, const std::string& effect) {
  Machine machine = MachineFor(options);
  machine.added_effects = {effect};
  // Drawing and return strokes between the rests.
  if (NeedsBothEdges(effect)) machine.gate.bounds = {{"z", false, 0.03, 0.185}};
  return machine;
}

/// Truth of a base parameter as the library's law counts it. Its curved edge is k u |u|^a, the simulator's
/// k u (|u| / normal)^a: the same law with another unit opening.
double TruthOf(const std::string& parameter, const PressOptions& options) {
  const PressMachine& m = options.machine;
  if (parameter == "K") return m.K;
  if (parameter == "V0") return m.V0;
  if (parameter == "y_0") return m.y_0;
  const EffectSetting& effect = options.effects.front();
  if (effect.id != "valve_flow_curvature") return m.Q_vn;
  return m.Q_vn * std::pow(PressEffectSizes{}.curvature_normal_opening, -effect.size);
}

const EffectInfo* InfoOf(const std::string& effect) {
  const auto& effects = PressEffects();
  const auto info =
      std::find_if(effects.begin(), effects.end(), [&](const EffectInfo& e) { return e.id == effect; });
  return info == effects.end() ? nullptr : &*info;
}

/// Counts over all logs.
struct RecoveryTally {
  int values = 0, inside = 0, sizes = 0, sizes_inside = 0, far = 0;

  void Add(const RecoveredValue& value, bool is_size) {
    const double deviation = std::abs(value.Deviation());
    const bool holds = deviation <= 1.96;
    ++values;
    inside += holds;
    far += !(deviation <= kMostDeviation);
    if (is_size) ++sizes, sizes_inside += holds;
  }
};

void PrintHeader() {
  std::cout << fmt::format("{:<28} {:>11} {:>11} {:>10} {:<17} {:>7}", "effect", "size, truth", "found",
                           "std", "unit", "dev.");
  for (const char* name : {"K'", "V0", "Q_vn", "y_0"}) std::cout << fmt::format(" {:>6}", name);
  std::cout << "\n";
}

void PrintRow(const std::string& effect, const std::vector<RecoveredValue>& values) {
  const RecoveredValue& size = values.front();
  std::cout << fmt::format("{:<28} {:>11.4g} {:>11.4g} {:>10.2g} {:<17}", effect, size.truth, size.value,
                           size.std, size.unit);
  bool far = false;
  for (const RecoveredValue& value : values) {
    std::cout << fmt::format(" {:>6.2f}", value.Deviation());
    far |= !(std::abs(value.Deviation()) <= kMostDeviation);
  }
  std::cout << (far ? "  <- missed\n" : "\n");
}

}  // namespace

Result<std::vector<RecoveredValue>> RecoverEffect(const std::string& effect, double seconds,
                                                  std::uint64_t seed) {
  const EffectInfo* info = InfoOf(effect);
  if (info == nullptr) return BadInput("the simulator has no effect '{}'", effect);
  const PressOptions options = OptionsFor(*info, seconds, seed);
  const Machine machine = ExtendedMachine(options, effect);
  const auto strokes = StrokesOf(SimulatePress(options), machine, KeepSamples::kYes);
  if (!strokes) return tl::unexpected(strokes.error());
  const auto model = FitMachineModel(*strokes);
  if (!model) return tl::unexpected(model.error());
  const EffectEstimate& size = model->fit.effects.front();
  std::vector<RecoveredValue> values = {{effect, info->unit, info->typical_size, size.size, size.std}};
  const int count = static_cast<int>(strokes->stretches.size());
  for (const Estimate& base : BaseParameters(*model->structure, model->fit, count))
    values.push_back({base.parameter, base.unit, TruthOf(base.parameter, options), base.value, base.std});
  return values;
}

int RunRecovery(const RecoveryOptions& o) {
  std::cout << fmt::format(
      "each effect of the library, simulated at its typical size and fitted with the model extended by it; "
      "{:.0f} s, seeds {} ... {}\ndev.: (found - truth) / stated standard deviation\n\n",
      o.seconds, o.seed, o.seed + static_cast<std::uint64_t>(o.seeds) - 1);
  PrintHeader();
  RecoveryTally tally;
  if (!o.effect.empty() && InfoOf(o.effect) == nullptr)
    return ReportError(Error{ErrorKind::kUsage, fmt::format("the simulator has no effect '{}'", o.effect)});
  for (const EffectInfo& effect : PressEffects()) {
    if (!o.effect.empty() && o.effect != effect.id) continue;
    for (int s = 0; s < o.seeds; ++s) {
      // Logs of their own: one unlucky draw must not show in every row.
      const std::uint64_t seed =
          1000 * (o.seed + static_cast<std::uint64_t>(s)) + (&effect - PressEffects().data());
      const auto values = RecoverEffect(effect.id, o.seconds, seed);
      if (!values) return ReportError(values.error());
      PrintRow(effect.id, *values);
      for (const RecoveredValue& value : *values) tally.Add(value, &value == &values->front());
    }
  }
  std::cout << fmt::format(
      "\n95 % intervals that hold the truth: sizes {} of {}, all parameters {} of {}; beyond "
      "3 standard deviations: {}\n",
      tally.sizes_inside, tally.sizes, tally.inside, tally.values, tally.far);
  const bool reached = o.seeds == 1
                           ? tally.far == 0
                           : tally.inside >= 0.9 * tally.values && tally.sizes_inside >= 0.9 * tally.sizes;
  std::cout << (reached ? "reached\n" : "NOT reached\n");
  return reached ? 0 : 1;
}

}  // namespace hydroscope
