#include "simulator/die_cushion/plant.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

constexpr double kVapour = -0.95e5;       // Pa gauge; the oil parts below
constexpr double kRootSlope = 1 / 141.4;  // 1/sqrt(Pa), steepest slope of SignedRoot, at 0

}  // namespace

PressPlant::PressPlant(const PressMachine& machine, const PressEffectSizes& effects, double step,
                       const PlantLaws& laws)
    : machine_(machine), laws_(laws), step_(step), nominal_(machine.Q_vn / std::sqrt(machine.dp_nom)) {
  machine_.A_A *= 1 + laws.area_error;
  machine_.p_tank += laws.tank_shift;
  SetEffects(effects);
}

void PressPlant::SetEffects(const PressEffectSizes& effects) {
  if (effects_.inertance == 0) line_flow_ = 0;
  effects_ = effects;
  const PressEffectSizes& e = effects_;
  plain_ = e.internal_leakage == 0 && e.external_leakage == 0 && e.orifice_leakage == 0 &&
           e.worn_leakage == 0 && e.relief_gain == 0 && e.air_fraction == 0 && e.accumulator == 0;
}

double PressPlant::Conductance(double opening, double gain) const {
  const double g = nominal_ * gain * EffectiveOpening(effects_, laws_.Opening(opening));
  return g > 0 ? g / std::sqrt(1 + effects_.tank_resistance * g * g) : g;
}

double PressPlant::ValveFlow(double conductance, double p_A, double p_0) const {
  const double dp = conductance > 0 ? p_A - machine_.p_tank : p_0 - p_A;
  return laws_.acts_on_edges() ? laws_.EdgeFlow(conductance, dp) : conductance * SignedRoot(dp);
}

double PressPlant::Volume(const RamMotion::Point& ram, const Drive& drive) const {
  return machine_.V0 * drive.V0_factor + machine_.A_A * ram.z;
}

double PressPlant::Modulus(double p_A, const Drive& drive) const {
  return machine_.K * drive.K_factor + laws_.modulus_slope * p_A;
}

double PressPlant::Slope(double p_A, double conductance, const RamMotion::Point& ram,
                         const Drive& drive) const {
  const double valve = effects_.inertance != 0 ? line_flow_ : ValveFlow(conductance, p_A, drive.p_0);
  const double volume = Volume(ram, drive), modulus = Modulus(p_A, drive);
  double inflow = -machine_.A_A * ram.v - valve - drive.leakage * (p_A - drive.p_B) - drive.extra_flow;
  if (laws_.leaks()) inflow -= laws_.Leakage(p_A, drive.p_B, drive.p_0, ram.z);
  if (plain_) return inflow * modulus / volume;
  return (inflow - LeakageFlow(effects_, p_A, drive.p_B, ram.z)) /
         ChamberCapacity(effects_, modulus, volume, p_A);
}

void PressPlant::StepPressure(const Drive& drive, const double conductance[3]) {
  const double h = step_, p = p_A_;
  const double k1 = Slope(p, conductance[0], drive.ram[0], drive);
  const double k2 = Slope(p + h / 2 * k1, conductance[1], drive.ram[1], drive);
  const double k3 = Slope(p + h / 2 * k2, conductance[1], drive.ram[1], drive);
  const double k4 = Slope(p + h * k3, conductance[2], drive.ram[2], drive);
  p_A_ = p + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  if (p_A_ >= kVapour && cavity_ == 0) return;
  const double capacity =
      ChamberCapacity(effects_, Modulus(kVapour, drive), Volume(drive.ram[2], drive), kVapour);
  cavity_ -= (p_A_ - kVapour) * capacity;
  p_A_ = kVapour;
  if (cavity_ < 0) {
    p_A_ -= cavity_ / capacity;
    cavity_ = 0;
  }
}

void PressPlant::StepLine(double conductance, double p_0, double step) {
  if (conductance == 0) {
    line_flow_ = 0;
    return;
  }
  const double drive = p_A_ - (conductance > 0 ? machine_.p_tank : p_0);
  if (laws_.acts_on_edges()) {
    line_flow_ = LineFlow(conductance, drive, step);
    return;
  }
  const double decay = step * std::abs(line_flow_) / (conductance * conductance * effects_.inertance);
  if (drive * line_flow_ < 0 || drive == 0) {  // the flow is being turned round
    line_flow_ = (line_flow_ + step * drive / effects_.inertance) / (1 + decay);
    return;
  }
  const double root = std::sqrt(std::abs(drive));
  const double final_flow = root * std::abs(conductance), flow = std::abs(line_flow_);
  const double approach = std::tanh(step * root / (std::abs(conductance) * effects_.inertance));
  line_flow_ =
      std::copysign(final_flow * (flow + final_flow * approach) / (final_flow + flow * approach), drive);
}

/// Oil column before an edge with a law of its own: linearly implicit, because the exact solution is known
/// for the plain law alone.
double PressPlant::LineFlow(double conductance, double drop, double step) const {
  const double flow = line_flow_, smallest = 1e-9;
  const double at = std::abs(flow) > smallest ? flow : std::copysign(smallest, drop);
  const double resistance = laws_.EdgeDrop(conductance, at) / at;
  return (flow + step * drop / effects_.inertance) / (1 + step * resistance / effects_.inertance);
}

void PressPlant::Step(const Drive& drive) {
  double conductance[3];
  for (int k = 0; k < 3; ++k) conductance[k] = Conductance(drive.opening[k], drive.gain);
  if (effects_.inertance != 0) StepLine((conductance[0] + conductance[1]) / 2, drive.p_0, step_ / 2);
  StepPressure(drive, conductance);
  if (effects_.inertance != 0) StepLine((conductance[1] + conductance[2]) / 2, drive.p_0, step_ / 2);
}

double PressPlant::StiffestRate(const PressMachine& machine, const PressEffectSizes& e, double z_bottom,
                                const PlantLaws& laws) {
  constexpr double kHighest = 300e5;  // Pa, highest pressure that is allowed for
  const double volume = machine.V0 + machine.A_A * std::max(0.0, z_bottom);
  const double capacity = volume / (machine.K + std::max(0.0, laws.modulus_slope) * kHighest);
  const double gain = machine.Q_vn / std::sqrt(machine.dp_nom) * (1 + std::abs(e.asymmetry)) *
                      (1 + std::abs(laws.second_gain)) *
                      std::pow(1 / e.curvature_normal_opening, std::max(0.0, e.curvature));
  const double leakage = std::abs(e.internal_leakage) + std::abs(e.external_leakage) +
                         std::abs(e.worn_leakage) + std::abs(e.relief_gain) + laws.zone_leakage +
                         2 * laws.relief_square * std::max(0.0, kHighest - laws.relief_crack) +
                         std::abs(e.orifice_leakage) * kRootSlope;
  const double node = (gain * kRootSlope + leakage) / capacity;
  const double line = e.inertance > 0 ? 3 / std::sqrt(e.inertance * capacity) : 0;
  return std::max(node, line);
}

}  // namespace hydroscope
