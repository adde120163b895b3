#include "simulator/pump/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "simulator/random.h"
#include "simulator/ranges.h"

namespace hydroscope {
namespace {

constexpr double kLargestFlow = 1.45e-3, kSmallestFlow = 0.25e-3;  // m^3/s at the set pressure and 390 rad/s
constexpr double kUsualSpeed = 390;                                // rad/s

/// Load and speed over time. The load's valve follows its command with a lag of first order.
class PumpLoad {
 public:
  explicit PumpLoad(const PumpOptions& o)
      : o_(o), random_(StreamSeed(o.seed, "load")), set_pressure_(o.machine.preload / o.machine.spool_area) {
    const auto phase = [&] { return random_.Uniform(0, 2 * std::numbers::pi); };
    phases_ = {phase(), phase()};
    level_ = LevelAt(0);
    drive_ = {SpeedAt(0), level_, o.machine.preload, 1};
  }
  const PumpDrive& drive() const { return drive_; }
  void Advance(double t, double seconds) {
    constexpr double kValve = 4e-3;  // s
    level_ = LevelAt(t);
    drive_.conductance += (1 - std::exp(-seconds / kValve)) * (level_ - drive_.conductance);
    drive_.speed = SpeedAt(t);
    drive_.wear = 1 + o_.wear * std::max(t - o_.wear_from, 0.0);
  }

 private:
  double SpeedAt(double t) const {
    const double wander = 0.6 * std::sin(2 * std::numbers::pi * 0.21 * t + phases_[0]) +
                          0.4 * std::sin(2 * std::numbers::pi * 0.47 * t + phases_[1]);
    return o_.speed * (1 - o_.speed_swing * (0.5 + 0.5 * wander));
  }
  double Conductance(double flow) const {
    return flow * o_.speed / kUsualSpeed / std::sqrt(set_pressure_ - o_.machine.tank_pressure);
  }
  double LevelAt(double t) {
    switch (o_.manoeuvre) {
      case PumpManoeuvre::kStep:
        return Conductance(t < 0.2 * o_.seconds ? kLargestFlow : kSmallestFlow);
      case PumpManoeuvre::kPulse:
        return Conductance(std::fmod(t, kPulsePeriod) > kPulseBegins &&
                                   std::fmod(t, kPulsePeriod) < kPulseEnds
                               ? kLargestFlow
                               : 0.5e-3);
      case PumpManoeuvre::kLevels:
        break;
    }
    constexpr double kShortest = 0.08, kLongest = 0.5;  // s
    if (t >= next_) {
      next_ = t + random_.Uniform(kShortest, kLongest);
      held_ = Conductance(random_.Uniform(kSmallestFlow, kLargestFlow));
    }
    return held_;
  }

  static constexpr double kPulsePeriod = 4, kPulseBegins = 1, kPulseEnds = 2.5;  // s
  const PumpOptions& o_;
  RandomStream random_;
  double set_pressure_, level_ = 0, next_ = 0, held_ = 0;
  std::array<double, 2> phases_{};
  PumpDrive drive_;
};

/// Mean over a row of what a sensor sees, with noise.
class PumpSensor {
 public:
  PumpSensor(double noise, std::uint64_t seed) : noise_(noise), random_(seed) {}
  void See(double value) {
    sum_ += value;
    ++count_;
  }
  double Read() {
    const double reading = sum_ / std::max(count_, 1) + noise_ * random_.Normal();
    sum_ = 0;
    count_ = 0;
    return reading;
  }

 private:
  double noise_, sum_ = 0;
  int count_ = 0;
  RandomStream random_;
};

}  // namespace

const std::vector<PumpManoeuvreInfo>& AllPumpManoeuvres() {
  static const std::vector<PumpManoeuvreInfo> all = {
      {"levels", PumpManoeuvre::kLevels, "load flow at random levels, 0.08 to 0.5 s each"},
      {"step", PumpManoeuvre::kStep, "from full flow down, once"},
      {"pulse", PumpManoeuvre::kPulse, "a pulse of full flow, 1.5 s, every 4 s"}};
  return all;
}

Status Validate(const PumpOptions& o) {
  return CheckRanges({{"seconds", o.seconds, 0.5, 3600},
                      {"wear", o.wear, 0, 10},
                      {"wear_from", o.wear_from, 0, 3600},
                      {"period", o.period, 2e-5, 2e-3},
                      {"speed", o.speed, 50, 1000},
                      {"speed_swing", o.speed_swing, 0, 0.6},
                      {"ripple", o.ripple, 0, 10},
                      {"flow_lag", o.sensors.flow_lag, 0, 0.1},
                      {"preload", o.machine.preload, 100, 2500},
                      {"weak_spring", o.faults.weak_spring, 0, 0.9},
                      {"suction_air", o.faults.suction_air, 0, 0.5}});
}

PumpOptions RandomPump(std::uint64_t seed) {
  constexpr double kReach = 0.3;  // octaves
  RandomStream random(StreamSeed(seed, "pump"));
  PumpOptions o;
  PumpMachine& m = o.machine;
  for (double* size : {&m.spring, &m.flow_gain, &m.leakage, &m.piston_spring, &m.line_volume})
    *size *= std::exp2(random.Uniform(-kReach, kReach));
  m.preload *= random.Uniform(0.96, 1.04);
  o.sensors.flow_lag = random.Uniform(2e-3, 20e-3);
  o.speed = random.Uniform(300, 420);
  o.seed = seed;
  return o;
}

std::vector<PumpSize> TrueParameters(const PumpOptions& o) {
  const PumpMachine& m = o.machine;
  return {{"K_v", m.spring},      {"K_q", m.flow_gain}, {"C_l", m.leakage},         {"K_p", m.piston_spring},
          {"V_t", m.line_volume}, {"F_0", m.preload},   {"T_q", o.sensors.flow_lag}};
}

PumpLog SimulatePump(const PumpOptions& o) {
  constexpr double kLongest = 5e-5;  // s; the spool's fastest motion needs six times that
  const PumpPlant plant(o.machine, o.faults, o.ripple, o.seed);
  PumpLoad load(o);
  PumpState s = plant.Rest(load.drive());
  const auto seed = [&](const char* name) { return StreamSeed(o.seed, name); };
  PumpSensor speed(o.sensors.speed, seed("speed")), flow(o.sensors.flow, seed("flow")),
      p_s(o.sensors.pressure, seed("p_s")), p_c(o.sensors.pressure, seed("p_c")),
      x_p(o.sensors.position, seed("x_p")), pistons(0, 0);
  double seen_flow = plant.LoadFlow(load.drive(), s.p_s);
  const int steps = std::max(1, static_cast<int>(std::ceil(o.period / kLongest)));
  const double h = o.period / steps;
  const auto follows = o.sensors.flow_lag > 0 ? 1 - std::exp(-h / o.sensors.flow_lag) : 1.0;
  const auto rows = static_cast<int>(std::lround(o.seconds / o.period));
  PumpLog log;
  for (int row = 0; row < rows; ++row) {
    const double t = row * o.period;
    for (int k = 0; k < steps; ++k) {
      load.Advance(t + k * h, h);
      const double ripple = plant.Ripple(load.drive(), s), before = plant.LoadFlow(load.drive(), s.p_s);
      speed.See(load.drive().speed);
      p_s.See(s.p_s + ripple);
      p_c.See(s.p_c);
      x_p.See(s.x_p);
      pistons.See(ripple);
      plant.Step(load.drive(), h, s);
      flow.See(seen_flow);
      seen_flow += follows * (0.5 * (before + plant.LoadFlow(load.drive(), s.p_s)) - seen_flow);
    }
    log.t.push_back(t);
    log.truth.push_back(s);
    log.speed.push_back(speed.Read());
    log.flow.push_back(flow.Read());
    log.p_s.push_back(p_s.Read());
    log.p_c.push_back(p_c.Read());
    log.x_p.push_back(x_p.Read());
    log.ripple.push_back(pistons.Read());
  }
  return log;
}

double PumpLog::RippleRms() const {
  double energy = 0;
  for (const double r : ripple) energy += r * r;
  return std::sqrt(energy / static_cast<double>(std::max<std::size_t>(1, ripple.size())));
}

std::string FormatPump(const PumpLog& log) {
  std::string text = "t,n,Q,p_s,p_c,x_p\n";
  for (std::size_t i = 0; i < log.t.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.10g},{:.6g},{:.6g},{:.7g},{:.7g},{:.6g}\n", log.t[i],
                   log.speed[i], log.flow[i], log.p_s[i], log.p_c[i], log.x_p[i]);
  return text;
}

}  // namespace hydroscope
