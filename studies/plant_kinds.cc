#include "studies/plant_kinds.h"

#include <algorithm>
#include <cmath>

#include "simulator/die_cushion/imperfections.h"
#include "simulator/die_cushion/press.h"
#include "studies/random_effect.h"

namespace hydroscope {
namespace {

constexpr const char* kSecondEffect = "second_effect";
constexpr double kSecondShare = 0.12;  ///< of the typical size, of the second effect

double Between(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * Uniform(random);
}
double LogBetween(std::mt19937_64& random, double low, double high) {
  return low * std::pow(high / low, Uniform(random));
}

/// Sizes between these shares of the typical one.
constexpr double kSmallest = 0.4, kLargest = 1.6;

/// Further numbers of the kinds where the defaults are places on somebody's grid.
void DrawExtras(std::mt19937_64& random, ImperfectionSetting& s) {
  if (s.kind == "coloured_noise") {
    s.size = LogBetween(random, 0.05, 1);
    s.extra = {{"phi", Between(random, 0.5, 0.97)}, {"white", Uniform(random) < 0.5 ? 0.0 : 1.0}};
  }
  if (s.kind == "periodic_disturbance" || s.kind == "sensor_hum")
    s.extra = {{"frequency", LogBetween(random, 1.5, 60)}, {"phase", Between(random, 0, 6.28)}};
  if (s.kind == "quadratic_relief") s.extra["crack"] = Between(random, 130e5, 180e5);
  if (s.kind == "rectangular_zone")
    s.extra = {{"centre", Between(random, 0.04, 0.15)}, {"width", Between(random, 0.012, 0.03)}};
  if (s.kind == "spool_nonlinearity") s.extra["power"] = Between(random, 2, 4);
  if (s.kind == "two_gain_spool") s.extra["knee"] = Between(random, 0.08, 0.25);
  if (s.kind == "leakage_temperature") s.extra["rate"] = Between(random, 0.02, 0.05);
  if (s.kind == "exponential_viscosity") s.extra["rate"] = Between(random, 0.03, 0.08);
  if (s.kind == "leaky_stretch" || s.kind == "bad_stretch") {
    const bool for_good = Uniform(random) < 0.5;
    s.extra = {{"begin", Between(random, 0.1, 0.7)}, {"length", for_good ? 1 : Between(random, 0.08, 0.25)}};
  }
  if (s.kind.ends_with("_step")) s.extra["until"] = Between(random, 0.15, 0.85);
  if (s.kind == "stuck" || s.kind == "frozen") {
    s.extra["begin"] = Between(random, 5, 45);
    s.channel = Uniform(random) < 0.5 ? "y_v" : "p_A";
  }
  if (s.kind == "slow_task" || s.kind == "deadband" || s.kind == "one_signal_early") {
    const char* channels[] = {"p_A", "z", "y_v"};
    s.channel = channels[random() % 3];
  }
  if (s.kind == "spikes") s.extra["rows"] = 1 + static_cast<double>(random() % 4);
  if (s.kind == "slow_task") s.size = 2 + static_cast<double>(random() % 4);
  if (s.kind == "saturation") s.size = Between(random, 110, 180) * 1e5;
  if (s.kind == "wrong_unit") s.size = Uniform(random) < 0.5 ? 1e-5 : 1e-3;
  if (s.kind == "pressure_offset_temperature") s.extra["set_at"] = Between(random, 288, 303);
  if (s.kind == "pressure_crosstalk") s.channel = Uniform(random) < 0.5 ? "y_v" : "U_v";
  if (s.kind == "displacement_gain_temperature") s.channel = Uniform(random) < 0.5 ? "y_v" : "z";
  if (s.kind == "time_jitter") s.size = Between(random, 0.05, 0.4);
}

ImperfectionSetting DrawImperfection(std::mt19937_64& random, const PlantKind& kind) {
  const auto& known = PressImperfections();
  const auto info = std::find_if(known.begin(), known.end(),
                                 [&](const ImperfectionInfo& i) { return i.name == kind.name; });
  ImperfectionSetting setting{
      kind.name, info->typical_size * LogBetween(random, kSmallest, kLargest), {}, ""};
  if (kind.both_ways && Uniform(random) < 0.5) setting.size = -setting.size;
  DrawExtras(random, setting);
  if (kind.name == "intermittent_effects") setting.size = info->typical_size;
  setting.size = std::clamp(setting.size, info->low, info->high);
  return setting;
}

/// What names all signals but one that are late.
std::vector<std::string> LateSignals(const std::string& early) {
  std::vector<std::string> right;
  if (early != "p_A") right.emplace_back("pressure_signal_delay");
  if (early != "y_v") right.emplace_back("spool_signal_delay");
  if (early != "z") right.emplace_back("position_signal_delay");
  return right;
}

void AddImperfection(std::mt19937_64& random, const PlantKind& kind, PlantCase& c) {
  c.options.imperfections.push_back(DrawImperfection(random, kind));
  c.imperfections.push_back(&kind);
  c.right.insert(c.right.end(), kind.right.begin(), kind.right.end());
}

/// One that stands beside any other and says what is right.
const PlantKind& FurtherKind(std::mt19937_64& random, const PlantCase& c) {
  const auto& kinds = PlantKinds();
  for (;;) {
    const PlantKind& kind = kinds[random() % kinds.size()];
    const bool plain = kind.nature == PlantNature::kNoise || kind.nature == PlantNature::kLibrary;
    if (plain && !kind.needs_effect && &kind != c.kind &&
        std::ranges::find(c.imperfections, &kind) == c.imperfections.end())
      return kind;
  }
}

}  // namespace

const std::vector<PlantKind>& PlantKinds() {
  using enum PlantNature;
  constexpr bool kBothWays = true, kNeedsEffect = true;
  static const std::vector<PlantKind> kinds = {
      {"coloured_noise", kNoise, {}},
      {"heavy_tails", kNoise, {}},
      {"plc_filter", kNoise, {"signal_lag"}},
      {"quantisation", kNoise, {}},
      {"spikes", kNoise, {}},
      {"slow_task", kNoise, {}},
      {"time_jitter", kNoise, {}},
      {"dropped_rows", kNoise, {}},
      {"slow_sampling", kNoise, {}},
      {"slow_control", kNoise, {}},
      {"calm_pressure", kNoise, {}},
      {"wrong_area", kNoise, {}, kBothWays},
      {"return_line_resistance", kLibrary, {"return_line_resistance"}},
      {"tank_pressure", kLibrary, {"tank_pressure"}},
      {"check_valve", kRelative, {"tank_pressure", "return_line_resistance"}},
      {"laminar_edge", kLibrary, {"laminar_edge"}},
      {"pressure_dependent_bulk_modulus", kLibrary, {"pressure_dependent_bulk_modulus"}},
      {"leakage_temperature", kLibrary, {"leakage_temperature", "internal_leakage"}},
      {"supply_leakage", kLibrary, {"supply_leakage"}},
      {"periodic_disturbance", kLibrary, {"periodic_disturbance"}},
      {"sensor_hum", kLibrary, {"periodic_disturbance"}},
      {"K_drift", kLibrary, {"K_drift"}, kBothWays},
      {"V0_drift", kLibrary, {"V0_drift"}, kBothWays},
      {"Q_vn_drift", kLibrary, {"Q_vn_drift"}, kBothWays},
      {"y_0_drift", kLibrary, {"y_0_drift"}, kBothWays},
      {"Q_vn_step", kRelative, {"Q_vn_drift"}, kBothWays},
      {"K_step", kRelative, {}, kBothWays},
      {"V0_step", kRelative, {}, kBothWays},
      {"y_0_step", kRelative, {}, kBothWays},
      {"pressure_gain", kLibrary, {"pressure_gain"}, kBothWays},
      {"pressure_gain_temperature", kLibrary, {"pressure_gain_temperature"}, kBothWays},
      {"pressure_gain_drift", kLibrary, {"pressure_gain_drift"}, kBothWays},
      {"pressure_offset_temperature", kLibrary, {"pressure_offset_temperature"}, kBothWays},
      {"pressure_crosstalk", kLibrary, {"pressure_crosstalk"}, kBothWays},
      {"pressure_position_crosstalk", kLibrary, {"pressure_position_crosstalk"}, kBothWays},
      {"pressure_nonlinearity", kLibrary, {"pressure_nonlinearity"}, kBothWays},
      {"position_nonlinearity", kLibrary, {"position_nonlinearity"}, kBothWays},
      {"displacement_gain_temperature", kLibrary, {"displacement_gain_temperature"}, kBothWays},
      {"spool_null_temperature", kLibrary, {"spool_null_temperature"}, kBothWays},
      {"spool_null_pressure", kLibrary, {"spool_null_pressure"}, kBothWays},
      {"flow_gain_pressure", kLibrary, {"flow_gain_pressure"}, kBothWays},
      {"pressure_zero", kLibrary, {"pressure_offset"}, kBothWays},
      {"spool_nonlinearity", kLibrary, {"spool_nonlinearity"}, kBothWays},
      {"pressure_offset_drift", kLibrary, {"pressure_offset_drift"}, kBothWays},
      {"pressure_signal_lag", kLibrary, {"pressure_signal_lag"}},
      {"spool_signal_lag", kLibrary, {"spool_signal_lag"}},
      {"position_signal_lag", kLibrary, {"position_signal_lag"}},
      {"signal_lag", kLibrary, {"signal_lag"}},
      {"one_signal_early", kRelative, {}},
      {"intermittent_leakage", kLibrary, {"internal_leakage"}},
      {"intermittent_effects", kLibrary, {}, !kBothWays, kNeedsEffect},
      {"leaky_stretch", kLibrary, {"internal_leakage"}},
      {"bad_stretch", kRelative, {"pressure_offset", "pressure_offset_drift"}, kBothWays},
      {kSecondEffect, kLibrary, {}, !kBothWays, kNeedsEffect},
      {"bulk_modulus_temperature", kRelative, {"K_drift"}},
      {"quadratic_relief", kRelative, {"relief_valve"}},
      {"rectangular_zone", kRelative, {"position_dependent_leakage"}},
      {"exponential_viscosity", kRelative, {"oil_viscosity"}, kBothWays},
      {"two_gain_spool", kRelative, {"valve_flow_curvature"}},
      {"stuck", kFlagged, {}},
      {"frozen", kFault, {}},
      {"saturation", kFault, {}},
      {"deadband", kFault, {}},
      {"wrong_unit", kRefused, {}},
  };
  return kinds;
}

PressOptions PlantCase::With(std::initializer_list<PlantNature> natures) const {
  PressOptions out = options;
  out.imperfections.clear();
  for (std::size_t k = 0; k < imperfections.size(); ++k)
    if (std::ranges::find(natures, imperfections[k]->nature) != natures.end())
      out.imperfections.push_back(options.imperfections[k]);
  return out;
}

PressOptions PlantCase::ToBeFound() const {
  return With({PlantNature::kNoise, PlantNature::kLibrary, PlantNature::kRelative});
}

PressOptions PlantCase::Reference() const {
  PressOptions reference = With({PlantNature::kNoise});
  reference.effects.clear();
  return reference;
}

PlantCase DrawPlantCase(int index, std::uint64_t seed, const std::vector<const PlantKind*>& kinds,
                        int further) {
  std::mt19937_64 random(seed * 1000003 + static_cast<std::uint64_t>(index));
  PlantCase c;
  const std::size_t count = kinds.size(), number = static_cast<std::size_t>(index);
  c.kind = kinds[number % count];
  c.options = RandomMachine(random() >> 32);
  c.options.seconds = Between(random, 60, 180);
  c.options.oil_start = Between(random, 298, 308);
  c.options.oil_end = c.options.oil_start + Between(random, 5, 25);
  c.has_effect = c.kind->needs_effect || number / count % 2 == 1;
  if (c.has_effect) c.options.effects = {RandomEffect(random, 0.3, 2.0, true)};
  if (c.kind->name == kSecondEffect) {
    EffectSetting second = RandomEffect(random, kSecondShare, kSecondShare * 1.001, true);
    while (second.id == c.options.effects[0].id)
      second = RandomEffect(random, kSecondShare, kSecondShare * 1.001, true);
    c.options.effects.push_back(second);
  }
  for (const EffectSetting& effect : c.options.effects) c.right.push_back(effect.id);
  if (c.kind->name != kSecondEffect) AddImperfection(random, *c.kind, c);
  for (int k = 0; k < further; ++k) AddImperfection(random, FurtherKind(random, c), c);
  if (c.kind->name == "one_signal_early")
    for (const std::string& id : LateSignals(c.options.imperfections[0].channel)) c.right.push_back(id);
  return c;
}

}  // namespace hydroscope
