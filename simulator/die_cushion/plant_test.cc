#include "simulator/die_cushion/plant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

namespace hydroscope {
namespace {

constexpr double kStep = 50e-6;  // s

PressPlant::Drive Still(const PressMachine& machine, double z, double v, double opening) {
  PressPlant::Drive drive;
  for (int k = 0; k < 3; ++k) {
    drive.ram[k] = {z, v};
    drive.opening[k] = opening;
  }
  drive.p_B = machine.p_rod;
  drive.p_0 = machine.p_supply;
  return drive;
}

/// Pressure after `seconds` with the chamber's volume held and the ram's flow acting (a pump of flow -A_A v).
double Settle(const PressEffectSizes& effects, double v, double opening, double p_start, double seconds,
              double z = 0.1, double gain = 1) {
  const PressMachine machine;
  PressPlant plant(machine, effects, kStep);
  plant.Reset(p_start);
  PressPlant::Drive drive = Still(machine, z, v, opening);
  drive.gain = gain;
  for (int k = 0; k * kStep < seconds; ++k) plant.Step(drive);
  return plant.p_A();
}

TEST(PressPlant, SettlesWhereTheValvePassesTheDisplacedOil) {
  const PressMachine m;
  const double opening = 0.2, v = -0.05;
  const double root = m.A_A * 0.05 / (m.Q_vn / std::sqrt(m.dp_nom) * opening);
  EXPECT_NEAR(Settle({}, v, opening, 50e5, 1.0), root * root, 100);
}

TEST(PressPlant, KeepsTheMassOfTheOil) {
  // Ram moving down sinusoidally, valve opening and closing over both edges; mass = rho V with rho ~ exp(p/K).
  const PressMachine m;
  PressPlant plant(m, {}, kStep);
  plant.Reset(60e5);
  const auto z = [](double t) { return 0.1 + 0.005 * std::cos(8 * t); };
  const auto v = [](double t) { return -0.04 * std::sin(8 * t); };
  const auto opening = [](double t) { return 0.15 * std::sin(8 * t + 0.1); };
  const auto density = [&](double p) { return std::exp(p / m.K); };
  const auto outflow = [&](double p, double y) {
    const double conductance = m.Q_vn / std::sqrt(m.dp_nom);
    return y > 0 ? conductance * y * std::sqrt(p) : conductance * y * std::sqrt(m.p_supply - p);
  };
  const double before = density(plant.p_A()) * (m.V0 + m.A_A * z(0));
  double lost = 0, through = 0;
  int k = 0;
  for (; k * kStep < 2; ++k) {
    const double t = k * kStep;
    const double rate = density(plant.p_A()) * outflow(plant.p_A(), opening(t));
    PressPlant::Drive drive = Still(m, 0, 0, 0);
    for (int part = 0; part < 3; ++part) {
      const double at = t + kStep / 2 * part;
      drive.ram[part] = {z(at), v(at)};
      drive.opening[part] = opening(at);
    }
    plant.Step(drive);
    ASSERT_GT(plant.p_A(), 1e5);
    ASSERT_LT(plant.p_A(), m.p_supply);
    const double next = density(plant.p_A()) * outflow(plant.p_A(), opening(t + kStep));
    lost += kStep / 2 * (rate + next);
    through += kStep * std::abs(rate);
  }
  const double after = density(plant.p_A()) * (m.V0 + m.A_A * z(k * kStep));
  EXPECT_GT(through, 3e-4);
  EXPECT_NEAR(before - lost, after, 1e-5 * through);
}

TEST(PressPlant, AccumulatorTakesTheVolumeOfThePolytropicLaw) {
  PressEffectSizes effects;
  effects.accumulator = 5e-5;
  const PressMachine m;
  PressPlant plant(m, effects, kStep);
  plant.Reset(90e5);
  const PressPlant::Drive drive = Still(m, 0.1, 0, -0.02);  // filled through the supply edge
  double filled = 0;
  const double conductance = m.Q_vn / std::sqrt(m.dp_nom) * 0.02;
  while (plant.p_A() < 180e5) {
    const double rate = conductance * std::sqrt(m.p_supply - plant.p_A());
    plant.Step(drive);
    filled += kStep / 2 * (rate + conductance * std::sqrt(m.p_supply - plant.p_A()));
  }
  const auto gas = [](double p) { return 5e-5 * std::pow((80e5 + 1.01325e5) / (p + 1.01325e5), 1 / 1.3); };
  const double oil = (m.V0 + m.A_A * 0.1) / m.K * (plant.p_A() - 90e5);
  EXPECT_NEAR(filled, oil + gas(90e5) - gas(plant.p_A()), 1e-4 * filled);
}

TEST(PressPlant, EntrainedAirTakesTheVolumeOfItsCompression) {
  PressEffectSizes effects;
  effects.air_fraction = 0.05;
  const PressMachine m;
  PressPlant plant(m, effects, kStep);
  plant.Reset(10e5);
  const PressPlant::Drive drive = Still(m, 0.1, 0, -0.02);
  double filled = 0;
  const double conductance = m.Q_vn / std::sqrt(m.dp_nom) * 0.02;
  while (plant.p_A() < 150e5) {
    const double rate = conductance * std::sqrt(m.p_supply - plant.p_A());
    plant.Step(drive);
    filled += kStep / 2 * (rate + conductance * std::sqrt(m.p_supply - plant.p_A()));
  }
  // Per volume: air -d ln(1 - a + a r), oil its share (1 - x)/K integrated by the midpoint rule.
  const auto ratio = [](double p) { return std::pow(1e5 / (p + 1.01325e5), 1 / 1.4); };
  double oil = 0;
  constexpr int kParts = 20000;
  for (int k = 0; k < kParts; ++k) {
    const double width = (plant.p_A() - 10e5) / kParts, air = 0.05 * ratio(10e5 + (k + 0.5) * width);
    oil += width / m.K * (1 - air / (0.95 + air));
  }
  const double air = std::log((0.95 + 0.05 * ratio(10e5)) / (0.95 + 0.05 * ratio(plant.p_A())));
  EXPECT_NEAR(filled, (m.V0 + m.A_A * 0.1) * (oil + air), 2e-4 * filled);
  EXPECT_GT(air, 0.1 * oil);
}

struct Direction {
  std::string what;
  std::function<void(PressEffectSizes&)> set;
  double v, opening, p_start, seconds;
  int sign;  // of the pressure's change against the machine without the effect
};

TEST(PressPlant, EveryEffectMovesThePressureThePhysicalWay) {
  const std::vector<Direction> directions = {
      {"internal leakage relieves", [](auto& e) { e.internal_leakage = 4e-12; }, -0.05, 0.2, 100e5, 1, -1},
      {"internal leakage fills from the rod side", [](auto& e) { e.internal_leakage = 4e-12; }, 0, 0, 20e5, 1,
       1},
      {"external leakage relieves", [](auto& e) { e.external_leakage = 4e-12; }, 0, 0, 20e5, 1, -1},
      {"orifice leakage relieves", [](auto& e) { e.orifice_leakage = 1e-8; }, -0.05, 0.2, 100e5, 1, -1},
      {"orifice leakage fills from the rod side", [](auto& e) { e.orifice_leakage = 1e-8; }, 0, 0, 20e5, 1,
       1},
      {"entrained air softens", [](auto& e) { e.air_fraction = 0.05; }, -0.01, 0, 20e5, 0.01, -1},
      {"accumulator softens", [](auto& e) { e.accumulator = 5e-5; }, -0.01, 0, 90e5, 0.02, -1},
      {"relief valve relieves above its crack pressure",
       [](auto& e) { e.relief_gain = 3e-11, e.relief_crack = 100e5; }, -0.05, 0.2, 100e5, 1, -1},
      {"relief valve is shut below its crack pressure",
       [](auto& e) { e.relief_gain = 3e-11, e.relief_crack = 130e5; }, -0.05, 0.2, 100e5, 1, 0},
      {"tank back pressure dams", [](auto& e) { e.tank_resistance = 8e11; }, -0.05, 0.2, 100e5, 1, 1},
      {"progressive edge dams at small opening", [](auto& e) { e.curvature = 0.15; }, -0.05, 0.2, 100e5, 1,
       1},
      {"progressive edge relieves at large opening", [](auto& e) { e.curvature = 0.15; }, -0.12, 0.4, 50e5, 1,
       -1},
      {"asymmetry leaves the tank edge alone", [](auto& e) { e.asymmetry = 0.15; }, -0.05, 0.2, 100e5, 1, 0},
      {"asymmetry fills faster", [](auto& e) { e.asymmetry = 0.15; }, 0, -0.02, 50e5, 0.05, 1},
      {"overlap dams", [](auto& e) { e.overlap = 0.02; }, -0.05, 0.2, 100e5, 1, 1},
      {"overlap shuts inside the dead band", [](auto& e) { e.overlap = 0.02; }, 0, -0.015, 50e5, 0.05, -1},
      {"worn zone relieves", [](auto& e) { e.worn_leakage = 1.5e-11; }, -0.05, 0.2, 100e5, 1, -1},
      {"inertance changes nothing at rest", [](auto& e) { e.inertance = 3e7; }, -0.05, 0.2, 100e5, 3, 0},
  };
  for (const Direction& d : directions) {
    PressEffectSizes effects;
    d.set(effects);
    const double change = Settle(effects, d.v, d.opening, d.p_start, d.seconds) -
                          Settle({}, d.v, d.opening, d.p_start, d.seconds);
    if (d.sign == 0) {
      EXPECT_NEAR(change, 0, 100) << d.what;
    } else {
      EXPECT_GT(change * d.sign, 2e4) << d.what;
    }
  }
}

TEST(PressPlant, WarmOilPassesMoreFlow) {
  PressEffectSizes effects;
  effects.viscosity = 0.006;
  EXPECT_DOUBLE_EQ(ViscosityGain(effects, 323.15), 1.06);
  EXPECT_LT(Settle(effects, -0.05, 0.2, 100e5, 1, 0.1, ViscosityGain(effects, 323.15)),
            Settle(effects, -0.05, 0.2, 100e5, 1, 0.1, ViscosityGain(effects, 313.15)));
}

TEST(PressPlant, WornZoneLeaksOnlyWhereItIs) {
  PressEffectSizes effects;
  effects.worn_leakage = 1.5e-11;
  EXPECT_LT(LeakageFlow(effects, 150e5, 60e5, 0.19), 1e-3 * LeakageFlow(effects, 150e5, 60e5, 0.11));
  EXPECT_DOUBLE_EQ(LeakageFlow(effects, 150e5, 60e5, 0.11), 1.5e-11 * 90e5);
}

TEST(PressPlant, OilColumnSwingsWithItsNaturalFrequency) {
  // Wide-open valve to tank, nearly undamped: 1 / (2 pi sqrt(L C)).
  PressMachine m;
  m.p_tank = 50e5;
  PressEffectSizes effects;
  effects.inertance = 3e7;
  constexpr double kFine = 5e-6;
  PressPlant plant(m, effects, kFine);
  plant.Reset(50.2e5);
  const PressPlant::Drive drive = Still(m, 0.1, 0, 1.0);
  double crossing = 0, period = 0;
  for (int k = 0; k * kFine < 0.2 && period == 0; ++k) {
    const double before = plant.p_A() - 50e5;
    plant.Step(drive);
    if (before < 0 || plant.p_A() >= 50e5) continue;
    if (crossing == 0) {
      crossing = k * kFine;
    } else {
      period = k * kFine - crossing;
    }
  }
  const double capacity = (m.V0 + m.A_A * 0.1) / m.K;
  EXPECT_NEAR(period, 2 * 3.14159265 * std::sqrt(effects.inertance * capacity), 0.02 * period);
}

TEST(PressPlant, CavityOpensBelowVapourPressureAndClosesAgain) {
  const PressMachine m;
  PressPlant plant(m, {}, kStep);
  plant.Reset(2e5);
  const PressPlant::Drive pull = Still(m, 0.1, 0.02, 0), push = Still(m, 0.1, -0.02, 0);
  for (int k = 0; k < 1000; ++k) plant.Step(pull);
  EXPECT_DOUBLE_EQ(plant.p_A(), -0.95e5);
  EXPECT_GT(plant.cavity(), 0);
  for (int k = 0; k < 1000; ++k) plant.Step(push);
  EXPECT_EQ(plant.cavity(), 0);
  EXPECT_NEAR(plant.p_A(), 2e5, 1e3);
}

TEST(EdgeWithPlay, LagsTheSpoolByHalfTheWidthWhenItTurns) {
  PressEffectSizes effects;
  effects.hysteresis = 0.01;
  double edge = 0;
  for (double spool = 0; spool < 0.1; spool += 0.001) edge = EdgeWithPlay(effects, spool, edge);
  EXPECT_NEAR(edge, 0.099 - 0.005, 1e-9);
  EXPECT_NEAR(EdgeWithPlay(effects, 0.095, edge), 0.094, 1e-9);  // inside the play: it stands
  EXPECT_NEAR(EdgeWithPlay(effects, 0.080, edge), 0.085, 1e-9);  // beyond: it follows
}

}  // namespace
}  // namespace hydroscope
