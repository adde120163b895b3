#include "studies/random_effect.h"

#include <algorithm>
#include <cmath>

#include "simulator/die_cushion/effects.h"

namespace hydroscope {
namespace {

/// Drawing strokes never use the edge for y_v < 0 and pass the null only by accident: these two leave no
/// trace in them.
bool Invisible(const std::string& id) { return id == "valve_flow_asymmetry" || id == "spool_overlap"; }

}  // namespace

double Uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

EffectSetting RandomEffect(std::mt19937_64& random, double min_factor, double max_factor, bool visible) {
  const auto& effects = PressEffects();
  std::size_t pick = random() % effects.size();
  while (visible && Invisible(effects[pick].id)) pick = random() % effects.size();
  return RandomSize(random, effects[pick].id, min_factor, max_factor);
}

EffectSetting RandomSize(std::mt19937_64& random, const std::string& id, double min_factor,
                         double max_factor) {
  const auto& effects = PressEffects();
  const EffectInfo& info = *std::ranges::find_if(effects, [&](const EffectInfo& e) { return e.id == id; });
  EffectSetting setting{
      info.id, info.typical_size * min_factor * std::pow(max_factor / min_factor, Uniform(random)), {}};
  if (info.id == "relief_valve") setting.extra["crack"] = 130e5 + 60e5 * Uniform(random);
  if (info.id == "accumulator") setting.extra["precharge"] = 40e5 + 100e5 * Uniform(random);
  if (info.id == "position_dependent_leakage") {
    setting.extra["centre"] = 0.04 + 0.12 * Uniform(random);
    setting.extra["width"] = 0.012 + 0.02 * Uniform(random);
  }
  return setting;
}

double ErrorOverFloor(const ExtendedFit& fit) {
  return fit.noise_floor > 0 ? std::max(0.0, fit.rms_holdout / fit.noise_floor - 1) : 0.0;
}

}  // namespace hydroscope
