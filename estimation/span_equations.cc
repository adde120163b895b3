#include "estimation/span_equations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel/wide.h"

namespace hydroscope {
namespace {

constexpr int kFewestRows = 4;  // of a block: fewer do not part sensor noise from motion

/// Blocks per sample of ModelStructure::disturb, whose noise changes with opening and pressure only.
constexpr int kWalkStep = 5;

/// Mean level and sign contrast (times `share`) of each block, `stride` apart; returns the level after the
/// last block. Only the level waits for the block before.
HYDROSCOPE_WIDE double SumBlocks(const double* increments, const std::vector<BlockWeights>& weights,
                                 int blocks, double level, double share, double* mean, double* contrast,
                                 std::ptrdiff_t stride) {
  const BlockWeights *const first = weights.data(), *const end = first + weights.size();
  for (int b = 0; b < blocks; ++b) {
    BlockWeights::Lanes sum{};
#pragma GCC unroll 5
    for (const BlockWeights* weight = first; weight != end; ++weight) sum += *increments++ * weight->lanes;
    mean[b * stride] = level + sum[0];
    contrast[b * stride] = share * sum[1];
    level += sum[2];
  }
  return level;
}

/// `scale` times the difference of a block to the mean of those before; the mean then takes its `share` of it.
HYDROSCOPE_WIDE void AddContrast(std::ptrdiff_t rows, const double* block, double scale, double share,
                                 double* __restrict mean, double* __restrict contrast) {
  for (std::ptrdiff_t i = 0; i < rows; ++i) {
    const double difference = block[i] - mean[i];
    contrast[i] = scale * difference;
    mean[i] += share * difference;
  }
}

/// Sum of `count` neighbouring columns of `rows` numbers each.
HYDROSCOPE_WIDE void SumColumns(std::ptrdiff_t rows, int count, const double* columns,
                                double* __restrict sum) {
  std::copy_n(columns, rows, sum);
  for (int c = 1; c < count; ++c)
    for (std::ptrdiff_t i = 0; i < rows; ++i) sum[i] += columns[c * rows + i];
}

HYDROSCOPE_WIDE void ScaledDifference(std::ptrdiff_t rows, double scale, const double* after,
                                      const double* before, double* __restrict out) {
  for (std::ptrdiff_t i = 0; i < rows; ++i) out[i] = scale * (after[i] - before[i]);
}

}  // namespace

WindowSamples WindowSamples::From(const WindowSpec& spec, double period) {
  WindowSamples w;
  w.period = period;
  w.block = std::max(kFewestRows, static_cast<int>(std::lround(spec.block / period)));
  const double block = w.block * period;
  w.span = std::max(w.min_span, static_cast<int>(std::lround(spec.span / block)));
  w.half_window = std::max(1, static_cast<int>(std::lround(spec.half_width / block)));
  return w;
}

std::vector<Told> WindowSamples::Clamps(const WindowSpec& spec, double period) {
  const WindowSamples taken = From(spec, period);
  const double block = taken.block * period;
  std::vector<Told> said;
  const auto say = [&](const char* key, double asked, double used, const Told& why) {
    constexpr double kRounded = 1.5;  // to whole rows or blocks: half of one more than asked is no news
    if (used > kRounded * asked)
      said.push_back(
          Tell("rows are far apart: {} = {:.4g} s of [window] is taken as {:.4g} s, since {}",
               "Die Zeilen liegen weit auseinander: {} = {:.4g} s aus [window] gilt als {:.4g} s, denn {}",
               key, asked, used, why));
  };
  say("block", spec.block, block,
      {"a block holds at least four rows", "ein Block hat mindestens vier Zeilen"});
  say("span", spec.span, taken.span * block,
      {"a span holds at least five blocks", "eine Spanne hat mindestens fünf Blöcke"});
  say("half_width", spec.half_width, taken.half_window * block,
      {"it holds at least one block", "sie hat mindestens einen Block"});
  return said;
}

double WindowSamples::FlowVarianceGain() const {
  const double h = half_window, block_time = block * period;
  return level_form ? 1.0 / (2 * h) : 2.0 / (h * h * h * block_time * block_time);
}

double WindowSamples::FlowNoiseVariance(double white, double walk) const {
  const double block_time = block * period;
  return white * FlowVarianceGain() + 2.0 / 3.0 * walk / (half_window * block_time * block_time);
}

/// For the samples x_k of a block above its first one, x_k = sum of the increments before k: mean of x_k; sum
/// of x_k with alternating signs (+ - - +), scaled to keep white noise white; rise to the first sample of the next block.
std::vector<BlockWeights> WeightsOfIncrements(int block) {
  const double contrast = ContrastScale(block);
  std::vector<BlockWeights> weights(block);
  int signs = 0;
  for (int k = block - 1; k >= 0; --k) {
    weights[k].lanes = BlockWeights::Lanes{static_cast<double>(block - 1 - k) / block, signs * contrast, 1.0};
    signs += ContrastSign(k, block);
  }
  return weights;
}

std::vector<BlockWeights> WeightsOfValues(int block) {
  std::vector<BlockWeights> weights(block);
  for (int k = 0; k < block; ++k)
    weights[k].lanes = BlockWeights::Lanes{1.0 / block, ContrastSign(k, block) * ContrastScale(block)};
  return weights;
}

SpanEquationBuilder::SpanEquationBuilder(std::shared_ptr<const ModelStructure> model, WindowSamples window,
                                         int first)
    : model_(std::move(model)),
      columns_(std::span(model_->columns).subspan(static_cast<std::size_t>(first))),
      window_(window),
      weights_(WeightsOfIncrements(window.block)) {
  const auto columns = static_cast<Eigen::Index>(columns_.size());
  walks_ = std::any_of(columns_.begin(), columns_.end(), [](const Column& c) { return c.walks; });
  increments_.resize(static_cast<std::size_t>(window_.span) * window_.block + 1);
  column_state_.assign(columns_.size(), 0.0);
  last_level_.assign(columns_.size(), 0.0);
  level_.resize(columns, window_.span + 2 * window_.half_window);
  out_.integral.resize(columns, window_.span);
  out_.noise = Eigen::MatrixXd::Zero(columns, window_.span);
  out_.walk.resize(columns, 0);
  out_.flow.resize(columns, window_.span);
  out_.flow_time.reserve(window_.span);
}

const SpanEquations& SpanEquationBuilder::Build(Stretch& stretch, double begin) {
  model_->derive_channels(stretch);
  return BuildDerived(stretch, begin);
}

const SpanEquations& SpanEquationBuilder::BuildDerived(const Stretch& stretch, double begin) {
  const int blocks = (stretch.samples - (stretch.continues ? 1 : 0)) / window_.block;
  if (!stretch.continues) history_ = 0;
  if (window_.level_form) {
    FillValues(stretch, blocks);
  } else {
    FillLevels(stretch, blocks);
    FillContrasts(blocks);
    FillWalk(stretch, blocks);
  }
  FillFlows(blocks, stretch.continues, begin);
  out_.equations = window_.level_form ? blocks : blocks - 1;
  out_.blocks = blocks;
  out_.begin = begin;
  return out_;
}

void SpanEquationBuilder::FillLevels(const Stretch& stretch, int blocks) {
  const int lead = stretch.continues ? 1 : 0;
  const double share = std::sqrt((blocks - 1.0) / blocks);  // the intercept takes one of the blocks
  const std::span<double> increments(increments_.data(), stretch.samples - 1);
  increments_[stretch.samples - 1] = 0.0;  // whole blocks leave no increment for the last sample
  for (Eigen::Index c = 0; c < level_.rows(); ++c) {
    columns_[c].fill(stretch, column_state_[c], increments);
    const double level = stretch.continues ? last_level_[c] + increments[0] : 0.0;
    last_level_[c] = SumBlocks(increments_.data() + lead, weights_, blocks, level, share,
                               &level_(c, history_), &out_.noise(c, 0), level_.rows());
  }
}

void SpanEquationBuilder::FillValues(const Stretch& stretch, int blocks) {
  const int m = window_.block, lead = stretch.continues ? 1 : 0;
  const double contrast = ContrastScale(m);
  const std::span<double> values(increments_.data(), stretch.samples);
  for (Eigen::Index c = 0; c < level_.rows(); ++c) {
    columns_[c].fill(stretch, column_state_[c], values);
    for (int b = 0; b < blocks; ++b) {
      const double* x = values.data() + lead + b * m;
      double sum = 0, signs = 0;
      for (int k = 0; k < m; ++k) {
        sum += x[k];
        signs += ContrastSign(k, m) * x[k];
      }
      level_(c, history_ + b) = out_.integral(c, b) = sum / m;
      out_.noise(c, b) = signs * contrast;
    }
  }
}

void SpanEquationBuilder::FillContrasts(int blocks) {
  // Helmert contrasts: block j against the mean of those before it, scaled to keep white noise white.
  mean_ = level_.col(history_);
  for (int j = 1; j < blocks; ++j)
    AddContrast(level_.rows(), &level_(0, history_ + j), std::sqrt(j / (j + 1.0)), 1.0 / (j + 1.0),
                mean_.data(), &out_.integral(0, j - 1));
}

void SpanEquationBuilder::FillWalk(const Stretch& stretch, int blocks) {
  if (model_->disturb && !walks_) {
    out_.walk.resize(level_.rows(), 0);
    return;
  }
  const int between = model_->disturb ? kWalkStep : 1;
  const int first = (stretch.continues ? 1 : 0) + window_.block / 2, step = between * window_.block;
  const int rates = (blocks + between - 1) / between;
  // A step after x of B blocks has the centred energy x (B - x) / B; steps all along the span sum to (B^2 -
  // 1) / 6.
  weights_of_walk_.resize(rates);
  for (int k = 0; k < rates; ++k) {
    const double x = std::min(0.5 + (k + 0.5) * between, blocks - 0.5);
    weights_of_walk_[k] = x * (blocks - x);
  }
  if (model_->disturb) {
    FillDisturbedRates(stretch, first, step, out_.walk);
  } else {
    // That of base columns and output alone, of which all are there or none.
    out_.walk.setZero(level_.rows(), rates);
    if (level_.rows() == model_->column_count()) model_->integrated_noise(stretch, first, step, out_.walk);
  }
  const double energy = window_.block * (blocks * blocks - 1.0) / 6.0 / weights_of_walk_.sum();
  for (Eigen::Index k = 0; k < out_.walk.cols(); ++k)
    out_.walk.col(k) *= std::sqrt(weights_of_walk_[k % rates] * energy) * stretch.period;
}

void SpanEquationBuilder::FillDisturbedRates(const Stretch& stretch, int first, int step,
                                             Eigen::MatrixXd& rate_noise) {
  // One sample more than rates, since a rate lies between two.
  const int rates = static_cast<int>(weights_of_walk_.size()), samples = rates + 1;
  copies_.samples = samples;
  copies_.continues = copies_.scattered = true;
  model_->disturb(stretch, first, step, copies_);
  const int sources = copies_.samples / samples - 1;
  rate_noise.setZero(level_.rows(), static_cast<Eigen::Index>(sources) * rates);
  const double* plain = increments_.data();
  for (Eigen::Index c = 0; c < level_.rows(); ++c) {
    if (!columns_[c].walks) continue;
    double state = column_state_[c];
    columns_[c].fill(copies_, state, std::span(increments_.data(), copies_.samples - 1));
    for (int source = 0; source < sources; ++source) {
      const double* disturbed = plain + (source + 1) * samples;
      for (int k = 0; k < rates; ++k)
        rate_noise(c, source * rates + k) = (disturbed[k] - plain[k]) / copies_.period;
    }
  }
}

void SpanEquationBuilder::FillFlows(int blocks, bool continues, double begin) {
  const int h = window_.half_window, total = history_ + blocks;
  const double block_time = window_.block * window_.period;
  const double scale = 1.0 / (h * h * block_time);
  out_.flow_time.clear();
  int windows = 0;
  const auto rows = level_.rows();
  before_.resize(rows);
  after_.resize(rows);
  for (int last = continues ? std::max(history_, 2 * h - 1) : 2 * h - 1; last < total; ++last, ++windows) {
    if (window_.level_form) {
      SumColumns(rows, 2 * h, &level_(0, last - 2 * h + 1), after_.data());
      out_.flow.col(windows) = after_ * (1.0 / (2 * h));
    } else {
      SumColumns(rows, h, &level_(0, last - h + 1), after_.data());
      SumColumns(rows, h, &level_(0, last - 2 * h + 1), before_.data());
      ScaledDifference(rows, scale, after_.data(), before_.data(), &out_.flow(0, windows));
    }
    out_.flow_time.push_back(begin + (last - history_ - h + 1) * block_time);
  }
  const int keep = std::min(total, 2 * h - 1);
  for (int k = 0; k < keep; ++k) level_.col(k) = level_.col(total - keep + k).eval();
  history_ = keep;
}

}  // namespace hydroscope
