#include "diagnosis/remainder/residuals.h"

#include <algorithm>
#include <cmath>

#include "core/units.h"
#include "diagnosis/sample_grams.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

std::vector<ResidualSignal> SignalsOf(const ModelStructure& model) {
  std::vector<ResidualSignal> out;
  for (const ModelStructure::ShownChannel& shown : model.shown) {
    const auto channel = static_cast<std::size_t>(shown.channel);
    if (channel < model.channel_source.size() && model.channel_source[channel] == -1) continue;
    const DisplayUnit usual = DisplayUnitFor(shown.unit);
    const DisplayUnit unit = shown.display.empty() ? usual : DisplayUnit{shown.factor, 0, shown.display};
    out.push_back(
        {model.channel_names[channel], shown.channel, unit.factor, unit.offset, std::string(unit.name)});
  }
  out.push_back({"phase", -1, 100, 0, "%"});
  return out;
}

/// What sensor noise does to the residual of one span.
struct SpanNoise {
  double white = 0;  ///< variance of a block mean
  double walk = 0;   ///< variance a random walk gains per block
};

SpanNoise NoiseOf(const SpanEquations& span, const Eigen::VectorXd& residual_weights) {
  const int blocks = span.blocks;
  const Eigen::VectorXd white = span.noise.leftCols(blocks).transpose() * residual_weights;
  const Eigen::VectorXd walk = span.walk.transpose() * residual_weights;
  SpanNoise out;
  // The columns carry the energies that centring leaves: B - 1 variances of white noise, and (B^2 - 1) / 6 of a walk.
  out.white = white.squaredNorm() / span.equations;
  out.walk = blocks > 1 ? walk.squaredNorm() * 6.0 / (blocks * blocks - 1.0) : 0.0;
  return out;
}

/// Covariance of Helmert contrasts of `blocks` block means: white noise plus random walk. Block means of a
/// walk have covariance q (min(a, b) + 1/2 - (a == b) / 6), in blocks.
Eigen::MatrixXd ContrastCovariance(int blocks, const SpanNoise& noise) {
  Eigen::MatrixXd level(blocks, blocks);
  for (int a = 0; a < blocks; ++a)
    for (int b = 0; b < blocks; ++b)
      level(a, b) =
          noise.walk * (std::min(a, b) + 0.5 - (a == b ? 1.0 / 6.0 : 0.0)) + (a == b ? noise.white : 0.0);
  Eigen::MatrixXd contrast = Eigen::MatrixXd::Zero(blocks - 1, blocks);
  for (int j = 1; j < blocks; ++j) {
    const double scale = std::sqrt(j / (j + 1.0));
    contrast(j - 1, j) = scale;
    contrast.row(j - 1).head(j).setConstant(-scale / j);
  }
  return contrast * level * contrast.transpose();
}

class ResidualBuilder {
 public:
  ResidualBuilder(std::shared_ptr<const ModelStructure> model, const WindowSamples& window,
                  const Eigen::VectorXd& weights, const std::vector<ResidualSignal>& signals)
      : model_(model), window_(window), builder_(model, window), weights_(weights), signals_(signals) {
    residual_weights_ = -weights;
    residual_weights_[model->output_column()] += 1.0;
  }

  StrokeResiduals Build(const StrokeStretches& stroke);

 private:
  void AddSignals(const Stretch& stretch, int blocks);
  void AddFlows(const SpanEquations& span);

  std::shared_ptr<const ModelStructure> model_;
  WindowSamples window_;
  SpanEquationBuilder builder_;
  Eigen::VectorXd weights_, residual_weights_;
  const std::vector<ResidualSignal>& signals_;
  std::vector<std::vector<double>> block_mean_;  ///< [block of the segment][signal]
  double done_ = 0, total_ = 1;                  ///< samples of the stroke
  StrokeResiduals out_;
  std::vector<std::vector<double>> window_signal_;
};

StrokeResiduals ResidualBuilder::Build(const StrokeStretches& stroke) {
  out_ = {};
  window_signal_.clear();
  done_ = total_ = 0;
  for (const Stretch& stretch : stroke) total_ += stretch.samples;
  std::vector<std::pair<std::size_t, SpanNoise>> noise;  // windows up to here have this noise
  double white = 0, walk = 0, equations = 0;
  std::vector<Eigen::VectorXd> contrasts;
  std::vector<int> blocks;
  Stretch work;
  for (const Stretch& kept : stroke) {
    const Stretch& stretch = Derived(*model_, kept, work);
    const SpanEquations& span = builder_.BuildDerived(stretch, 0.0);
    if (!stretch.continues) block_mean_.clear();
    AddSignals(stretch, span.blocks);
    AddFlows(span);
    const SpanNoise here = NoiseOf(span, residual_weights_);
    noise.emplace_back(out_.measured.size(), here);
    white += here.white * span.blocks;
    walk += here.walk * span.blocks;
    equations += span.blocks;
    contrasts.emplace_back(span.integral.leftCols(span.equations).transpose() * residual_weights_);
    blocks.push_back(span.blocks);
    done_ += stretch.samples;
  }
  if (equations > 0) {
    const SpanNoise mean{white / equations, walk / equations};
    for (std::size_t k = 0; k < contrasts.size(); ++k) {
      if (window_.level_form) {
        if (mean.white > 0) out_.whitened.emplace_back(contrasts[k] / std::sqrt(mean.white));
        continue;
      }
      const PositiveFactor factor(ContrastCovariance(blocks[k], mean));
      if (factor.sound()) out_.whitened.emplace_back(factor.SolveLower(contrasts[k]));
    }
  }
  for (const auto& [end, span_noise] : noise)
    out_.noise_variance.resize(end, window_.FlowNoiseVariance(span_noise.white, span_noise.walk));
  out_.signal.resize(static_cast<int>(signals_.size()), out_.windows());
  for (int w = 0; w < out_.windows(); ++w)
    for (std::size_t s = 0; s < signals_.size(); ++s)
      out_.signal(static_cast<int>(s), w) = window_signal_[w][s];
  return std::move(out_);
}

void ResidualBuilder::AddSignals(const Stretch& stretch, int blocks) {
  const int lead = stretch.continues ? 1 : 0, m = window_.block;
  for (int b = 0; b < blocks; ++b) {
    std::vector<double> mean;
    const int first = lead + b * m;
    for (const ResidualSignal& signal : signals_) {
      if (signal.channel < 0) {
        mean.push_back((done_ + first + 0.5 * m) / total_);
        continue;
      }
      double sum = 0;
      for (int k = 0; k < m; ++k) sum += stretch[signal.channel][first + k];
      mean.push_back(sum / m);
    }
    block_mean_.push_back(std::move(mean));
  }
}

void ResidualBuilder::AddFlows(const SpanEquations& span) {
  const int windows = static_cast<int>(span.flow_time.size());
  const std::size_t width = 2 * static_cast<std::size_t>(window_.half_window);
  for (int w = 0; w < windows; ++w) {
    out_.measured.push_back(span.flow(model_->output_column(), w));
    out_.modelled.push_back(weights_.dot(span.flow.col(w)));
    // The last window ends with the last block, each one before it a block earlier.
    const std::size_t end = block_mean_.size() - static_cast<std::size_t>(windows - 1 - w);
    std::vector<double> mean(signals_.size(), 0.0);
    for (std::size_t b = end - width; b < end; ++b)
      for (std::size_t s = 0; s < mean.size(); ++s) mean[s] += block_mean_[b][s] / static_cast<double>(width);
    window_signal_.push_back(std::move(mean));
  }
}

bool Moves(const std::vector<StrokeResiduals>& strokes, int signal) {
  double low = INFINITY, high = -INFINITY;
  for (const StrokeResiduals& stroke : strokes) {
    if (stroke.windows() == 0) continue;
    if (!stroke.signal.row(signal).allFinite()) return false;
    low = std::min(low, stroke.signal.row(signal).minCoeff());
    high = std::max(high, stroke.signal.row(signal).maxCoeff());
  }
  return high > low;
}

void KeepRows(Residuals& residuals, const std::vector<int>& rows) {
  std::vector<ResidualSignal> signals;
  for (int row : rows) signals.push_back(residuals.signals[row]);
  for (StrokeResiduals& stroke : residuals.strokes) stroke.signal = stroke.signal(rows, Eigen::all).eval();
  residuals.signals = std::move(signals);
}

}  // namespace

Eigen::VectorXd ColumnWeights(const ModelStructure& model, const ExtendedFit& fit) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(model.column_count());
  weights.head(model.base_count) = fit.theta.head(model.base_count);
  for (const EffectEstimate& effect : fit.effects) {
    const EffectShape& shape = model.effect_shapes[effect.choice.effect][effect.choice.shape];
    const std::vector<double> share = shape.weights({fit.theta.head(model.base_count), effect.size});
    for (std::size_t j = 0; j < share.size(); ++j) weights[shape.columns[j]] += share[j] * effect.size;
  }
  return weights;
}

Eigen::VectorXd ErrorWeights(const ModelStructure& model, const ExtendedFit& fit) {
  Eigen::VectorXd error = -ColumnWeights(model, fit);
  error[model.output_column()] += 1;
  return error;
}

namespace {

/// A model and its weights with the columns alone that count: others cost nothing, and a bad signal in them does no harm.
struct Counting {
  std::shared_ptr<const ModelStructure> model;
  Eigen::VectorXd weights;
};

Counting ColumnsThatCount(const ModelStructure& model, const Eigen::VectorXd& weights) {
  const auto out = std::make_shared<ModelStructure>(BaseOnly(model));
  Eigen::VectorXd kept = weights.head(model.output_column() + 1);
  for (int c = model.output_column() + 1; c < model.column_count(); ++c) {
    if (weights[c] == 0.0) continue;
    out->columns.push_back(model.columns[c]);
    kept.conservativeResize(kept.size() + 1);
    kept[kept.size() - 1] = weights[c];
  }
  return {out, kept};
}

bool IsFinite(const StrokeResiduals& stroke) {
  return std::all_of(stroke.modelled.begin(), stroke.modelled.end(),
                     [](double q) { return std::isfinite(q); });
}

}  // namespace

Residuals ResidualsOf(std::shared_ptr<const ModelStructure> model, std::span<const StrokeStretches> strokes,
                      const WindowSamples& window, const Eigen::VectorXd& weights) {
  Residuals out;
  out.signals = SignalsOf(*model);
  const Counting counting = ColumnsThatCount(*model, weights);
  ResidualBuilder builder(counting.model, window, counting.weights, out.signals);
  for (const StrokeStretches& stroke : strokes) {
    StrokeResiduals residuals = builder.Build(stroke);
    if (!IsFinite(residuals))
      residuals = StrokeResiduals{{}, {}, {}, Eigen::MatrixXd(out.signals.size(), 0), {}};
    out.strokes.push_back(std::move(residuals));
  }
  std::vector<int> moving;
  for (int s = 0; s < static_cast<int>(out.signals.size()); ++s)
    if (Moves(out.strokes, s)) moving.push_back(s);
  KeepRows(out, moving);
  return out;
}

void ScaleNoise(double noise_floor, Residuals& residuals) {
  double sum = 0, windows = 0;
  for (const StrokeResiduals& stroke : residuals.strokes)
    for (const double variance : stroke.noise_variance) {
      sum += variance;
      windows += 1;
    }
  if (!(sum > 0)) return;
  const double factor = noise_floor * noise_floor * windows / sum;
  for (StrokeResiduals& stroke : residuals.strokes) {
    for (double& variance : stroke.noise_variance) variance *= factor;
    for (Eigen::VectorXd& contrasts : stroke.whitened) contrasts /= std::sqrt(factor);
  }
}

}  // namespace hydroscope
