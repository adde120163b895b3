#include "diagnosis/free_run.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

constexpr int kNewtonSteps = 4;

/// The balance over one sample as a function of the channel's value at its end.
class SampleBalance {
 public:
  SampleBalance(const ModelStructure& model, const Eigen::VectorXd& weights)
      : model_(model), run_(*model.free_run) {
    for (int c = 0; c < model.column_count(); ++c) {
      const double weight = c == model.output_column() ? -1.0 : weights[c];
      if (weight != 0.0) terms_.push_back({c, weight, 0.0});
    }
    pair_.samples = 2;
    pair_.channel.assign(model.channel_names.size(), std::vector<double>(2));
  }

  /// States of hysteresis and the like at the beginning of a stroke.
  void Reset() {
    for (Term& term : terms_) term.state = 0;
  }

  /// Value at sample k + 1 if it was `value` at sample k.
  double Step(const Stretch& measured, int k, double value) {
    Load(measured, k);
    pair_.channel[run_.channel][0] = value;
    double next = value + measured[run_.channel][k + 1] - measured[run_.channel][k];
    for (int step = 0; step < kNewtonSteps; ++step) {
      const double error = Error(measured, k, next);
      const double slope = (Error(measured, k, next + run_.step) - error) / run_.step;
      if (slope == 0.0 || !std::isfinite(error / slope)) break;
      next -= error / slope;
      if (std::abs(error / slope) < run_.closed) break;
    }
    Evaluate(measured, k, next, true);
    return next;
  }

 private:
  struct Term {
    int column;
    double weight, state;
  };

  void Load(const Stretch& measured, int k) {
    pair_.period = measured.period;
    for (std::size_t c = 0; c < pair_.channel.size(); ++c)
      for (int i = 0; i < 2; ++i) pair_.channel[c][i] = measured[static_cast<int>(c)][k + i];
  }

  double Error(const Stretch& measured, int k, double next) { return Evaluate(measured, k, next, false); }

  double Evaluate(const Stretch& measured, int k, double next, bool keep) {
    pair_.channel[run_.channel][1] = next;
    model_.derive_channels(pair_);
    for (const int channel : run_.as_measured)
      for (int i = 0; i < 2; ++i) pair_.channel[channel][i] = measured[channel][k + i];
    double sum = 0;
    for (Term& term : terms_) {
      double state = term.state, increment = 0;
      model_.columns[term.column].fill(pair_, state, {&increment, 1});
      if (keep) term.state = state;
      sum += term.weight * increment;
    }
    return sum;
  }

  const ModelStructure& model_;
  const FreeRunChannel& run_;
  std::vector<Term> terms_;
  Stretch pair_;
};

FreeRunStroke RunStroke(const ModelStructure& model, const StrokeStretches& stretches, int block,
                        SampleBalance& balance) {
  FreeRunStroke out;
  const int channel = model.free_run->channel;
  balance.Reset();
  double value = 0, squares = 0;
  for (const Stretch& original : stretches) {
    Stretch measured = original;
    model.derive_channels(measured);
    std::vector<double> simulated(static_cast<std::size_t>(measured.samples));
    if (!measured.continues || out.measured.empty()) value = measured[channel][0];
    simulated[0] = value;
    for (int k = 0; k + 1 < measured.samples; ++k)
      simulated[static_cast<std::size_t>(k) + 1] = value = balance.Step(measured, k, value);
    for (int first = measured.continues ? 1 : 0; first + block <= measured.samples; first += block) {
      double seen = 0, run = 0;
      for (int k = first; k < first + block; ++k) {
        seen += measured[channel][k];
        run += simulated[static_cast<std::size_t>(k)];
      }
      out.measured.push_back(seen / block);
      out.simulated.push_back(run / block);
      squares += std::pow(out.measured.back() - out.simulated.back(), 2);
    }
  }
  out.rms = out.measured.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(out.measured.size()));
  return out;
}

}  // namespace

std::optional<std::vector<FreeRunStroke>> FreeRun(const ModelStructure& model,
                                                  std::span<const StrokeStretches> strokes,
                                                  const WindowSamples& window,
                                                  const Eigen::VectorXd& weights) {
  if (!model.free_run) return std::nullopt;
  SampleBalance balance(model, weights);
  std::vector<FreeRunStroke> out;
  for (const StrokeStretches& stroke : strokes)
    out.push_back(RunStroke(model, stroke, window.block, balance));
  return out;
}

}  // namespace hydroscope
