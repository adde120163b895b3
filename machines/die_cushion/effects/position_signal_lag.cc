#include "machines/die_cushion/effects/effects.h"
#include "machines/die_cushion/effects/low_passed_signal.h"
#include "machines/die_cushion/effects/shifted_signal.h"
#include "models/wide_stretch.h"

namespace hydroscope::effects {
namespace {

/// Effect::Twin::share: a late position needs rates of everything else, whose noise costs the delay up to a quarter of its
/// gain (`hydroscope benchmark plant-logs`).
constexpr double kPositionShare = 0.7;
/// Effect::Twin::excess: the right one of the two leaves up to 0.019 of the noise energy more than the other (`hydroscope benchmark
/// late-signals --cases 96`, seeds 771 and 5).
constexpr double kPositionExcess = 0.05;

}  // namespace

/// The position reading follows the position as a first-order lag tau. Its balance then holds for what the
/// same lag makes of the other side: flow and compression behind the lag in place of flow and compression.
/// (lagged x - x) / tau, integrated, is minus lagged x.
Effect PositionSignalLag(const CushionGeometry&) {
  Effect e = FirstOrderLag();
  e.id = "position_signal_lag";
  e.title = "Position signal lags (first-order filter)";
  e.law = "z = z_measured + tau dz_measured/dt";
  e.source = "eq. 1 of the press paper with the signal filtered";
  e.family = {"the position is recorded late", "die Position wird verspätet aufgezeichnet"};
  e.confused_with = {"position_signal_delay", "spool_signal_delay", "pressure_signal_delay"};
  e.twins = {{"position_signal_delay", kPositionShare, kDelayGains, kPositionExcess}};
  e.hidden_in = "V0, K";
  e.plain =
      "The position is smoothed before it is recorded; look for: a filter in the "
      "encoder interface or in the controller.";
  e.german = {
      "Wegsignal hinkt nach (Filter erster Ordnung)",
      "Der Weg wird geglättet, bevor er aufgezeichnet wird; zu suchen: ein Filter in der Schnittstelle "
      "des Gebers oder in der Steuerung.",
      "die Filtereinstellung des Wegeingangs, oder ein Anfahren des Stößels, mit einem zweiten Sensor aufgezeichnet"};
  e.told_apart_by = "the filter setting of the position input, or a ram start recorded with a second sensor";
  e.measured_by = {
      "the time constant of the filter in the position input, as set there or from a step recorded at rest",
      "die Zeitkonstante des Filters im Wegeingang, wie dort eingestellt oder aus einem in Ruhe aufgezeichneten Sprung"};
  e.variant = [](const std::vector<double>& nonlinear) {
    const double lag = nonlinear[0];
    const auto minus_lagged = [lag](const Stretch& s, auto signal, std::span<double> out) {
      LowPassedDifferences(
          s, lag, [=](int k) { return -signal(k); }, out);
    };
    const auto flow = [=](const Stretch& s, double&, std::span<double> out) {
      const double *root = s[kFlowRoot], *y = s[kSpool];
      minus_lagged(
          s, [=](int k) { return root[k] * y[k]; }, out);
    };
    const auto dead_volume = [=](const Stretch& s, double&, std::span<double> out) {
      const double* rate = s[kPressureRate];
      minus_lagged(
          s, [=](int k) { return rate[k]; }, out);
    };
    const auto stroke_volume = [=](const Stretch& s, double&, std::span<double> out) {
      const double *rate = s[kPressureRate], *z = s[kPosition];
      minus_lagged(
          s, [=](int k) { return rate[k]; }, out);
      for (int k = 0; k + 1 < s.samples; ++k) out[static_cast<std::size_t>(k)] *= 0.5 * (z[k] + z[k + 1]);
    };
    const auto null = [=](const Stretch& s, double&, std::span<double> out) {
      const double* root = s[kFlowRoot];
      minus_lagged(
          s, [=](int k) { return root[k]; }, out);
    };
    return EffectVariant{{flow, dead_volume, stroke_volume, null}, BaseWeights};
  };
  // A lag is a delay to first order; whole samples keep the noise of levels white.
  e.correct = [](double lag, double&, Stretch& s) {
    ShiftChannels(
        s, {kPressureA, kSpool, kPressureB, kSupplyPressure, kOilTemperature, kFlowRoot, kPressureRate},
        -lag);
    FillLogarithms(s);
  };
  e.grid = {{0.006}};
  return e;
}

}  // namespace hydroscope::effects
