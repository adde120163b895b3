#include "simulator/die_cushion/imperfections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>

#include "simulator/die_cushion/plant.h"
#include "simulator/die_cushion/plant_laws.h"
#include "simulator/die_cushion/press.h"
#include "simulator/die_cushion/sensor_imperfections.h"

namespace hydroscope {
namespace {

constexpr double kBar = 1e5;

PressOptions Plain(double seconds = 12) {
  PressOptions options;
  options.seconds = seconds;
  options.oil_end = options.oil_start + 15;
  return options;
}
PressOptions Imperfect(const ImperfectionSetting& setting, double seconds = 12) {
  PressOptions options = Plain(seconds);
  options.imperfections = {setting};
  return options;
}
PlantLaws LawsOf(const ImperfectionSetting& setting) {
  return PlantLawsOf(ResolveImperfections({setting}).value());
}
PlantMoments MomentsOf(const ImperfectionSetting& setting, double seconds) {
  return PlantMoments(ResolveImperfections({setting}).value(), seconds, 5);
}
double Std(const std::vector<double>& x) {
  double mean = 0, square = 0;
  for (const double value : x) mean += value / static_cast<double>(x.size());
  for (const double value : x) square += (value - mean) * (value - mean) / static_cast<double>(x.size());
  return std::sqrt(square);
}
std::vector<double> Difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> difference(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) difference[k] = a[k] - b[k];
  return difference;
}
/// Correlation of neighbouring values.
double Neighbours(const std::vector<double>& x) {
  double sum = 0, square = 0;
  for (std::size_t k = 1; k < x.size(); ++k) sum += x[k] * x[k - 1], square += x[k] * x[k];
  return sum / square;
}
/// What sensors log of a machine at rest at 100 bar, channel p_A.
std::vector<double> AtRest(const ImperfectionSetting& setting, int rows, double period = 0.002) {
  PressOptions options = Plain(rows * period);
  options.sample_period = period;
  options.noise_seed = 7;
  SensorImperfections sensors(ResolveImperfections({setting}).value(), options);
  NoiseSource noise(options.noise, 3);
  std::vector<double> p_A;
  for (int k = 0; k < rows; ++k) {
    PressRow row{k * period, 100 * kBar, 60 * kBar, 210 * kBar, 0.1, 0.1, 1, 313.15};
    sensors.Distort(row);
    ReadSensors(options.noise, options.quantum, sensors.Noise(noise.Next()), row);
    if (sensors.Transport(row)) p_A.push_back(row.p_A);
  }
  return p_A;
}

TEST(Imperfections, AreAtLeastTwentyEightKindsWithNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const ImperfectionInfo& info : PressImperfections()) {
    names.insert(info.name);
    EXPECT_LE(info.low, info.typical_size) << info.name;
    EXPECT_GE(info.high, info.typical_size) << info.name;
    EXPECT_FALSE(info.unit.empty() || info.law.empty()) << info.name;
  }
  EXPECT_EQ(names.size(), PressImperfections().size());
  EXPECT_GE(names.size(), 28u);
}

TEST(Imperfections, OfTypicalSizeChangeTheLog) {
  PressOptions base = Plain(30);
  base.effects = {{"internal_leakage", 4e-12, {}}};
  const SimulatedLog clean = SimulatePress(base);
  for (const ImperfectionInfo& info : PressImperfections()) {
    PressOptions options = base;
    options.imperfections = {{info.name, info.typical_size, {}, ""}};
    const Status valid = Validate(options);
    ASSERT_TRUE(valid) << valid.error().text;
    const SimulatedLog log = SimulatePress(options);
    const bool changed = log.t != clean.t || log.p_A != clean.p_A || log.z != clean.z || log.y_v != clean.y_v;
    EXPECT_TRUE(changed) << info.name;
  }
}

TEST(Imperfections, AllTogetherAreDetermined) {
  PressOptions options = Plain(6);
  options.effects = {{"internal_leakage", 4e-12, {}}};
  for (const ImperfectionInfo& info : PressImperfections())
    options.imperfections.push_back({info.name, info.typical_size, {}, ""});
  const SimulatedLog log = SimulatePress(options), again = SimulatePress(options);
  EXPECT_EQ(log.t, again.t);
  EXPECT_EQ(log.p_A, again.p_A);
  EXPECT_EQ(log.z, again.z);
  EXPECT_EQ(log.y_v, again.y_v);
  options.seed = 2;
  EXPECT_NE(log.p_A, SimulatePress(options).p_A);
}

TEST(Imperfections, OfTheMachineOfSizeZeroAreNone) {
  const SimulatedLog clean = SimulatePress(Plain(6));
  for (const ImperfectionInfo& info : PressImperfections()) {
    if (info.kind > ImperfectionKind::kBadStretch || info.kind == ImperfectionKind::kCheckValve ||
        info.kind == ImperfectionKind::kIntermittentEffects)
      continue;
    const SimulatedLog log = SimulatePress(Imperfect({info.name, 0, {}, ""}, 6));
    EXPECT_EQ(log.p_A, clean.p_A) << info.name;
    EXPECT_EQ(log.z, clean.z) << info.name;
  }
}

TEST(Imperfections, HalvingTheStepChangesNothingThatASensorCouldSee) {
  for (const char* kind : {"return_line_resistance", "check_valve", "laminar_edge",
                           "pressure_dependent_bulk_modulus", "quadratic_relief", "two_gain_spool"}) {
    for (const double inertance : {0.0, 3e7}) {
      PressOptions options = Imperfect({kind, 0, {}, ""}, 6);
      for (const ImperfectionInfo& info : PressImperfections())
        if (info.name == kind) options.imperfections[0].size = info.typical_size;
      if (inertance > 0) options.effects = {{"line_inertance", inertance, {}}};
      PressOptions halved = options;
      halved.max_step /= 2;
      const std::vector<double> difference =
          Difference(SimulateClean(options).p_A, SimulateClean(halved).p_A);
      EXPECT_LT(Std(difference), 1e4) << kind << " " << inertance;
    }
  }
}

TEST(Imperfections, AReturnLineDropsInProportionToTheFlow) {
  const PlantLaws laws = LawsOf({"return_line_resistance", 4e8, {}, ""});
  const double g = 4e-8, flow = laws.EdgeFlow(g, 100 * kBar);
  EXPECT_NEAR(flow * flow / (g * g) + 4e8 * flow, 100 * kBar, 50);
  EXPECT_NEAR(laws.EdgeDrop(g, flow), 100 * kBar, 50);
  EXPECT_DOUBLE_EQ(laws.EdgeFlow(-g, 100 * kBar), -g * SignedRoot(100 * kBar));  // no return line there
}

TEST(Imperfections, ACheckValveOpensAtItsPressureAndLetsNothingBack) {
  const PlantLaws laws = LawsOf({"check_valve", 3 * kBar, {{"slope", 0}}, ""});
  EXPECT_EQ(laws.EdgeFlow(4e-8, 2.9 * kBar), 0);
  EXPECT_EQ(laws.EdgeFlow(4e-8, -5 * kBar), 0);
  EXPECT_NEAR(laws.EdgeFlow(4e-8, 103 * kBar), 4e-8 * std::sqrt(100 * kBar), 1e-9);
}

TEST(Imperfections, ALaminarEdgeIsProportionalToSmallPressureDifferencesOnly) {
  const PlantLaws laws = LawsOf({"laminar_edge", 8 * kBar, {}, ""});
  EXPECT_NEAR(laws.EdgeFlow(4e-8, 0.4 * kBar) / laws.EdgeFlow(4e-8, 0.2 * kBar), 2, 0.01);
  EXPECT_NEAR(laws.EdgeFlow(4e-8, 200 * kBar) / (4e-8 * std::sqrt(200 * kBar)), 1, 1e-3);
  for (const double dp : {1 * kBar, 8 * kBar, 80 * kBar})
    EXPECT_NEAR(laws.EdgeDrop(4e-8, laws.EdgeFlow(4e-8, dp)) / dp, 1, 1e-9);
}

TEST(Imperfections, ATankLineAtAnotherPressureShiftsTheEdgeToTheTankOnly) {
  const PressMachine machine;
  const PressPlant known(machine, {}, 5e-5);
  const PressPlant true_plant(machine, {}, 5e-5, LawsOf({"tank_pressure", 5 * kBar, {}, ""}));
  EXPECT_DOUBLE_EQ(true_plant.ValveFlow(4e-8, 105 * kBar, 0), known.ValveFlow(4e-8, 100 * kBar, 0));
  EXPECT_DOUBLE_EQ(true_plant.ValveFlow(-4e-8, 50 * kBar, 210 * kBar),
                   known.ValveFlow(-4e-8, 50 * kBar, 210 * kBar));
}

/// dp_A/dt of a closed chamber into which `flow` comes, by one short step.
double RiseRate(const PlantLaws& laws, double p_A, double leakage = 0, double z = 0.1) {
  PressMachine machine;
  constexpr double kStep = 1e-7;
  PressPlant plant(machine, {}, kStep, laws);
  plant.Reset(p_A);
  PressPlant::Drive drive;
  for (auto& ram : drive.ram) ram = {z, -0.05};
  for (double& opening : drive.opening) opening = 0;
  drive.p_B = 60 * kBar;
  drive.leakage = leakage;
  plant.Step(drive);
  return (plant.p_A() - p_A) / kStep;
}

TEST(Imperfections, OilStiffensInProportionToThePressure) {
  const PlantLaws laws = LawsOf({"pressure_dependent_bulk_modulus", 11, {}, ""});
  const double ratio = RiseRate(laws, 200 * kBar) / RiseRate({}, 200 * kBar);
  EXPECT_NEAR(ratio, (1.21e9 + 11 * 200e5) / 1.21e9, 1e-6);
}

TEST(Imperfections, AWrongAreaDisplacesMoreOilAndHoldsMore) {
  const double volume = 1.65e-3 + 0.0125 * 0.1, more = 1.65e-3 + 0.0125 * 1.02 * 0.1;
  EXPECT_NEAR(RiseRate(LawsOf({"wrong_area", 0.02, {}, ""}), 100 * kBar) / RiseRate({}, 100 * kBar),
              1.02 * volume / more, 1e-6);
}

TEST(Imperfections, LeaksFollowTheirLaws) {
  const PlantLaws relief = LawsOf({"quadratic_relief", 1e-17, {{"crack", 170e5}}, ""});
  EXPECT_EQ(relief.Leakage(169 * kBar, 0, 0, 0), 0);
  EXPECT_NEAR(relief.Leakage(190 * kBar, 0, 0, 0), 1e-17 * 4e12, 1e-12);
  const PlantLaws zone = LawsOf({"rectangular_zone", 1.5e-11, {{"centre", 0.11}, {"width", 0.02}}, ""});
  EXPECT_EQ(zone.Leakage(100 * kBar, 60 * kBar, 0, 0.131), 0);
  EXPECT_DOUBLE_EQ(zone.Leakage(100 * kBar, 60 * kBar, 0, 0.129), 1.5e-11 * 40 * kBar);
  const PlantLaws supply = LawsOf({"supply_leakage", 1e-8, {}, ""});
  EXPECT_NEAR(supply.Leakage(100 * kBar, 0, 200 * kBar, 0), -1e-8 * std::sqrt(100 * kBar), 1e-9);
  const double volume = 1.65e-3 + 0.0125 * 0.1;
  EXPECT_NEAR(RiseRate({}, 100 * kBar) - RiseRate({}, 100 * kBar, 8e-12), 8e-12 * 40 * kBar * 1.21e9 / volume,
              1e3);
}

TEST(Imperfections, TheLeakGrowsWithTheOilTemperature) {
  const PlantMoments moments = MomentsOf({"leakage_temperature", 4e-12, {{"rate", 0.035}}, ""}, 60);
  EXPECT_DOUBLE_EQ(moments.At(5, 313.15, 0).leakage, 4e-12);
  EXPECT_NEAR(moments.At(5, 333.15, 0).leakage, 4e-12 * std::exp(0.7), 1e-20);
}

TEST(Imperfections, ParametersMoveLinearlyOverTheLog) {
  EXPECT_DOUBLE_EQ(MomentsOf({"K_drift", -0.1, {}, ""}, 60).At(30, 313, 0).K_factor, 0.95);
  EXPECT_NEAR(MomentsOf({"bulk_modulus_temperature", -0.004, {}, ""}, 60).At(30, 323.15, 0).K_factor, 0.96,
              1e-12);
  EXPECT_DOUBLE_EQ(MomentsOf({"V0_drift", 0.1, {}, ""}, 60).At(60, 313, 0).V0_factor, 1.1);
  EXPECT_DOUBLE_EQ(MomentsOf({"Q_vn_drift", 0.02, {}, ""}, 60).At(15, 313, 0).gain, 1.005);
  EXPECT_DOUBLE_EQ(MomentsOf({"y_0_drift", 0.002, {}, ""}, 60).At(30, 313, 0).y_0_shift, 0.001);
  EXPECT_NEAR(MomentsOf({"spool_null_temperature", 2e-4, {}, ""}, 60).At(30, 323.15, 0).y_0_shift, 0.002,
              1e-15);
}

TEST(Imperfections, ParametersMoveInOneStep) {
  using Moment = PlantMoments::Moment;
  for (const auto& [kind, value] : {std::pair<const char*, double Moment::*>{"K_step", &Moment::K_factor},
                                    {"V0_step", &Moment::V0_factor},
                                    {"Q_vn_step", &Moment::gain}}) {
    const PlantMoments step = MomentsOf({kind, 0.02, {{"until", 0.5}}, ""}, 60);
    EXPECT_DOUBLE_EQ(step.At(29, 313, 0).*value, 1.02) << kind;
    EXPECT_DOUBLE_EQ(step.At(31, 313, 0).*value, 1) << kind;
  }
  const PlantMoments null = MomentsOf({"y_0_step", 0.02, {{"until", 0.5}}, ""}, 60);
  EXPECT_DOUBLE_EQ(null.At(29, 313, 0).y_0_shift, 0.02);
  EXPECT_DOUBLE_EQ(null.At(31, 313, 0).y_0_shift, 0);
}

TEST(Imperfections, ViscosityMayFallExponentially) {
  const PlantMoments moments = MomentsOf({"exponential_viscosity", 0.1, {{"rate", 0.06}}, ""}, 60);
  EXPECT_NEAR(moments.At(0, 333.15, 0).gain, 1 + 0.1 * (1 - std::exp(-1.2)), 1e-12);
  EXPECT_NEAR(moments.At(0, 303.15, 0).gain, 1 + 0.1 * (1 - std::exp(0.6)), 1e-12);
}

TEST(Imperfections, TheSecondGainBeginsAtTheKnee) {
  const PlantLaws laws = LawsOf({"two_gain_spool", 0.4, {{"knee", 0.15}}, ""});
  EXPECT_DOUBLE_EQ(laws.Opening(0.1), 0.1);
  EXPECT_NEAR(laws.Opening(0.25), 0.25 + 0.4 * 0.1, 1e-15);
  EXPECT_NEAR(laws.Opening(-0.25), -0.29, 1e-15);
}

TEST(Imperfections, AnIntermittentLeakComesInItsShareOfEveryTenStrokes) {
  const PlantMoments moments = MomentsOf({"intermittent_leakage", 8e-12, {{"share", 0.2}}, ""}, 60);
  for (int ten = 0; ten < 5; ++ten) {
    int leaking = 0;
    for (int k = 0; k < 10; ++k) leaking += moments.At(0, 313, 10 * ten + k).leakage == 8e-12;
    EXPECT_EQ(leaking, 2);
  }
}

TEST(Imperfections, AStretchLeaksBetweenItsBeginAndEndOnly) {
  const PlantMoments moments =
      MomentsOf({"leaky_stretch", 8e-12, {{"begin", 0.4}, {"length", 0.2}}, ""}, 100);
  EXPECT_EQ(moments.At(39.9, 313, 0).leakage, 0);
  EXPECT_EQ(moments.At(40.1, 313, 0).leakage, 8e-12);
  EXPECT_EQ(moments.At(60.1, 313, 0).leakage, 0);
}

TEST(Imperfections, IntermittentEffectsActInTheirShareOfTheStrokes) {
  PressOptions options = Plain(60);
  options.effects = {{"external_leakage", 4e-12, {}}};
  const SimulatedLog always = SimulateClean(options);
  options.imperfections = {{"intermittent_effects", 1, {}, ""}};
  EXPECT_EQ(SimulateClean(options).p_A, always.p_A);
  options.imperfections[0].size = 0;
  EXPECT_EQ(SimulateClean(options).p_A, SimulateClean(Plain(60)).p_A);
}

TEST(Imperfections, TheRippleHasItsFrequencyAndAmplitude) {
  const PlantMoments moments =
      MomentsOf({"periodic_disturbance", 2e-5, {{"frequency", 7.3}, {"phase", 0}}, ""}, 60);
  EXPECT_NEAR(moments.Ripple(0.25 / 7.3), 2e-5, 1e-15);
  EXPECT_NEAR(moments.Ripple(0.5 / 7.3), 0, 1e-15);
}

TEST(Imperfections, ALagFollowsAStepByTheExponentialLaw) {
  FirstOrderLag lag(0.005, 0.0001);
  EXPECT_EQ(lag.Step(0), 0);
  double value = 0;
  for (int k = 0; k < 50; ++k) value = lag.Step(1);
  EXPECT_NEAR(value, 1 - std::exp(-1.0), 1e-12);
}

TEST(Imperfections, ALagOfOneSignalLeavesTheOthersAlone) {
  const SimulatedLog clean = SimulateClean(Plain());
  const SimulatedLog lagged = SimulateClean(Imperfect({"position_signal_lag", 0.005, {}, ""}));
  EXPECT_EQ(lagged.p_A, clean.p_A);
  EXPECT_EQ(lagged.y_v, clean.y_v);
  // While the ram goes at a constant speed v the reading trails by v times the lag.
  const StrokeTruth& stroke = clean.truth.strokes.front();
  const auto middle = static_cast<std::size_t>((stroke.begin + stroke.end) / 2 / 0.002);
  EXPECT_NEAR(lagged.z[middle] - clean.z[middle], stroke.speed * 0.005, 5e-6);
  const SimulatedLog all = SimulateClean(Imperfect({"signal_lag", 0.005, {}, ""}));
  EXPECT_EQ(all.z, lagged.z);
  EXPECT_NE(all.p_A, clean.p_A);
  EXPECT_NE(all.y_v, clean.y_v);
}

TEST(Imperfections, AllSignalsButOneAreLate) {
  const SimulatedLog clean = SimulateClean(Plain());
  const SimulatedLog late = SimulateClean(Imperfect({"one_signal_early", 0.002, {}, "z"}));
  EXPECT_EQ(late.z, clean.z);
  for (std::size_t k = 1; k < clean.rows(); ++k) {
    ASSERT_NEAR(late.p_A[k], clean.p_A[k - 1], 1e-3) << k;
    ASSERT_NEAR(late.y_v[k], clean.y_v[k - 1], 1e-12) << k;
  }
}

TEST(Imperfections, ThePressureReadsWithGainZeroDriftAndHum) {
  PressOptions options = Plain();
  options.noise = {0, 0, 0, 0, 0, 0, 0, 0};
  const SimulatedLog clean = SimulatePress(options);
  const auto read = [&](const std::string& kind, double size, std::map<std::string, double> extra = {}) {
    options.imperfections = {{kind, size, std::move(extra), ""}};
    return SimulatePress(options).p_A;
  };
  const std::vector<double> gain = read("pressure_gain", 0.02), zero = read("pressure_zero", 4e5),
                            warm = read("pressure_gain_temperature", 0.001),
                            warm_zero = read("pressure_offset_temperature", 2e4, {{"set_at", 300}}),
                            of_spool = read("pressure_crosstalk", 2e5),
                            of_position = read("pressure_position_crosstalk", 2e6),
                            growing = read("pressure_gain_drift", 0.02),
                            bent = read("pressure_nonlinearity", 0.02),
                            drift = read("pressure_offset_drift", 4e5),
                            bad = read("bad_stretch", 10e5, {{"begin", 0.5}, {"length", 0.25}}),
                            hum = read("sensor_hum", 1e5, {{"frequency", 12.5}, {"phase", 0}});
  for (std::size_t k = 0; k < clean.rows(); ++k) {
    ASSERT_NEAR(gain[k], 1.02 * clean.p_A[k], 1e-3);
    ASSERT_NEAR(warm[k], (1 + 0.001 * (clean.T_oil[k] - 313.15)) * clean.p_A[k], 1e-3);
    ASSERT_NEAR(warm_zero[k], clean.p_A[k] + 2e4 * (clean.T_oil[k] - 300), 1e-3);
    ASSERT_NEAR(of_spool[k], clean.p_A[k] + 2e5 * clean.y_v[k], 1e-3);
    ASSERT_NEAR(of_position[k], clean.p_A[k] + 2e6 * clean.z[k], 1e-3);
    ASSERT_NEAR(bent[k], clean.p_A[k] * (1 + 0.02 * clean.p_A[k] / 100e5), 1e-3);
    ASSERT_NEAR(growing[k], clean.p_A[k] * (1 + 0.02 * clean.t[k] / 12), 1e-3);
    ASSERT_NEAR(zero[k], clean.p_A[k] + 4e5, 1e-3);
    ASSERT_NEAR(drift[k], clean.p_A[k] + 4e5 * clean.t[k] / 12, 1e-3);
    ASSERT_NEAR(bad[k], clean.p_A[k] + (k >= 3000 && k < 4500 ? 10e5 : 0), 1e-3);
    ASSERT_NEAR(hum[k], clean.p_A[k] + 1e5 * std::sin(2 * std::numbers::pi * 12.5 * clean.t[k]), 1e-3);
  }
}

TEST(Imperfections, DisplacementsAndCrosstalkGoWithTheirChannel) {
  PressOptions options = Plain();
  options.noise = {0, 0, 0, 0, 0, 0, 0, 0};
  const SimulatedLog clean = SimulatePress(options);
  options.imperfections = {{"displacement_gain_temperature", 1e-3, {}, "y_v"},
                           {"pressure_crosstalk", 2e5, {}, "U_v"},
                           {"position_nonlinearity", 0.01, {{"stroke", 0.25}}, ""},
                           {"spool_null_pressure", 2e-10, {}, ""},
                           {"flow_gain_pressure", 0.02, {}, ""}};
  const SimulatedLog log = SimulatePress(options);
  for (std::size_t k = 0; k < clean.rows(); ++k) {
    ASSERT_NEAR(log.z[k], clean.z[k] + 0.01 * clean.z[k] * (1 - clean.z[k] / 0.25), 1e-12);
    const double warm = clean.y_v[k] * (1 + 1e-3 * (clean.T_oil[k] - 313.15));
    ASSERT_NEAR(log.y_v[k], (warm + 2e-10 * log.p_A[k]) / (1 + 0.02 * (log.p_A[k] / 100e5 - 1)), 1e-12);
    ASSERT_NEAR(log.p_A[k], clean.p_A[k] + 2e5 * clean.U_v[k] / 10, 1e-3);
  }
}

TEST(Imperfections, ColouredNoiseHasItsVarianceAndCorrelation) {
  const std::vector<double> noise = AtRest({"coloured_noise", 0.1, {{"phi", 0.8}}, ""}, 400000);
  std::vector<double> centred = noise;
  for (double& value : centred) value -= 100 * kBar;
  EXPECT_NEAR(Std(noise), std::sqrt(0.1) * 2.2e5, 0.02 * 0.7e5);
  EXPECT_NEAR(Neighbours(centred), 0.8, 0.01);
  // phi is that of 2 ms: at 1 ms neighbours are correlated by its root.
  std::vector<double> fast = AtRest({"coloured_noise", 0.1, {{"phi", 0.8}}, ""}, 400000, 0.001);
  for (double& value : fast) value -= 100 * kBar;
  EXPECT_NEAR(Neighbours(fast), std::sqrt(0.8), 0.01);
  const std::vector<double> beside =
      AtRest({"coloured_noise", 0.1, {{"phi", 0.8}, {"white", 1}}, ""}, 400000);
  EXPECT_NEAR(Std(beside), std::sqrt(1.1) * 2.2e5, 0.01 * 2.2e5);
  EXPECT_NEAR(Std(AtRest({"coloured_noise", 0.1, {}, "z"}, 100000)), 2.2e5, 0.01 * 2.2e5);
}

TEST(Imperfections, HeavyTailsAreRareLargeErrors) {
  const std::vector<double> noise = AtRest({"heavy_tails", 0.05, {{"factor", 5}}, ""}, 400000);
  EXPECT_NEAR(Std(noise) / 2.2e5, std::sqrt(0.95 + 0.05 * 25), 0.02);
  const auto beyond = std::count_if(noise.begin(), noise.end(),
                                    [](double p) { return std::abs(p - 100 * kBar) > 4 * 2.2e5; });
  EXPECT_NEAR(static_cast<double>(beyond) / 400000, 0.05 * 0.4237, 0.003);  // P(|normal| > 0.8)
}

TEST(Imperfections, APlcFilterSmoothsTheNoise) {
  std::vector<double> noise = AtRest({"plc_filter", 0.005, {}, ""}, 400000);
  for (double& value : noise) value -= 100 * kBar;
  const double keep = std::exp(-0.4);
  EXPECT_NEAR(Neighbours(noise), keep, 0.01);
  EXPECT_NEAR(Std(noise) / 2.2e5, std::sqrt((1 - keep) / (1 + keep)), 0.01);
}

TEST(Imperfections, ReadingsAreLimitedSteppedStuckAndOutliers) {
  for (const double value : AtRest({"saturation", 100.5 * kBar, {}, ""}, 20000))
    ASSERT_LE(value, 100.5 * kBar);
  for (const double value : AtRest({"quantisation", 4, {}, ""}, 2000))
    ASSERT_NEAR(std::remainder(value, 4 * 2.2e5), 0, 1e-6);
  const std::vector<double> stuck = AtRest({"stuck", 0.1, {{"begin", 0.2}}, "p_A"}, 400);
  for (int k = 101; k < 150; ++k) ASSERT_EQ(stuck[k], stuck[100]);
  EXPECT_NE(stuck[99], stuck[100]);
  EXPECT_NE(stuck[150], stuck[100]);
  const std::vector<double> slow = AtRest({"slow_task", 4, {}, "p_A"}, 400);
  for (int k = 0; k < 400; ++k) ASSERT_EQ(slow[k], slow[k - k % 4]);
  EXPECT_NE(slow[8], slow[4]);
  const std::vector<double> stored = AtRest({"deadband", 2, {}, "p_A"}, 2000);
  for (int k = 1; k < 2000; ++k)
    ASSERT_TRUE(stored[k] == stored[k - 1] || std::abs(stored[k] - stored[k - 1]) >= 2 * 2.2e5);
  EXPECT_NE(stored.front(), stored.back());
  const std::vector<double> spiked = AtRest({"spikes", 40, {{"rate", 0.5}}, ""}, 400000);
  const auto spikes = std::count_if(spiked.begin(), spiked.end(),
                                    [](double p) { return std::abs(p - 100 * kBar) > 30 * 2.2e5; });
  EXPECT_NEAR(static_cast<double>(spikes), 400, 80);
  const std::vector<double> pulses = AtRest({"spikes", 40, {{"rate", 0.5}, {"rows", 3}}, ""}, 400000);
  EXPECT_NEAR(static_cast<double>(std::ranges::count_if(
                  pulses, [](double p) { return std::abs(p - 100 * kBar) > 30 * 2.2e5; })),
              1200, 240);
  EXPECT_NEAR(AtRest({"wrong_unit", 1e-5, {}, ""}, 1)[0], 100, 15);
}

TEST(Imperfections, AFrozenSignalKeepsItsNoise) {
  PressOptions options = Plain();
  const SimulatedLog clean = SimulatePress(options);
  options.imperfections = {{"frozen", 2, {{"begin", 3}}, "p_A"}};
  const SimulatedLog frozen = SimulatePress(options);
  std::vector<double> held(frozen.p_A.begin() + 1500, frozen.p_A.begin() + 2500);
  EXPECT_NEAR(Std(held), 2.2e5, 0.1 * 2.2e5);
  EXPECT_EQ(frozen.p_A[1499], clean.p_A[1499]);
  EXPECT_EQ(frozen.p_A[2500], clean.p_A[2500]);
}

TEST(Imperfections, RowsAreLateLostAndFew) {
  const SimulatedLog clean = SimulatePress(Plain());
  const SimulatedLog jitter = SimulatePress(Imperfect({"time_jitter", 0.15, {}, ""}));
  EXPECT_EQ(jitter.p_A, clean.p_A);
  EXPECT_NEAR(Std(Difference(jitter.t, clean.t)), 0.15 * 0.002 / std::sqrt(3.0), 1e-5);
  EXPECT_TRUE(std::is_sorted(jitter.t.begin(), jitter.t.end()));
  EXPECT_NEAR(static_cast<double>(SimulatePress(Imperfect({"dropped_rows", 0.1, {}, ""})).rows()), 5400, 100);
  const SimulatedLog slow = SimulatePress(Imperfect({"slow_sampling", 0.02, {}, ""}));
  EXPECT_EQ(slow.rows(), 600u);
  EXPECT_DOUBLE_EQ(slow.truth.options.sample_period, 0.02);
  const SimulatedLog held = SimulatePress(Imperfect({"slow_control", 0.005, {}, ""}));
  EXPECT_EQ(held.rows(), 2400u);
  EXPECT_DOUBLE_EQ(held.truth.options.control_period, 0.005);
  EXPECT_EQ(SimulatePress(Imperfect({"calm_pressure", 3, {}, ""})).truth.options.motion.dither, 0);
}

TEST(Imperfections, AnotherReadingOfTheSameRunHasThem) {
  PressOptions options = Imperfect({"coloured_noise", 0.3, {}, ""});
  const SimulatedLog clean = SimulateClean(options);
  EXPECT_EQ(AddSensorNoise(clean, options, clean.truth.options.noise_seed).p_A, SimulatePress(options).p_A);
}

TEST(Imperfections, ErrorsNameValueLimitAndTheNearestKind) {
  const auto message = [](const ImperfectionSetting& setting) {
    const auto list = ResolveImperfections({setting});
    return list ? std::string() : list.error().text;
  };
  EXPECT_NE(message({"colored_noise", 0.1, {}, ""}).find("did you mean 'coloured_noise'"), std::string::npos);
  EXPECT_NE(message({"coloured_noise", 0.1, {{"phy", 0.8}}, ""}).find("did you mean 'phi'"),
            std::string::npos);
  EXPECT_NE(message({"coloured_noise", 0.1, {}, "p_C"}).find("p_C"), std::string::npos);
  EXPECT_NE(message({"K_drift", -2, {}, ""}).find("-0.9"), std::string::npos);
  EXPECT_NE(message({"K_drift", 0.1, {}, "p_A"}).find("no channel"), std::string::npos);
  EXPECT_NE(message({"K_drift", NAN, {}, ""}).find("K_drift is nan"), std::string::npos);
}

}  // namespace
}  // namespace hydroscope
