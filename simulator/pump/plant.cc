#include "simulator/pump/plant.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulator/random.h"

namespace hydroscope {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Root of a pressure difference in its sign, linear within a tenth of a bar of 0.
double PressureRoot(double difference) {
  constexpr double kLaminarPa = 1e4;
  return difference / std::pow(difference * difference + kLaminarPa * kLaminarPa, 0.25);
}

/// Opening of a metering edge with a rounded corner.
double RoundedOpening(double x, double rounding) {
  return 0.5 * (x + std::sqrt(x * x + rounding * rounding));
}

}  // namespace

const std::vector<PumpFault>& AllPumpFaults() {
  using F = PumpFaults;
  static const std::vector<PumpFault> all = {
      {"leakage_grown", &F::leakage_grown, 2e-8, "m3/(s sqrt(Pa))",
       "a scored gap between control chamber and case"},
      {"sticking_spool", &F::sticking_spool, 8, "N", "dry friction of the compensator spool"},
      {"weak_spring", &F::weak_spring, 0.3, "1",
       "share of the compensator spring lost beyond 0.1 mm: a cracked coil"},
      {"suction_air", &F::suction_air, 0.03, "1", "share of each stroke that is air"},
      {"swash_bearing", &F::swash_bearing, 120, "N",
       "dry friction of the swash bearing at the control piston"},
      {"outlet_leakage", &F::outlet_leakage, 2e-12, "m3/(s Pa)", "leak of the line to the outside"},
  };
  return all;
}

PistonRipple::PistonRipple(int pistons, std::uint64_t seed) {
  constexpr double kUnlike = 0.01;  // pistons differ by
  // Of a piston's volume, at 200 bar: dead volume and stroke over the bulk modulus.
  constexpr double kBackflow = 0.02;
  constexpr double kOpens = 0.1;  // rad of the shaft over which the flow back rises
  constexpr double kOver = 20;    // times that, when it is over
  constexpr int kAngles = 7200;
  RandomStream random(StreamSeed(seed, "pistons"));
  const double pitch = kTurn / pistons;
  at_.assign(kAngles + 1, 0.0);
  for (int i = 0; i < pistons; ++i) {
    const double size = 1 + kUnlike * random.Normal(),
                 backflow = kBackflow * (1 + 5 * kUnlike * random.Normal());
    for (int k = 0; k <= kAngles; ++k) {
      const double a = std::fmod(kTurn * k / kAngles + pitch * i, kTurn), since = a / kOpens;
      double& flow = at_[static_cast<std::size_t>(k)];
      flow += 0.5 * pitch * size * std::max(std::sin(a), 0.0);
      if (since < kOver) flow -= backflow * pitch / kOpens * since * std::exp(-since);
    }
  }
  double mean = 0;
  for (int k = 0; k < kAngles; ++k) mean += at_[static_cast<std::size_t>(k)] / kAngles;
  for (double& flow : at_) flow -= mean;
}

double PistonRipple::At(double angle) const {
  const double turns = angle / kTurn,
               place = (turns - std::floor(turns)) * static_cast<double>(at_.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(place), at_.size() - 2);
  return at_[k] + (place - static_cast<double>(k)) * (at_[k + 1] - at_[k]);
}

double PumpPlant::LoadFlow(const PumpDrive& d, double outlet_pressure) const {
  return d.conductance * PressureRoot(outlet_pressure - m_.tank_pressure);
}

double PumpPlant::Ripple(const PumpDrive& d, const PumpState& s) const {
  const double delivered = d.speed * m_.displacement * (1 - s.x_p / m_.piston_stroke);
  return line_impedance_ * std::max(delivered, 0.0) * ripple_.At(s.angle);
}

/// `ripple`: Pa, at the compensator.
PumpPlant::Rates PumpPlant::RatesAt(const PumpState& s, const PumpDrive& d, double ripple) const {
  const double gain = m_.flow_gain / std::sqrt(m_.gain_drop);
  const double in = gain * RoundedOpening(s.x_v, m_.edge_rounding) * PressureRoot(s.p_s - s.p_c),
               out = gain * RoundedOpening(-s.x_v, m_.edge_rounding) * PressureRoot(s.p_c - m_.tank_pressure);
  const double leak = m_.leakage * d.wear * s.p_c + f_.leakage_grown * PressureRoot(s.p_c);
  const double delivered = d.speed * m_.displacement * (1 - s.x_p / m_.piston_stroke) * (1 - f_.suction_air);
  const double outlet =
      delivered - in - m_.spool_area * s.v_v - LoadFlow(d, s.p_s) - f_.outlet_leakage * s.p_s;
  const double chamber = m_.chamber_volume + m_.piston_area * s.x_p;
  const double spring = m_.spring * (s.x_v - f_.weak_spring * std::max(s.x_v - kCrackOpens, 0.0));
  return {m_.modulus / chamber * (in - out - leak - m_.piston_area * s.v_p),
          m_.modulus / m_.line_volume * outlet,
          s.v_p,
          (m_.piston_area * s.p_c - m_.piston_spring * s.x_p - m_.piston_damping * s.v_p -
           f_.swash_bearing * std::tanh(s.v_p / m_.dry_speed)) /
              m_.piston_mass,
          s.v_v,
          (m_.spool_area * (s.p_s + ripple) - spring - d.preload - m_.spool_damping * s.v_v -
           f_.sticking_spool * std::tanh(s.v_v / m_.dry_speed)) /
              m_.spool_mass};
}

void PumpPlant::Stop(PumpState& s) const {
  const auto hold = [](double& x, double& v, double low, double high) {
    if (x < low) v = std::max(v, 0.0);
    if (x > high) v = std::min(v, 0.0);
    x = std::clamp(x, low, high);
  };
  hold(s.x_p, s.v_p, 0, m_.piston_stroke);
  hold(s.x_v, s.v_v, -m_.spool_stroke, m_.spool_stroke);
  s.p_c = std::max(s.p_c, 0.0);
  s.p_s = std::max(s.p_s, 0.0);
}

void PumpPlant::Step(const PumpDrive& d, double seconds, PumpState& s) const {
  const auto moved = [&](const Rates& r, double t) {
    PumpState to{s.p_c + t * r[0], s.p_s + t * r[1], s.x_p + t * r[2],     s.v_p + t * r[3],
                 s.x_v + t * r[4], s.v_v + t * r[5], s.angle + t * d.speed};
    return to;
  };
  const auto ripple_after = [&](double t) {
    PumpState at = s;
    at.angle += t * d.speed;
    return line_impedance_ > 0 ? Ripple(d, at) : 0.0;
  };
  const double begin = ripple_after(0), middle = ripple_after(seconds / 2), end = ripple_after(seconds);
  const Rates a = RatesAt(s, d, begin), b = RatesAt(moved(a, seconds / 2), d, middle),
              c = RatesAt(moved(b, seconds / 2), d, middle), e = RatesAt(moved(c, seconds), d, end);
  Rates mean;
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = (a[i] + 2 * b[i] + 2 * c[i] + e[i]) / 6;
  s = moved(mean, seconds);
  Stop(s);
}

PumpState PumpPlant::Rest(const PumpDrive& d) const {
  constexpr double kSettles = 1.0, kStep = 5e-5;  // s
  const PumpPlant quiet(m_, f_, 0, 0);
  PumpState s;
  s.p_s = d.preload / m_.spool_area;
  s.x_p = 0.5 * m_.piston_stroke;
  s.p_c = m_.piston_spring * s.x_p / m_.piston_area;
  for (int k = 0; k * kStep < kSettles; ++k) quiet.Step(d, kStep, s);
  s.angle = 0;
  return s;
}

}  // namespace hydroscope
