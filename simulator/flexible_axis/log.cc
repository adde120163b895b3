#include "simulator/flexible_axis/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "simulator/random.h"
#include "simulator/ranges.h"

namespace hydroscope {
namespace {

constexpr double kBegin = 0.1;  // s at rest before a manoeuvre

/// Levels of the staircase, V, one after the other.
constexpr double kStairs[] = {0.2, -0.2, 0.4, -0.4, 0.8, -0.8, 1.6, -1.6, 4, -4};
constexpr double kStair = 0.4;  // s

/// Command of a manoeuvre, V.
class AxisCommand {
 public:
  AxisCommand(const FlexibleAxisOptions& options)
      : manoeuvre_(options.manoeuvre), random_(StreamSeed(options.seed, "command")) {}

  double At(double t, double measured_position) {
    const double since = t - kBegin;
    if (since < 0) return 0;
    switch (manoeuvre_) {
      case AxisManoeuvre::kStep:
        return 1;
      case AxisManoeuvre::kNegativeStep:
        return -1;
      case AxisManoeuvre::kLargeStep:
        return 8;
      case AxisManoeuvre::kRamp:
        return -1 + since;
      case AxisManoeuvre::kNoisySine:
        return 2 * std::sin(2 * std::numbers::pi * since) + 0.3 * random_.Normal();
      case AxisManoeuvre::kStaircase: {
        const auto stair = static_cast<std::size_t>(since / kStair);
        return stair < std::size(kStairs) ? kStairs[stair] : 0;
      }
      case AxisManoeuvre::kClosedLoop: {
        constexpr double kGain = 20;  // V/m
        const double target = kBeginPosition + 0.1 * std::sin(3 * since) + (since > 2 ? 0.05 : 0.0);
        return std::clamp(kGain * (target - measured_position), -10.0, 10.0);
      }
    }
    return 0;
  }

  static constexpr double kBeginPosition = 0.4;  // m

 private:
  AxisManoeuvre manoeuvre_;
  RandomStream random_;
};

double BeginOf(AxisManoeuvre manoeuvre) {
  switch (manoeuvre) {
    case AxisManoeuvre::kNegativeStep:
      return 0.8;
    case AxisManoeuvre::kLargeStep:
      return 0.1;
    default:
      return AxisCommand::kBeginPosition;
  }
}

/// One sensor: low-pass, noise, converter.
class AxisSensor {
 public:
  AxisSensor(const AxisSensors& s, double noise, double range, double period, std::uint64_t seed)
      : noise_(noise),
        step_(s.bits > 0 ? range / std::exp2(s.bits) : 0),
        follows_(s.filter > 0 ? 1 - std::exp(-2 * std::numbers::pi * s.filter * period) : 1),
        memory_(s.coloured),
        random_(seed) {}

  double Read(double value) {
    filtered_ = begun_ ? filtered_ + follows_ * (value - filtered_) : value;
    begun_ = true;
    kept_ = memory_ * kept_ + std::sqrt(1 - memory_ * memory_) * random_.Normal();
    const double reading = filtered_ + noise_ * kept_;
    return step_ > 0 ? step_ * std::round(reading / step_) : reading;
  }

 private:
  double noise_, step_, follows_, memory_;
  double filtered_ = 0, kept_ = 0;
  bool begun_ = false;
  RandomStream random_;
};

}  // namespace

const std::vector<AxisManoeuvreInfo>& AllAxisManoeuvres() {
  static const std::vector<AxisManoeuvreInfo> all = {
      {"step", AxisManoeuvre::kStep, "+1 V"},
      {"negative-step", AxisManoeuvre::kNegativeStep, "-1 V"},
      {"large-step", AxisManoeuvre::kLargeStep, "8 V"},
      {"ramp", AxisManoeuvre::kRamp, "from -1 V on by 1 V/s"},
      {"noisy-sine", AxisManoeuvre::kNoisySine, "2 V at 1 Hz with 0.3 V of noise"},
      {"staircase", AxisManoeuvre::kStaircase, "0.2 V to 4 V to both sides, 0.4 s each"},
      {"closed-loop", AxisManoeuvre::kClosedLoop, "P-controller, 20 V/m, on a sine and a step"}};
  return all;
}

Status Validate(const FlexibleAxisOptions& o) {
  return CheckRanges({{"rows", static_cast<double>(o.rows), 2, 1e6},
                      {"period", o.period, 1e-5, 0.01},
                      {"filter", o.sensors.filter, 0, 1e4},
                      {"bits", static_cast<double>(o.sensors.bits), 0, 24},
                      {"coloured", o.sensors.coloured, 0, 0.999},
                      {"spring_loss", o.faults.spring_loss, 0, 0.95},
                      {"supply_drop", o.faults.supply_drop, 0, 10e6},
                      {"free_air", o.faults.free_air, 0, 0.5}});
}

FlexibleAxisMachine RandomFlexibleAxis(std::uint64_t seed) {
  RandomStream random(StreamSeed(seed, "flexible axis"));
  const auto times = [&](double& size) { size *= std::exp2(random.Uniform(-1, 1)); };
  FlexibleAxisMachine m;
  for (double* size :
       {&m.damper, &m.spool_time, &m.flow_gain, &m.internal_leakage, &m.external_leakage_1,
        &m.external_leakage_2, &m.modulus_factor, &m.modulus_rise, &m.modulus_shift, &m.bristle_damping,
        &m.viscous_friction, &m.coulomb_friction, &m.static_friction, &m.stribeck_speed})
    times(*size);
  m.bristle_stiffness = std::pow(10, random.Uniform(5, 7));
  return m;
}

std::vector<NamedSize> TrueParameters(const FlexibleAxisMachine& m) {
  constexpr double kNominalVolts = 10, kNominalPressure = 35e5;
  return {{"Q_n", m.flow_gain * kNominalVolts * std::sqrt(kNominalPressure)},
          {"tau", m.spool_time},
          {"b", m.damper},
          {"L_i", m.internal_leakage},
          {"L_e1", m.external_leakage_1},
          {"L_e2", m.external_leakage_2},
          {"beta_2", m.BulkModulus(2e6)},
          {"beta_5", m.BulkModulus(5e6)},
          {"beta_10", m.BulkModulus(10e6)},
          {"sigma_0", m.bristle_stiffness},
          {"sigma_1", m.bristle_damping},
          {"k_v", m.viscous_friction},
          {"F_c", m.coulomb_friction},
          {"F_s", m.static_friction - m.coulomb_friction},
          {"v_s", m.stribeck_speed}};
}

std::vector<NamedSize> NoiseOf(const AxisSensors& s) {
  return {{"position", s.position}, {"acceleration", s.acceleration}, {"pressure", s.pressure}};
}

FlexibleAxisLog SimulateFlexibleAxis(const FlexibleAxisOptions& o) {
  constexpr double kSwitch = 0.05;  // m from either end
  const FlexibleAxisPlant plant(o.machine, o.faults);
  FlexibleAxisState s = plant.Rest(BeginOf(o.manoeuvre));
  AxisCommand command(o);
  const auto sensor = [&](const char* name, double noise, double range) {
    return AxisSensor(o.sensors, noise, range, o.period, StreamSeed(o.seed, name));
  };
  AxisSensor x_p = sensor("x_p", o.sensors.position, 1.2), x_l = sensor("x_l", o.sensors.position, 1.2),
             a_p = sensor("a_p", o.sensors.acceleration, 200), p_1 = sensor("p_1", o.sensors.pressure, 25e6),
             p_2 = sensor("p_2", o.sensors.pressure, 25e6);
  FlexibleAxisLog log;
  for (int row = 0; row < o.rows; ++row) {
    const double t = row * o.period;
    log.t.push_back(t);
    log.truth.push_back(s);
    log.x_p.push_back(x_p.Read(s.x_p));
    log.x_l.push_back(x_l.Read(s.x_l + o.faults.load_position_zero));
    log.a_p.push_back(a_p.Read(plant.Acceleration(s) + o.faults.acceleration_zero));
    log.p_1.push_back(p_1.Read(s.p_1 + o.faults.pressure_1_zero));
    log.p_2.push_back(p_2.Read(s.p_2));
    double u = command.At(t, log.x_p.back());
    if ((s.x_p > o.machine.stroke - kSwitch && u > 0) || (s.x_p < kSwitch && u < 0)) u = 0;
    log.U.push_back(u);
    plant.Advance(u, o.period, s);
  }
  return log;
}

std::string FormatFlexibleAxis(const FlexibleAxisLog& log) {
  std::string text = "t,U,x_p,x_l,a_p,p_1,p_2\n";
  for (std::size_t i = 0; i < log.t.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.6g},{:.6g},{:.8g},{:.8g},{:.6g},{:.8g},{:.8g}\n", log.t[i],
                   log.U[i], log.x_p[i], log.x_l[i], log.a_p[i], log.p_1[i], log.p_2[i]);
  return text;
}

}  // namespace hydroscope
