#include "diagnosis/experiment/machine_moves.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/quantile.h"
#include "machines/die_cushion/balance.h"
#include "models/smooth_rate.h"

namespace hydroscope {
namespace {

/// Median over the stretches of what a channel reads at their beginning; `none` where it is not measured.
double Typical(std::span<const StrokeStretches> strokes, int channel, double none) {
  std::vector<double> values;
  for (const StrokeStretches& stroke : strokes)
    for (const Stretch& stretch : stroke)
      if (!stretch.channel[channel].empty() && stretch[channel][0] != 0)
        values.push_back(stretch[channel][0]);
  return Median(std::move(values), none);
}

/// Median over the stretches of the standard deviation of a channel's white noise.
double NoiseOf(std::span<const StrokeStretches> strokes, int channel) {
  std::vector<double> variances;
  for (const StrokeStretches& stroke : strokes)
    for (const Stretch& stretch : stroke)
      variances.push_back(WhiteNoiseVariance(stretch[channel], stretch.samples));
  return std::sqrt(Median(std::move(variances), 0));
}

}  // namespace

MachineMoves MovesOf(const Machine& machine, std::span<const StrokeStretches> strokes) {
  std::vector<double> speeds, pressures;
  double top = 0, bottom = std::numeric_limits<double>::infinity();
  for (const StrokeStretches& stroke : strokes)
    for (const Stretch& stretch : stroke) {
      const double *z = stretch[kPosition], *p = stretch[kPressureA];
      speeds.push_back((z[0] - z[stretch.samples - 1]) / ((stretch.samples - 1) * stretch.period));
      pressures.insert(pressures.end(), p, p + stretch.samples);
      top = std::max(top, z[0]);
      bottom = std::min(bottom, z[stretch.samples - 1]);
    }
  MachineMoves moves;
  const ExperimentSpec& spec = machine.experiment;
  moves.speed_min = spec.speed_min.value_or(std::max(1e-3, Quantile(speeds, 0.05, 0)));
  moves.speed_max = std::max(moves.speed_min, spec.speed_max.value_or(Quantile(speeds, 0.95, 0)));
  moves.pressure_min = spec.pressure_min.value_or(std::max(5e5, Quantile(pressures, 0.05, 0)));
  moves.pressure_max = std::max(moves.pressure_min, spec.pressure_max.value_or(Quantile(pressures, 0.95, 0)));
  moves.rod = Typical(strokes, kPressureB, moves.rod);
  moves.supply = Typical(strokes, kSupplyPressure, moves.supply);
  moves.oil = Typical(strokes, kOilTemperature, moves.oil);
  moves.p_noise = NoiseOf(strokes, kPressureA);
  moves.z_noise = NoiseOf(strokes, kPosition);
  moves.y_noise = NoiseOf(strokes, kSpool);
  moves.rod_min = spec.rod_pressure_min.value_or(moves.rod);
  moves.rod_max = std::max(moves.rod_min, spec.rod_pressure_max.value_or(moves.rod));
  moves.stroke = std::max(0.01, top - bottom);
  moves.warm_up = spec.warm_up;
  moves.max_strokes = spec.max_strokes;
  for (const GateBound& bound : machine.gate.bounds)
    if (bound.signal == "y_v" && !bound.rate && bound.min)
      moves.min_opening = std::max(moves.min_opening, *bound.min);
  return moves;
}

}  // namespace hydroscope
