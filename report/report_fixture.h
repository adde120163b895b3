#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "report/report.h"

namespace hydroscope {

/// A made-up record for the tests of the report: strokes of a press whose oil warms over consecutive logs, seen by an
/// estimator with exponential memory and in blocks by themselves. The truth of every parameter is known.
struct ReportFixture {
  int runs = 30, strokes_per_run = 10;
  double cold = 26, warm = 32;     ///< °C over the record
  bool cools_again = false;        ///< warm in the middle of the record, cold at both ends
  double flow_per_kelvin = 0.006;  ///< relative change of Q_vn per K
  double wear = 0;                 ///< relative loss of Q_vn from 60 % of the record on
  bool temperature_measured = true;
  std::uint64_t seed = 1;

  ReportInput Make() const;

  static constexpr double kBulkModulus = 1.41e9, kDeadVolume = 1.1e-3, kNominalFlow = 6.35e-4,
                          kSpoolZero = -0.0042;
  static constexpr double kStrokeTime = 1.3, kUsed = 1.1, kTimeConstant = 60;
};

namespace report_fixture {

/// An estimate that remembers: the filtered sum of independent stroke-wise estimates, its standard deviation `std`.
class Remembering {
 public:
  Remembering(std::string parameter, std::string unit, double std)
      : parameter_(std::move(parameter)), unit_(std::move(unit)), std_(std) {}

  Estimate Next(double truth, std::mt19937_64& random) {
    const double kept = std::exp(-ReportFixture::kUsed / ReportFixture::kTimeConstant);
    const double one = std_ * std::sqrt((1 + kept) / (1 - kept));
    std::normal_distribution<double> normal;
    value_ = started_ ? kept * value_ + (1 - kept) * Fresh(truth + one * normal(random))
                      : Fresh(truth + std_ * normal(random));
    started_ = true;
    Estimate estimate;
    estimate.parameter = parameter_;
    estimate.unit = unit_;
    estimate.value = value_;
    estimate.std = std_ * (1 + 2 * std::exp(-count_++ / 12.0));
    estimate.excitation = 0.4;
    estimate.reason = EstimateReason::kUpdated;
    return estimate;
  }

  /// What the strokes since the last call say by themselves.
  Estimate Block() {
    const double kept = std::exp(-ReportFixture::kUsed / ReportFixture::kTimeConstant);
    Estimate estimate;
    estimate.parameter = parameter_;
    estimate.value = fresh_ / fresh_count_;
    estimate.std = std_ * std::sqrt((1 + kept) / (1 - kept) / fresh_count_);
    estimate.reason = EstimateReason::kUpdated;
    fresh_ = fresh_count_ = 0;
    return estimate;
  }

 private:
  double Fresh(double value) {
    fresh_ += value;
    ++fresh_count_;
    return value;
  }

  std::string parameter_, unit_;
  double std_, value_ = 0;
  bool started_ = false;
  double count_ = 0, fresh_ = 0, fresh_count_ = 0;
};

inline StrokeOverlay Overlay(std::int64_t sequence, double floor, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  StrokeOverlay overlay;
  overlay.sequence = sequence;
  overlay.noise_floor = floor;
  for (int k = 0; k < 600; ++k) {
    const double t = k * 0.002, shape = std::sin(3.14159265 * k / 600.0);
    overlay.time.push_back(1000 + t);
    overlay.modelled.push_back(-6e-4 * shape * (1 + 0.12 * std::sin(40 * t) * std::exp(-3 * t)));
    overlay.measured.push_back(overlay.modelled.back() + floor * normal(random));
  }
  return overlay;
}

}  // namespace report_fixture

inline ReportInput ReportFixture::Make() const {
  using report_fixture::Remembering;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  ReportInput input;
  input.machine.name = "Die cushion, press 3";
  input.machine.estimator.time_constant = kTimeConstant;
  MonitorSpec stiffness{"K", 1.2e9, std::nullopt, 1.0e9, std::nullopt, 1.4e9};
  MonitorSpec flow{"Q_vn", 5.6e-4, 7.2e-4, 5.2e-4, 7.6e-4, std::nullopt};
  input.machine.monitors = {stiffness, flow};
  Remembering k("K", "Pa", 8e6), v0("V0", "m3", 7e-6), q("Q_vn", "m3/s", 7e-7), y0("y_0", "1", 1.5e-4);
  const int total = runs * strokes_per_run;
  const double floor = 0.31 / 6e4;
  const int block = std::max(3, total / 40);
  double block_oil = 0;
  for (int i = 0; i < total; ++i) {
    const int run = i / strokes_per_run;
    if (i % strokes_per_run == 0)
      input.runs.push_back(
          {run, "logs/run_" + std::to_string(run + 1) + ".csv", "", strokes_per_run, i, true, ""});
    const double progress = total > 1 ? static_cast<double>(i) / (total - 1) : 0;
    const double rise = cools_again ? 1 - std::abs(2 * progress - 1) : progress;
    const double oil = cold + (warm - cold) * rise + 0.05 * normal(random);
    const bool worn = progress > 0.6;
    StrokeSummary stroke;
    stroke.index = i;
    stroke.begin = 4.0 * (i % strokes_per_run);
    stroke.end = stroke.begin + kStrokeTime;
    stroke.oil_temperature = temperature_measured ? oil + 273.15 : std::nan("");
    stroke.rms_error = floor * (worn ? 1 + 8 * wear : 1.05) * (1 + 0.08 * std::abs(normal(random)));
    stroke.noise_floor = floor;
    stroke.counters.samples = 650;
    stroke.counters.gated = 590;
    stroke.counters.used = static_cast<std::int64_t>(650 * kUsed / kStrokeTime);
    stroke.counters.flagged[2] = i % 7 == 0 ? 1 : 0;
    input.strokes.push_back(stroke);
    const double flow_truth = kNominalFlow * (1 + flow_per_kelvin * (oil - cold)) * (1 - (worn ? wear : 0));
    for (const Estimate& estimate : {k.Next(kBulkModulus, random), v0.Next(kDeadVolume, random),
                                     q.Next(flow_truth, random), y0.Next(kSpoolZero, random)})
      input.trends.push_back({run, i % strokes_per_run, i, stroke.end, stroke.oil_temperature, estimate});
    block_oil += stroke.oil_temperature / block;
    if ((i + 1) % block != 0) continue;
    input.blocks.push_back({i + 1 - block, i + 1, block_oil, {k.Block(), v0.Block(), q.Block(), y0.Block()}});
    block_oil = 0;
  }
  input.rows = 60000LL * runs;
  if (total > 0) input.overlays.push_back(report_fixture::Overlay(total / 2, floor, random));
  input.skipped = {{"values flagged spike, p_A", 43, "a single reading far off both neighbours"},
                   {"rows outside the gate", 1411000, "the model describes the drawing stroke only"}};
  return input;
}

}  // namespace hydroscope
