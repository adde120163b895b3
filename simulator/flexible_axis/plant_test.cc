#include <gtest/gtest.h>

#include <cmath>

#include "simulator/flexible_axis/log.h"

namespace hydroscope {
namespace {

FlexibleAxisLog Quiet(AxisManoeuvre manoeuvre, const FlexibleAxisFaults& faults = {}, int rows = 2000) {
  FlexibleAxisOptions o;
  o.manoeuvre = manoeuvre;
  o.faults = faults;
  o.rows = rows;
  o.sensors = {.position = 0, .acceleration = 0, .pressure = 0};
  return SimulateFlexibleAxis(o);
}

TEST(FlexibleAxis, MovesAsFastAsTheFlowThroughTheValveFillsIt) {
  const FlexibleAxisLog log = Quiet(AxisManoeuvre::kStep);
  const FlexibleAxisMachine m;
  const FlexibleAxisState& s = log.truth.back();
  const double flow = m.flow_gain * std::sqrt(m.supply_pressure - s.p_1) -
                      m.external_leakage_1 * (s.p_1 - m.tank_pressure) + m.internal_leakage * (s.p_2 - s.p_1);
  EXPECT_NEAR(s.v_p, flow / m.piston_area, 0.02 * s.v_p);
  EXPECT_NEAR(s.v_l, s.v_p, 0.02 * s.v_p) << "the load follows";
  EXPECT_NEAR(s.p_1 * m.piston_area - s.p_2 * m.ring_area, m.coulomb_friction + m.viscous_friction * s.v_p,
              10)
      << "sliding, pressures carry the friction alone";
}

TEST(FlexibleAxis, RunsTheOtherWayWithTheOtherSign) {
  const FlexibleAxisLog log = Quiet(AxisManoeuvre::kNegativeStep);
  EXPECT_LT(log.truth.back().x_p, log.truth.front().x_p - 0.02);
}

TEST(FlexibleAxis, StaysWithinItsStroke) {
  const FlexibleAxisLog log = Quiet(AxisManoeuvre::kLargeStep, {}, 4113);
  for (const FlexibleAxisState& s : log.truth) {
    EXPECT_GT(s.x_p, 0);
    EXPECT_LT(s.x_p, 1);
  }
}

TEST(FlexibleAxis, FollowsItsControllerAtAllTimes) {
  const FlexibleAxisLog log = Quiet(AxisManoeuvre::kClosedLoop, {}, 4113);
  EXPECT_NEAR(log.truth[2000].x_p, 0.4 + 0.1 * std::sin(3 * 1.9), 0.05);
}

TEST(FlexibleAxis, EveryFaultShowsInTheLog) {
  const FlexibleAxisLog healthy = Quiet(AxisManoeuvre::kStaircase);
  const AxisSensors noise;
  for (const FlexibleAxisFault& fault : AllFlexibleAxisFaults()) {
    FlexibleAxisFaults faults;
    faults.*fault.size = fault.typical;
    const FlexibleAxisLog log = Quiet(AxisManoeuvre::kStaircase, faults);
    double energy = 0;
    for (std::size_t i = 0; i < log.t.size(); ++i)
      energy += std::pow((log.x_p[i] - healthy.x_p[i]) / noise.position, 2) +
                std::pow((log.x_l[i] - healthy.x_l[i]) / noise.position, 2) +
                std::pow((log.a_p[i] - healthy.a_p[i]) / noise.acceleration, 2) +
                std::pow((log.p_1[i] - healthy.p_1[i]) / noise.pressure, 2);
    EXPECT_GT(energy / static_cast<double>(log.t.size()), 1) << fault.id;
  }
}

TEST(FlexibleAxis, IsTheSameForTheSameSeed) {
  FlexibleAxisOptions o;
  o.rows = 50;
  EXPECT_EQ(FormatFlexibleAxis(SimulateFlexibleAxis(o)), FormatFlexibleAxis(SimulateFlexibleAxis(o)));
  const std::string first = FormatFlexibleAxis(SimulateFlexibleAxis(o));
  o.seed = 2;
  EXPECT_NE(first, FormatFlexibleAxis(SimulateFlexibleAxis(o)));
}

TEST(FlexibleAxis, RefusesWhatCannotBe) {
  FlexibleAxisOptions o;
  o.rows = 1;
  const Status status = Validate(o);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().text.find("rows is 1"), std::string::npos);
}

}  // namespace
}  // namespace hydroscope
