#include "machines/die_cushion/balance.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/told_error.h"
#include "machines/die_cushion/columns.h"
#include "machines/die_cushion/generic_laws.h"
#include "machines/die_cushion/library.h"
#include "models/expressions/user_effect.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "models/smooth_rate.h"

namespace hydroscope {

namespace {

HYDROSCOPE_WIDE void PutLogarithms(Stretch& s) {
  const double *p = s[kPressureA], *y = s[kSpool];
  double *pressure = s[kLogPressure], *absolute = s[kLogAbsolute], *opening = s[kLogOpening];
  for (int k = 0; k < s.samples; ++k) pressure[k] = Log(std::max(p[k], 1.0));
  for (int k = 0; k < s.samples; ++k) absolute[k] = Log(std::max(p[k] * (1.0 / kAirPressure) + 1.0, 1.0));
  for (int k = 0; k < s.samples; ++k) opening[k] = Log(std::max(std::abs(y[k]), 1e-3));
}

constexpr double kRateHalfWidth = 0.02;  ///< s, of the windows of rates
/// sqrt(Pa), that of 0.9 bar: what the slope of the root is taken at, at least.
constexpr double kLeastRoot = 300.0;

/// Whether the open edge leads to the tank; without a reading of the supply pressure (NaN) it is taken to do so.
bool LeadsToTank(double spool, double supply, bool has_supply) {
  return (spool >= 0.0) | !has_supply | (supply != supply);
}

/// sign(dp) sqrt|dp|. The square root of a noisy pressure is low by var/(8 dp^2) on average; that is put back.
double NoiseCorrectedRoot(double dp, double variance) {
  const double magnitude = std::abs(dp);
  const double correction = 1.0 + variance / (8.0 * std::max(magnitude * magnitude, 25.0 * variance + 1e-30));
  return std::copysign(std::sqrt(magnitude) * correction, dp);
}

HYDROSCOPE_WIDE void FillFlowRoot(double tank_pressure, bool has_supply, Stretch& s) {
  const double *p = s[kPressureA], *y = s[kSpool], *supply = s[kSupplyPressure];
  double* const root = s[kFlowRoot];
  const double variance = WhiteNoiseVariance(p, s.samples);
  for (int k = -s.before; k < s.samples + s.after; ++k) {
    const double dp = LeadsToTank(y[k], supply[k], has_supply) ? p[k] - tank_pressure : supply[k] - p[k];
    root[k] = NoiseCorrectedRoot(dp, variance);
  }
}

void DeriveChannels(double tank_pressure, bool has_supply, Stretch& s) {
  FillFlowRoot(tank_pressure, has_supply, s);
  const int half = std::max(1, static_cast<int>(std::lround(kRateHalfWidth / s.period))),
            known = s.before + s.samples + s.after;
  const auto rate = [&](int of, Ends ends, int into) {
    SmoothRate(s[of] - s.before, known, half, s.period, ends, s[into] - s.before);
  };
  rate(kPosition, Ends::kExtend, kSpeed);
  rate(kSpeed, Ends::kHold, kAcceleration);
  // A regressor of the signal delays: smeared pressure steps would make them come out large, noise small.
  SharpRate(s[kPressureA] - s.before, known, half, s.period, s[kPressureRate] - s.before);
  for (int k = -s.before; k < s.samples + s.after; ++k) s[kTime][k] = s.begin + k * s.period;
  PutLogarithms(s);
}

std::vector<Column> BaseColumns(double area) {
  return {
      {"flow_area", IntegralOverTime<kFlowRoot, kSpool>([](double root, double y) { return root * y; }),
       true},
      {"dead_volume", ChangeOf<kPressureA>()},
      {"stroke_volume", IntegralOver(Of<kPosition>(), Of<kPressureA>())},
      {"flow_null", IntegralOverTime<kFlowRoot>(), true},
      {"piston_volume", ChangeOf<kPosition>([area](double z) { return area * z; })},
  };
}

/// Samples first, first + step, ... of `s`, as many as `copies` asks for and `count` times, one behind the other. Beyond the
/// end of `s` its last sample stands.
void CopySamples(const Stretch& s, int first, int step, int count, Stretch& copies) {
  const int samples = copies.samples;
  copies.samples = count * samples;
  copies.period = s.period * step;
  copies.channel.resize(s.channel.size());
  for (std::size_t c = 0; c < s.channel.size(); ++c) {
    const double* from = s[static_cast<int>(c)];
    std::vector<double>& to = copies.channel[c];
    to.resize(copies.samples);
    for (int k = 0; k < samples; ++k)
      for (int copy = 0; copy < count; ++copy)
        to[copy * samples + k] = from[std::min(first + k * step, s.samples - 1)];
  }
}

/// Noise of p_A, which every flow has in its root of the pressure drop, d(root)/dp = +-1 / (2 root), and that of the
/// spool, which moves for real under a controller that answers the noise of the pressure: only its white part is noise.
void DisturbSensors(bool has_supply, const Stretch& s, int first, int step, Stretch& copies) {
  constexpr int kCopies = 3;  // as measured, of the pressure, of the spool
  const int count = copies.samples;
  CopySamples(s, first, step, kCopies, copies);
  const double pressure = std::sqrt(WhiteNoiseVariance(s[kPressureA], s.samples));
  for (int k = count; k < 2 * count; ++k) {
    const double rise = 0.5 * pressure / std::max(std::abs(copies[kFlowRoot][k]), kLeastRoot);
    copies[kPressureA][k] += pressure;
    copies[kFlowRoot][k] +=
        LeadsToTank(copies[kSpool][k], copies[kSupplyPressure][k], has_supply) ? rise : -rise;
  }
  const double spool = std::sqrt(WhitePartVariance(s[kSpool], s.samples));
  for (int k = 2 * count; k < 3 * count; ++k) copies[kSpool][k] += spool;
  PutLogarithms(copies);
}

DerivedParameter Derived(const char* name, const char* unit, double value, Eigen::Vector4d gradient,
                         bool admissible, double geometry_std) {
  return {name, unit, value, gradient, admissible && std::isfinite(value), geometry_std};
}

/// Eq. 13-16 of the press paper with their gradients.
std::vector<DerivedParameter> Derive(double area, double area_std, double root_dp_nom,
                                     const Eigen::VectorXd& t) {
  const double bulk = -area / t[2], dead = area * t[1] / t[2];
  const double flow = -root_dp_nom * t[0], null = -t[3] / t[0];
  const double relative_area = area > 0 ? area_std / area : 0.0;
  return {
      Derived("K", "Pa", bulk, {0, 0, area / (t[2] * t[2]), 0}, bulk > 1e7 && bulk < 5e9, 0.0),
      Derived("V0", "m3", dead, {0, area / t[2], -area * t[1] / (t[2] * t[2]), 0}, dead > 0 && dead < 1.0,
              std::abs(dead) * relative_area),
      Derived("Q_vn", "m3/s", flow, {-root_dp_nom, 0, 0, 0}, flow > 0, std::abs(flow) * relative_area),
      Derived("y_0", "1", null, {t[3] / (t[0] * t[0]), 0, 0, -1 / t[0]}, std::abs(null) < 0.3, 0.0),
  };
}

/// Eq. 6-8 of the press paper. "theta_i(0) = 1, alpha = 500" makes sense at typical sizes only: opening 0.2, pressure
/// 100 bar, pressure rate 1000 bar/s, position 0.1 m, flow 60 l/min.
PublishedForm AsPublished(double area, double tank_pressure) {
  return {.channels = {kPressureA, kPosition, kSpool},
          .regressor_scale = {0.2 * 3162.0, 1e8, 1e7, 3162.0},
          .output_scale = 1e-3,
          .at = [=](std::span<const double> value, std::span<const double> rate, std::span<double> balance) {
            const double drop = value[0] - tank_pressure, p_rate = rate[0];
            const double root = std::copysign(std::sqrt(std::abs(drop)), drop);
            balance[0] = root * value[2];
            balance[1] = p_rate;
            balance[2] = value[1] * p_rate;
            balance[3] = root;
            balance[4] = area * rate[1];
          }};
}

}  // namespace

void FillLogarithms(Stretch& stretch) { PutLogarithms(stretch); }

Result<std::shared_ptr<ModelStructure>> BuildDieCushion(const Machine& machine) {
  const auto area = machine.Geometry("A_A");
  const auto dp_nom = machine.Geometry("dp_nom");
  if (!area || !dp_nom || area->value <= 0 || dp_nom->value <= 0)
    return BadInput(Tell(
        "machine '{}': model die_cushion needs geometry A_A (piston area) and dp_nom "
        "(nominal pressure drop of the valve), both > 0",
        "Maschine '{}': das Modell die_cushion braucht in [geometry] A_A (Kolbenfläche) und dp_nom (Nenndruckabfall "
        "des Ventils), beide > 0",
        machine.name));
  auto model = std::make_shared<ModelStructure>();
  model->parameters = {"theta1", "theta2", "theta3", "theta4"};
  model->base_count = 4;
  model->output_unit = "m3/s";
  model->channel_names.assign(kCushionChannels.begin(), kCushionChannels.end());
  for (int c = 0; c < kMeasuredChannels; ++c)
    model->channel_source.push_back(machine.SignalIndex(model->channel_names[c]));
  for (int c : {kPressureA, kPosition, kSpool}) {
    if (model->channel_source[c] < 0)
      return BadInput(Tell("machine '{}': model die_cushion needs signal {} in [signals]",
                           "Maschine '{}': das Modell die_cushion braucht das Signal {} in [signals]",
                           machine.name, model->channel_names[c]));
    model->needed_signals.push_back(model->channel_source[c]);
  }
  model->columns = BaseColumns(area->value);

  const CushionGeometry geometry = CushionGeometryOf(machine);
  const bool has_supply = model->channel_source[kSupplyPressure] >= 0;
  model->derive_channels = [tank = geometry.tank_pressure, has_supply](Stretch& s) {
    DeriveChannels(tank, has_supply, s);
  };
  model->disturb = [has_supply](const Stretch& s, int first, int step, Stretch& copies) {
    DisturbSensors(has_supply, s, first, step, copies);
  };
  model->derive = [a = area->value, a_std = area->std, root = std::sqrt(dp_nom->value)](
                      const Eigen::VectorXd& theta) { return Derive(a, a_std, root, theta); };
  const DisplayUnit spool = ShownUnit(machine, "y_v");  // as check and gate have it
  model->shown = {{kPressureA, "Pa"},     {kSpool, "1", std::string(spool.name), spool.factor},
                  {kPosition, "m"},       {kSpeed, "m/s"},
                  {kOilTemperature, "K"}, {kPressureRate, "Pa/s", "bar/s", 1e-5}};
  model->free_run =
      FreeRunChannel{kPressureA, "Pa", "pressure", {kSpeed, kAcceleration, kPressureRate, kTime}, 1e3, 1.0};
  model->published = AsPublished(area->value, geometry.tank_pressure);
  std::vector<std::shared_ptr<const Effect>> stored;
  for (auto& effect : DieCushionEffects(geometry))
    (effect->needs_samples ? model->sample_effects : stored).push_back(std::move(effect));
  AddLibrary(std::move(stored), *model);
  model->generic_laws = CushionLaws();
  if (!machine.added_effects.empty()) AddSampleEffects(*model, machine.added_effects);
  // Own effects are flows out of chamber A, as leaks are.
  TRY(AddUserEffects(machine, -1.0, *model));
  return model;
}

}  // namespace hydroscope
