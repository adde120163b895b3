// What each kind of imperfection is called and how large it may be.
#include "simulator/die_cushion/imperfections.h"

namespace hydroscope {
namespace {

using enum ImperfectionKind;

// A kind is a line or two, not a word a line.
// clang-format off
std::vector<ImperfectionInfo> MachineKinds() {
  return {
      {kReturnLineResistance, "return_line_resistance", "Pa/(m3/s)", 4e8, 0, 1e11,
       "laminar return line: drops size Q behind the edge to the tank", {}, ""},
      {kTankPressure, "tank_pressure", "Pa", 5e5, -0.9e5, 5e6,
       "the tank line stands at p_t + size, the machine file says p_t", {}, ""},
      {kCheckValve, "check_valve", "Pa", 3e5, 0, 5e6,
       "pre-loaded check valve in the tank line: opens at size, lets nothing back, drops slope Q more",
       {{"slope", 1e8, "Pa/(m3/s)"}}, ""},
      {kLaminarEdge, "laminar_edge", "Pa", 8e5, 0, 5e7,
       "flow over an edge ~ dp / (dp^2 + size^2)^(1/4): proportional to dp well below size", {}, ""},
      {kBulkModulusSlope, "pressure_dependent_bulk_modulus", "1", 11, -20, 100,
       "K + size p_A: oil stiffens under pressure", {}, ""},
      {kLeakageTemperature, "leakage_temperature", "m3/(s Pa)", 4e-12, 0, 1e-9,
       "Q += size exp(rate (T_oil - reference)) (p_A - p_B)",
       {{"rate", 0.035, "1/K"}, {"reference", 313.15, "K"}}, ""},
      {kSupplyLeakage, "supply_leakage", "m3/(s sqrt(Pa))", 1e-8, 0, 1e-5,
       "worn edge of the valve: size sqrt(p_0 - p_A) from the supply into chamber A", {}, ""},
      {kFlowRipple, "periodic_disturbance", "m3/s", 2e-5, 0, 1e-2,
       "Q += size sin(2 pi frequency t + phase): ripple of a pump",
       {{"frequency", 7.3, "Hz"}, {"phase", 0.4, "rad"}}, ""},
      {kBulkModulusDrift, "K_drift", "1", -0.10, -0.9, 5, "K (1 + size t / length of the log)", {}, ""},
      {kBulkModulusTemperature, "bulk_modulus_temperature", "1/K", -0.004, -0.02, 0.02,
       "K (1 + size (T_oil - 40 degC))", {}, ""},
      {kVolumeDrift, "V0_drift", "1", 0.10, -0.9, 5, "V0 (1 + size t / length of the log)", {}, ""},
      {kBulkModulusStep, "K_step", "1", -0.05, -0.9, 5, "K (1 + size) up to a share of the log",
       {{"until", 0.3, "1"}}, ""},
      {kVolumeStep, "V0_step", "1", 0.05, -0.9, 5, "V0 (1 + size) up to a share of the log",
       {{"until", 0.3, "1"}}, ""},
      {kFlowGainStep, "Q_vn_step", "1", 0.02, -0.9, 5, "Q_vn (1 + size) up to a share of the log",
       {{"until", 0.3, "1"}}, ""},
      {kSpoolZeroStep, "y_0_step", "1", 0.002, -0.2, 0.2, "y_0 + size up to a share of the log",
       {{"until", 0.3, "1"}}, ""},
      {kFlowGainDrift, "Q_vn_drift", "1", 0.02, -0.9, 5, "Q_vn (1 + size t / length of the log)", {}, ""},
      {kSpoolZeroDrift, "y_0_drift", "1", 0.002, -0.2, 0.2, "y_0 + size t / length of the log", {}, ""},
      {kSpoolZeroTemperature, "spool_null_temperature", "1/K", 0.0003, -0.02, 0.02,
       "y_0 + size (T_oil - 40 degC)", {}, ""},
      {kIntermittentLeakage, "intermittent_leakage", "m3/(s Pa)", 8e-12, 0, 1e-9,
       "Q += size (p_A - p_B) in a share of the strokes, drawn anew in every ten", {{"share", 0.2, "1"}},
       ""},
      {kIntermittentEffects, "intermittent_effects", "1", 0.2, 0, 1,
       "the effects asked for act in this share of the strokes only, delays excepted", {}, ""},
      {kLeakyStretch, "leaky_stretch", "m3/(s Pa)", 8e-12, 0, 1e-9,
       "Q += size (p_A - p_B) in one stretch of the log, begin and length as shares of it",
       {{"begin", 0.4, "1"}, {"length", 0.2, "1"}}, ""},
      {kQuadraticRelief, "quadratic_relief", "m3/(s Pa2)", 1e-17, 0, 1e-13,
       "Q += size (p_A - crack)^2 above crack", {{"crack", 170e5, "Pa"}}, ""},
      {kRectangularZone, "rectangular_zone", "m3/(s Pa)", 1.5e-11, 0, 1e-9,
       "Q += size (p_A - p_B) where |z - centre| < width: worn zone with sharp edges",
       {{"centre", 0.11, "m"}, {"width", 0.02, "m"}}, ""},
      {kExponentialViscosity, "exponential_viscosity", "1", 0.10, -0.9, 5,
       "flow gain 1 + size (1 - exp(-rate (T_oil - reference))): viscosity falls exponentially",
       {{"rate", 0.06, "1/K"}, {"reference", 313.15, "K"}}, ""},
      {kTwoGainSpool, "two_gain_spool", "1", 0.4, -0.9, 10,
       "the metering edge's gain is 1 + size beyond the knee", {{"knee", 0.15, "1"}}, ""},
      {kWrongArea, "wrong_area", "1", 0.02, -0.5, 0.5, "the true piston area is A_A (1 + size)", {}, ""},
  };
}

std::vector<ImperfectionInfo> SignalKinds() {
  return {
      {kPressureLag, "pressure_signal_lag", "s", 0.005, 0, 1,
       "p_A through a first-order lag, noise after it", {}, ""},
      {kSpoolLag, "spool_signal_lag", "s", 0.005, 0, 1, "y_v through a first-order lag, noise after it", {},
       ""},
      {kPositionLag, "position_signal_lag", "s", 0.005, 0, 1, "z through a first-order lag, noise after it",
       {}, ""},
      {kSignalLag, "signal_lag", "s", 0.005, 0, 1,
       "p_A, y_v and z through the same first-order lag, noise after it", {}, ""},
      {kOneSignalEarly, "one_signal_early", "s", 0.002, 0, 1,
       "p_A, y_v and z are late by size, but for the channel named", {}, "z"},
      {kPressureZero, "pressure_zero", "Pa", 4e5, -1e7, 1e7, "p_A reads size too high", {}, ""},
      {kPressureGain, "pressure_gain", "1", 0.02, -0.9, 5, "p_A reads (1 + size) times the pressure", {}, ""},
      {kPressureGainTemperature, "pressure_gain_temperature", "1/K", 0.0003, -0.01, 0.01,
       "p_A reads 1 + size (T_oil - 40 degC) times the pressure", {}, ""},
      {kPressureGainDrift, "pressure_gain_drift", "1", 0.02, -0.9, 5,
       "p_A reads 1 + size t / length of the log times the pressure", {}, ""},
      {kPressureZeroDrift, "pressure_offset_drift", "Pa", 4e5, -1e7, 1e7,
       "p_A reads size t / length of the log too high", {}, ""},
      {kPressureZeroTemperature, "pressure_offset_temperature", "Pa/K", 2e4, -1e6, 1e6,
       "p_A reads size (T_oil - set_at) too high", {{"set_at", 298.15, "K"}}, ""},
      {kPressureCrosstalk, "pressure_crosstalk", "Pa", 2.5e5, -1e7, 1e7,
       "p_A reads size times the spool position, or U_v / 10 V, too high", {}, "y_v"},
      {kPressureCrosstalk, "pressure_position_crosstalk", "Pa/m", 1e6, -1e9, 1e9,
       "p_A reads size times the position too high", {}, "z"},
      {kPressureBend, "pressure_nonlinearity", "1", 0.02, -0.5, 0.5,
       "p_A reads 1 + size p_A / 100 bar times the pressure", {}, ""},
      {kPositionBend, "position_nonlinearity", "1", 0.01, -0.5, 0.5,
       "z reads z + size z (1 - z / stroke)", {{"stroke", 0.2, "m"}}, ""},
      {kSpoolPressure, "spool_null_pressure", "1/Pa", 2e-10, -1e-8, 1e-8,
       "y_v reads size p_A too high", {}, ""},
      {kFlowGainPressure, "flow_gain_pressure", "1", 0.02, -0.5, 0.5,
       "the opening is 1 + size (p_A - 100 bar) / 100 bar times what y_v reads", {}, ""},
      {kDisplacementGainTemperature, "displacement_gain_temperature", "1/K", 0.0003, -0.01, 0.01,
       "the channel reads 1 + size (T_oil - 40 degC) times its value", {}, "z"},
      {kSpoolBend, "spool_nonlinearity", "1", 0.08, -0.5, 0.5,
       "y_v reads y + size y |y|^(power - 1) at the opening y", {{"power", 3, "1"}}, ""},
      {kSensorHum, "sensor_hum", "Pa", 1.5e5, 0, 1e7,
       "p_A reads size sin(2 pi frequency t + phase) too high",
       {{"frequency", 11.7, "Hz"}, {"phase", 0.4, "rad"}}, ""},
      {kBadStretch, "bad_stretch", "Pa", 10e5, -1e8, 1e8,
       "p_A reads size too high in one stretch, begin and length as shares of the log",
       {{"begin", 0.45, "1"}, {"length", 0.12, "1"}}, ""},
      {kFrozen, "frozen", "s", 4, 0, 1e8, "the signal stands still for size after begin, its noise goes on",
       {{"begin", 20, "s"}}, "p_A"},
      {kColouredNoise, "coloured_noise", "1", 0.1, 0, 100,
       "AR(1) noise of size times the white variance, correlated by phi after 2 ms, beside "
       "`white` times the white variance", {{"phi", 0.8, "1"}, {"white", 0, "1"}}, "all"},
      {kHeavyTails, "heavy_tails", "1", 0.05, 0, 1, "noise times factor in this share of the readings",
       {{"factor", 5, "1"}}, "all"},
      {kPlcFilter, "plc_filter", "s", 0.005, 0, 1, "first-order filter over the readings, noise and all",
       {}, "all"},
      {kSpikes, "spikes", "1", 40, 0, 1e9,
       "readings off by +- size times the noise, `rows` one after the other, at random, rate a second",
       {{"rate", 0.5, "1/s"}, {"rows", 1, "1"}}, "p_A"},
      {kSaturation, "saturation", "1", 160e5, 0, 1e12,
       "readings beyond +- size stop there; SI of the channel", {}, "p_A"},
      {kQuantisation, "quantisation", "1", 4, 0, 1e9, "readings in steps of size times the noise", {}, "all"},
      {kSlowTask, "slow_task", "1", 4, 1, 1e6, "the reading is new every size rows and repeats in between", {}, "z"},
      {kDeadband, "deadband", "1", 4, 0, 1e9,
       "the reading is stored where it has moved by size times the noise, and repeats until then", {}, "z"},
      {kStuck, "stuck", "s", 4, 0, 1e8, "the reading repeats bit for bit for size after begin",
       {{"begin", 20, "s"}}, "y_v"},
      {kWrongUnit, "wrong_unit", "1", 1e-5, 1e-12, 1e12,
       "readings times size: their unit is not the one the machine file says", {}, "p_A"},
      {kTimeJitter, "time_jitter", "1", 0.15, 0, 0.45,
       "time stamps off at random, size times the sample period at most", {}, ""},
      {kDroppedRows, "dropped_rows", "1", 0.01, 0, 0.9, "this share of the rows is missing, at random", {},
       ""},
      {kSlowSampling, "slow_sampling", "s", 0.010, 1e-4, 0.1, "rows every size, whatever the sample period",
       {}, ""},
      {kSlowControl, "slow_control", "s", 0.003, 1e-4, 0.01,
       "the controller's cycle takes size, in which its command stands still, and each of its cycles is a row",
       {}, ""},
      {kCalmPressure, "calm_pressure", "s", 1, 0.3, 100,
       "the set point steps every size and stands still between, and no dither moves the spool", {}, ""},
  };
}

// clang-format on

}  // namespace

const std::vector<ImperfectionInfo>& PressImperfections() {
  static const std::vector<ImperfectionInfo> all = [] {
    std::vector<ImperfectionInfo> list = MachineKinds();
    for (ImperfectionInfo& info : SignalKinds()) list.push_back(std::move(info));
    return list;
  }();
  return all;
}

}  // namespace hydroscope
