#include "simulator/die_cushion/effects.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "core/nearest_or_all.h"

namespace hydroscope {
namespace {

using Sizes = PressEffectSizes;

/// Where an effect's size and extras are kept.
struct Slot {
  EffectInfo info;
  double Sizes::*size;
  std::vector<double Sizes::*> extras;
};

const std::vector<Slot>& Slots() {
  static const std::vector<Slot> slots = {
      {{"internal_leakage", "m3/(s Pa)", 4e-12, "Q += size (p_A - p_B)", {}}, &Sizes::internal_leakage, {}},
      {{"external_leakage", "m3/(s Pa)", 4e-12, "Q += size p_A", {}}, &Sizes::external_leakage, {}},
      {{"orifice_leakage", "m3/(s sqrt(Pa))", 1.5e-8, "Q += size sqrt(p_A - p_B)", {}},
       &Sizes::orifice_leakage,
       {}},
      {{"entrained_air",
        "1",
        0.06,
        "free-air fraction at 1 bar, compressed with p",
        {{"exponent", 1.4, "1"}}},
       &Sizes::air_fraction,
       {&Sizes::air_exponent}},
      {{"accumulator",
        "m3",
        5e-5,
        "gas volume at its pre-charge, V_gas ~ p^(-1/n)",
        {{"precharge", 80e5, "Pa"}, {"exponent", 1.3, "1"}}},
       &Sizes::accumulator,
       {&Sizes::accumulator_precharge, &Sizes::accumulator_exponent}},
      {{"relief_valve", "m3/(s Pa)", 3e-11, "Q += size (p_A - crack) above crack", {{"crack", 180e5, "Pa"}}},
       &Sizes::relief_gain,
       {&Sizes::relief_crack}},
      {{"tank_back_pressure", "Pa/(m3/s)2", 8e11, "p_t += size Q^2 behind the valve", {}},
       &Sizes::tank_resistance,
       {}},
      {{"valve_flow_curvature",
        "1",
        0.15,
        "opening y (|y| / normal_opening)^size",
        {{"normal_opening", 0.3, "1"}}},
       &Sizes::curvature,
       {&Sizes::curvature_normal_opening}},
      {{"valve_flow_asymmetry", "1", 0.15, "gain of the edge y < y_0 times 1 + size", {}},
       &Sizes::asymmetry,
       {}},
      {{"spool_overlap", "1", 0.02, "dead band of half width size around y_0", {}}, &Sizes::overlap, {}},
      {{"spool_hysteresis", "1", 0.01, "the edge follows the spool with play of width size", {}},
       &Sizes::hysteresis,
       {}},
      {{"oil_viscosity",
        "1/K",
        0.006,
        "flow gain times 1 + size (T_oil - reference)",
        {{"reference", 313.15, "K"}}},
       &Sizes::viscosity,
       {&Sizes::viscosity_reference}},
      {{"pressure_offset", "Pa", 6e5, "reading of p_A is size too high", {}}, &Sizes::pressure_offset, {}},
      {{"spool_signal_delay", "s", 0.008, "logged y_v is late", {}}, &Sizes::spool_delay, {}},
      {{"pressure_signal_delay", "s", 0.008, "logged p_A is late", {}}, &Sizes::pressure_delay, {}},
      {{"position_signal_delay", "s", 0.008, "logged z is late", {}}, &Sizes::position_delay, {}},
      {{"position_dependent_leakage",
        "m3/(s Pa)",
        1.5e-11,
        "Q += size exp(-((z - centre)/width)^2) (p_A - p_B)",
        {{"centre", 0.11, "m"}, {"width", 0.02, "m"}}},
       &Sizes::worn_leakage,
       {&Sizes::worn_centre, &Sizes::worn_width}},
      {{"line_inertance", "kg/m4", 3e7, "p_A - p_valve = size dQ/dt of the oil column before the valve", {}},
       &Sizes::inertance,
       {}},
  };
  return slots;
}

Status SetExtra(const Slot& slot, const std::string& name, double value, Sizes& sizes) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < slot.info.extras.size(); ++k) {
    names.push_back(slot.info.extras[k].name);
    if (names.back() != name) continue;
    if (!std::isfinite(value) || value <= 0)
      return UsageError("effect {}: {} is {}; it must be above 0 ({})", slot.info.id, name, value,
                        slot.info.extras[k].unit);
    sizes.*slot.extras[k] = value;
    return {};
  }
  if (names.empty()) return UsageError("effect {} has no further number; found '{}'", slot.info.id, name);
  return UsageError("effect {} knows no '{}'; it knows {}", slot.info.id, name, fmt::join(names, ", "));
}

}  // namespace

const std::vector<EffectInfo>& PressEffects() {
  static const std::vector<EffectInfo> infos = [] {
    std::vector<EffectInfo> list;
    for (const Slot& slot : Slots()) list.push_back(slot.info);
    return list;
  }();
  return infos;
}

Result<PressEffectSizes> ResolveEffects(const std::vector<EffectSetting>& settings) {
  Sizes sizes;
  for (const EffectSetting& setting : settings) {
    const auto& slots = Slots();
    const auto slot =
        std::find_if(slots.begin(), slots.end(), [&](const Slot& s) { return s.info.id == setting.id; });
    if (slot == slots.end()) {
      std::vector<std::string> ids;
      for (const Slot& s : slots) ids.push_back(s.info.id);
      return UsageError("the simulator knows no effect '{}'; {}", setting.id, NearestOrAll(setting.id, ids));
    }
    if (!std::isfinite(setting.size))
      return UsageError("effect {}: size {} is not a number ({} expected)", setting.id, setting.size,
                        slot->info.unit);
    sizes.*(slot->size) += setting.size;
    for (const auto& [name, value] : setting.extra) TRY(SetExtra(*slot, name, value, sizes));
  }
  for (const double delay : {sizes.spool_delay, sizes.pressure_delay, sizes.position_delay})
    if (delay < 0 || delay > 1)
      return UsageError("a signal delay of {} s; it must lie between 0 and 1 s", delay);
  for (const double size : {sizes.air_fraction, sizes.accumulator, sizes.tank_resistance, sizes.overlap,
                            sizes.hysteresis, sizes.inertance})
    if (size < 0)
      return UsageError(
          "size {}: entrained_air, accumulator, tank_back_pressure, spool_overlap, spool_hysteresis and "
          "line_inertance cannot be negative",
          size);
  if (sizes.air_fraction >= 1)
    return UsageError("entrained_air {}: the free-air fraction must be below 1", sizes.air_fraction);
  return sizes;
}

double LeakageFlow(const PressEffectSizes& e, double p_A, double p_B, double z) {
  double flow = e.internal_leakage * (p_A - p_B) + e.external_leakage * p_A;
  if (e.orifice_leakage != 0) flow += e.orifice_leakage * SignedRoot(p_A - p_B);
  if (e.worn_leakage != 0) {
    const double offset = (z - e.worn_centre) / e.worn_width;
    flow += e.worn_leakage * std::exp(-offset * offset) * (p_A - p_B);
  }
  if (p_A > e.relief_crack) flow += e.relief_gain * (p_A - e.relief_crack);
  return flow;
}

double ChamberCapacity(const PressEffectSizes& e, double bulk_modulus, double volume, double p_A) {
  double capacity = volume / bulk_modulus;
  const double absolute = std::max(p_A + kAtmosphere, 1e3);
  if (e.air_fraction != 0) {
    const double compressed = e.air_fraction * std::pow(kAirReference / absolute, 1 / e.air_exponent);
    const double share = compressed / (1 - e.air_fraction + compressed);
    capacity = volume * ((1 - share) / bulk_modulus + share / (e.air_exponent * absolute));
  }
  if (e.accumulator != 0 && p_A > e.accumulator_precharge) {
    const double precharge = e.accumulator_precharge + kAtmosphere;
    capacity += e.accumulator * std::pow(precharge / absolute, 1 / e.accumulator_exponent) /
                (e.accumulator_exponent * absolute);
  }
  return capacity;
}

double EdgeWithPlay(const PressEffectSizes& e, double spool, double edge) {
  return std::clamp(edge, spool - e.hysteresis / 2, spool + e.hysteresis / 2);
}

double EffectiveOpening(const PressEffectSizes& e, double opening) {
  if (e.overlap != 0)
    opening = opening > 0 ? std::max(0.0, opening - e.overlap) : std::min(0.0, opening + e.overlap);
  if (e.curvature != 0 && opening != 0)
    opening *= std::pow(std::abs(opening) / e.curvature_normal_opening, e.curvature);
  return opening < 0 ? opening * (1 + e.asymmetry) : opening;
}

double ViscosityGain(const PressEffectSizes& e, double oil_temperature) {
  return 1 + e.viscosity * (oil_temperature - e.viscosity_reference);
}

}  // namespace hydroscope
