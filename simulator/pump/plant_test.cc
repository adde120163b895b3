#include <gtest/gtest.h>

#include <cmath>

#include "simulator/pump/log.h"

namespace hydroscope {
namespace {

PumpOptions Quiet(PumpManoeuvre manoeuvre) {
  PumpOptions o;
  o.manoeuvre = manoeuvre;
  o.seconds = 3;
  o.speed_swing = 0;
  o.ripple = 0;
  o.sensors = {.pressure = 0, .position = 0, .flow = 0, .speed = 0, .flow_lag = 0};
  return o;
}

TEST(Pump, HoldsThePressureThatItsSpringSetsWithTheDroopOfTheEquations) {
  const PumpOptions o = Quiet(PumpManoeuvre::kStep);
  const PumpLog log = SimulatePump(o);
  const PumpMachine& m = o.machine;
  const PumpState& s = log.truth.back();
  EXPECT_NEAR(s.p_s * m.spool_area, m.preload + m.spring * s.x_v, 1);
  EXPECT_NEAR(s.p_c * m.piston_area, m.piston_spring * s.x_p, 1);
  EXPECT_NEAR(m.leakage * s.p_c, m.flow_gain * s.x_v * std::sqrt((s.p_s - s.p_c) / m.gain_drop), 1e-6);
  EXPECT_NEAR(log.flow.back(),
              log.speed.back() * m.displacement * (1 - s.x_p / m.piston_stroke) - m.leakage * s.p_c, 2e-6);
  EXPECT_GT(log.truth.back().p_s, log.truth.front().p_s) << "less flow, more pressure";
}

TEST(Pump, SwingsItsPlateBetweenTheStops) {
  PumpOptions o = Quiet(PumpManoeuvre::kStep);
  o.machine.preload = 1500;  // more than the load ever needs
  const PumpLog log = SimulatePump(o);
  for (const PumpState& s : log.truth) {
    EXPECT_GE(s.x_p, 0);
    EXPECT_LE(s.x_p, o.machine.piston_stroke);
    EXPECT_LE(std::abs(s.x_v), o.machine.spool_stroke);
  }
}

TEST(Pump, RipplesWithItsPistonsAboutTheMean) {
  PumpOptions o;
  o.seconds = 2;
  const PumpLog log = SimulatePump(o);
  EXPECT_GT(log.RippleRms(), 7e4);
  EXPECT_LT(log.RippleRms(), 3e5);
  double mean = 0;
  for (const double r : log.ripple) mean += r / static_cast<double>(log.ripple.size());
  EXPECT_LT(std::abs(mean), 0.02 * log.RippleRms());
}

TEST(Pump, EveryFaultShowsInTheLog) {
  PumpOptions o = Quiet(PumpManoeuvre::kLevels);
  const PumpLog healthy = SimulatePump(o);
  const PumpSensors noise;
  for (const PumpFault& fault : AllPumpFaults()) {
    PumpOptions with = o;
    with.faults.*fault.size = fault.typical;
    const PumpLog log = SimulatePump(with);
    double energy = 0;
    for (std::size_t i = 0; i < log.t.size(); ++i)
      energy += std::pow((log.p_s[i] - healthy.p_s[i]) / noise.pressure, 2) +
                std::pow((log.p_c[i] - healthy.p_c[i]) / noise.pressure, 2) +
                std::pow((log.x_p[i] - healthy.x_p[i]) / noise.position, 2);
    EXPECT_GT(energy / static_cast<double>(log.t.size()), 1) << fault.id;
  }
}

TEST(Pump, ItsFlowSensorReadsTheFlowThatLeavesTheLineInTheSameStep) {
  PumpOptions o = Quiet(PumpManoeuvre::kLevels);
  o.period = 5e-5;  // a row is one step
  const PumpLog log = SimulatePump(o);
  const PumpMachine& m = o.machine;
  const auto enters = [&](std::size_t i) {  // m^3/s, into the line, behind the spool taken off
    const PumpState& s = log.truth[i];
    const double opening = 0.5 * (s.x_v + std::hypot(s.x_v, m.edge_rounding));
    return o.speed * m.displacement * (1 - s.x_p / m.piston_stroke) - m.spool_area * s.v_v -
           m.flow_gain * opening * std::sqrt((s.p_s - s.p_c) / m.gain_drop);
  };
  double wrong = 0, steps = 0;  // what the balance of a step misses, beside the change of the flow
  for (std::size_t i = 1; i + 1 < log.t.size(); ++i) {
    const double stored = (log.truth[i].p_s - log.truth[i - 1].p_s) * m.line_volume / m.modulus / o.period;
    const double change = log.flow[i + 1] - log.flow[i];
    wrong += (0.5 * (enters(i - 1) + enters(i)) - stored - log.flow[i + 1]) * change;
    steps += change * change;
  }
  EXPECT_NEAR(wrong / steps, 0, 0.1);
}

TEST(Pump, WritesTimesThatDifferInALongLog) {
  PumpLog log;
  for (const double t : {1000.00002, 1000.00004}) {
    log.t.push_back(t);
    for (auto* column : {&log.speed, &log.flow, &log.p_s, &log.p_c, &log.x_p}) column->push_back(1);
  }
  const std::string text = FormatPump(log);
  EXPECT_NE(text.find("1000.00002,"), std::string::npos);
  EXPECT_NE(text.find("1000.00004,"), std::string::npos);
}

TEST(Pump, IsTheSameForTheSameSeed) {
  PumpOptions o;
  o.seconds = 0.5;
  const std::string first = FormatPump(SimulatePump(o));
  EXPECT_EQ(first, FormatPump(SimulatePump(o)));
  o.seed = 2;
  EXPECT_NE(first, FormatPump(SimulatePump(o)));
}

TEST(Pump, RefusesWhatCannotBe) {
  PumpOptions o;
  o.seconds = 0;
  const Status status = Validate(o);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().text.find("seconds is 0"), std::string::npos);
}

}  // namespace
}  // namespace hydroscope
