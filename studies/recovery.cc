#include "studies/recovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <random>

#include "core/constants.h"
#include "host/output.h"
#include "models/machine_kind.h"
#include "simulator/die_cushion/effects.h"
#include "studies/random_effect.h"
#include "studies/simulated_strokes.h"
#include "workbench/explain/explain_log.h"
#include "workbench/model/machine_model.h"

namespace hydroscope {
namespace {

constexpr double kMostDeviation = 3;

bool NeedsBothEdges(const std::string& effect) {
  return effect == "valve_flow_asymmetry" || effect == "spool_overlap";
}

/// The effect at a size from half to twice its typical one, with any gas.
EffectSetting AnySetting(const EffectInfo& effect, std::mt19937_64& random) {
  constexpr double kIsothermal = 1.0, kAdiabatic = 1.4;
  EffectSetting setting = RandomSize(random, effect.id, 0.5, 2.0);
  for (const EffectExtra& extra : effect.extras)
    if (extra.name == "exponent")
      setting.extra[extra.name] = kIsothermal + (kAdiabatic - kIsothermal) * Uniform(random);
  return setting;
}

PressOptions OptionsFor(const EffectInfo& effect, double seconds, std::uint64_t seed, bool any) {
  std::mt19937_64 random(seed);
  PressOptions options = any ? RandomMachine(random() >> 32) : PressOptions{};
  options.seconds = seconds;
  options.seed = seed;
  options.oil_start = 303.15;
  options.oil_end = 323.15;
  options.effects = {any ? AnySetting(effect, random) : EffectSetting{effect.id, effect.typical_size, {}}};
  return options;
}

/// Numbers of the simulated law beside those that the model's law has for its shape, which come first in both.
std::vector<RecoveredValue> RecoveredShapes(const EffectInfo& info, const EffectSetting& truth,
                                            const Effect& effect, const EffectEstimate& found,
                                            const std::vector<double>& nonlinear) {
  std::vector<RecoveredValue> out;
  for (std::size_t i = 0; !effect.implied && i < std::min(nonlinear.size(), info.extras.size()); ++i) {
    const auto set = truth.extra.find(info.extras[i].name);
    out.push_back({effect.nonlinear[i].name, effect.nonlinear[i].unit,
                   set == truth.extra.end() ? info.extras[i].value : set->second, nonlinear[i],
                   found.nonlinear_std[i], RecoveredKind::kShape});
  }
  return out;
}

Machine ExtendedMachine(const PressOptions& options, const std::string& effect) {
  Machine machine = MachineFor(options);
  machine.added_effects = {effect};
  // Drawing and return strokes, and of machines with a short way the rests between them.
  if (NeedsBothEdges(effect)) {
    machine.gate.bounds = {{"z", false, 0.03, 0.185}};
    CompleteGate(machine);
  }
  return machine;
}

/// Truth of a base parameter as the library's law counts it. Its curved edge is k u |u|^a, the simulator's
/// k u (|u| / normal)^a: the same law with another unit opening.
double TrueValue(const std::string& parameter, const PressOptions& options) {
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
  const auto info = std::ranges::find_if(effects, [&](const EffectInfo& e) { return e.id == effect; });
  return info == effects.end() ? nullptr : &*info;
}

/// Counts over all logs.
struct RecoveryTally {
  int values = 0, inside = 0, far = 0;
  std::map<RecoveredKind, std::pair<int, int>> of_kind;  ///< inside, all

  void Add(const RecoveredValue& value) {
    const double deviation = std::abs(value.Deviation());
    const bool holds = deviation <= kNormal95;
    ++values;
    inside += holds;
    far += !(deviation <= kMostDeviation);
    of_kind[value.kind].first += holds;
    ++of_kind[value.kind].second;
  }
  bool Holds(RecoveredKind kind) const {
    const auto at = of_kind.find(kind);
    return at == of_kind.end() || at->second.first >= 0.9 * at->second.second;
  }
};

void PrintHeader() {
  fmt::print("{:<28} {:>11} {:>11} {:>10} {:<17} {:>7}", "effect", "size, truth", "found", "std", "unit",
             "dev.");
  for (const char* name : {"K'", "V0", "Q_vn", "y_0"}) fmt::print(" {:>6}", name);
  std::cout << "  shape\n";
}

void PrintRow(const std::string& effect, const std::vector<RecoveredValue>& values) {
  const RecoveredValue& size = values.front();
  fmt::print("{:<28} {:>11.4g} {:>11.4g} {:>10.2g} {:<17}", effect, size.truth, size.value, size.std,
             size.unit);
  bool far = false;
  std::string shape;
  for (const RecoveredValue& value : values) {
    far |= !(std::abs(value.Deviation()) <= kMostDeviation);
    if (value.kind == RecoveredKind::kShape)
      shape += fmt::format(" {} {:.4g} for {:.4g} ({:.2f})", value.name, value.value, value.truth,
                           value.Deviation());
    else
      fmt::print(" {:>6.2f}", value.Deviation());
  }
  std::cout << " " << shape << (far ? "  <- missed\n" : "\n");
}

}  // namespace

Result<std::vector<RecoveredValue>> RecoverEffect(const std::string& effect, double seconds,
                                                  std::uint64_t seed, bool random) {
  const EffectInfo* info = InfoOf(effect);
  if (info == nullptr) return BadInput("the simulator has no effect '{}'", effect);
  const PressOptions options = OptionsFor(*info, seconds, seed, random);
  const Machine machine = ExtendedMachine(options, effect);
  const auto strokes = TRY(StrokesOf(SimulatePress(options), machine, KeepSamples::kYes));
  if (random) {
    const StrokeSet set(strokes.model, strokes.Grams(), strokes.window);
    if (ErrorOverFloor(set.Fit({})) < kNoticedError) return std::vector<RecoveredValue>{};
  }
  const auto model = TRY(FitMachineModel(strokes));
  const EffectEstimate& size = model.fit.effects.front();
  const EffectSetting& truth = options.effects.front();
  std::vector<RecoveredValue> values = {
      {effect, info->unit, truth.size, size.size, size.std, RecoveredKind::kSize}};
  const EffectChoice& choice = model.choices.front();
  for (RecoveredValue& shape :
       RecoveredShapes(*info, truth, *model.structure->effects[choice.effect], size,
                       model.structure->effect_shapes[choice.effect][choice.shape].nonlinear))
    values.push_back(std::move(shape));
  const int count = static_cast<int>(strokes.stretches.size());
  for (const Estimate& base : BaseParameters(*model.structure, model.fit, count))
    values.push_back({base.parameter, base.unit, TrueValue(base.parameter, options), base.value, base.std});
  return values;
}

int RunRecovery(const RecoveryOptions& o) {
  fmt::print(
      "each effect of the library, simulated {} and fitted with the model extended by it; "
      "{:.0f} s, seeds {} ... {}\ndev.: (found - truth) / stated standard deviation\n\n",
      o.random ? "in a random machine at a random size and shape" : "at its typical size", o.seconds, o.seed,
      o.seed + static_cast<std::uint64_t>(o.seeds) - 1);
  PrintHeader();
  RecoveryTally tally;
  int unseen = 0;
  if (!o.effect.empty() && InfoOf(o.effect) == nullptr)
    return ReportError(Error{ErrorKind::kUsage, fmt::format("the simulator has no effect '{}'", o.effect)});
  for (const EffectInfo& effect : PressEffects()) {
    if (!o.effect.empty() && o.effect != effect.id) continue;
    for (int s = 0; s < o.seeds; ++s) {
      // Logs of their own: one unlucky draw must not show in every row.
      const std::uint64_t seed = 1000 * (o.seed + s) + (&effect - PressEffects().data());
      const auto values = RecoverEffect(effect.id, o.seconds, seed, o.random);
      if (values && values->empty()) {
        ++unseen;
        continue;
      }
      if (!values) return ReportError(values.error());
      PrintRow(effect.id, *values);
      for (const RecoveredValue& value : *values) tally.Add(value);
    }
  }
  const auto sizes = tally.of_kind[RecoveredKind::kSize], shapes = tally.of_kind[RecoveredKind::kShape];
  fmt::print(
      "\n95 % intervals that hold the truth: sizes {} of {}, shapes {} of {}, all parameters {} of {}; "
      "beyond 3 standard deviations: {}\n",
      sizes.first, sizes.second, shapes.first, shapes.second, tally.inside, tally.values, tally.far);
  const bool reached = o.seeds == 1
                           ? tally.far == 0
                           : tally.inside >= 0.9 * tally.values && tally.Holds(RecoveredKind::kSize) &&
                                 tally.Holds(RecoveredKind::kShape);
  std::cout << (reached ? "reached\n" : "NOT reached\n");
  return reached ? 0 : 1;
}

}  // namespace hydroscope
