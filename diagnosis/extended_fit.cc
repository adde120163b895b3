#include "diagnosis/extended_fit.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "core/contains.h"
#include "core/non_negative.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

constexpr int kRelinearisations = 6;
/// Relative, from one linearisation to the next: far inside any interval.
constexpr double kParametersSettled = 1e-4;
constexpr std::size_t kLeastStrokes = 4;  ///< fewer, and an effect cannot be judged on strokes left out
constexpr double kConsistent = 0.25;      ///< relative difference of two values of a law's one parameter

/// W' G W with the columns of W sparse; the last column is the output.
Eigen::MatrixXd Congruence(const SymmetricMatrix& gram, const SparseColumns& columns) {
  const int size = static_cast<int>(columns.size());
  Eigen::MatrixXd out(size, size);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i <= j; ++i) {
      double sum = 0;
      for (const auto& [a, wa] : columns[i])
        for (const auto& [b, wb] : columns[j]) sum += wa * wb * gram(a, b);
      out(i, j) = out(j, i) = sum;
    }
  return out;
}

/// Of the sum of independent values that are alike, by their scatter; NaN are left out.
double StandardErrorOfSum(const Eigen::VectorXd& values) {
  double count = 0, sum = 0, squares = 0;
  for (const double x : values) {
    if (!std::isfinite(x)) continue;
    count += 1;
    sum += x;
    squares += x * x;
  }
  return count > 1 ? std::sqrt(NonNegative(count / (count - 1) * (squares - sum * sum / count))) : 0.0;
}

double Energy(const Eigen::MatrixXd& augmented, const Eigen::VectorXd& theta) {
  const int n = static_cast<int>(theta.size());
  return theta.dot(augmented.topLeftCorner(n, n) * theta) - 2 * theta.dot(augmented.col(n).head(n)) +
         augmented(n, n);
}

NormalEquations AsEquations(const Eigen::MatrixXd& augmented, double count) {
  const int n = static_cast<int>(augmented.rows()) - 1;
  return {augmented.topLeftCorner(n, n), augmented.col(n).head(n), augmented(n, n), count};
}

/// The effect whose size is entry `i` of theta, and whether physics and its own law allow that size.
EffectEstimate SizeOf(const ModelStructure& model, const EffectChoice& choice, const Eigen::VectorXd& theta,
                      int i) {
  const Effect& effect = *model.effects[choice.effect];
  EffectEstimate estimate;
  estimate.choice = choice;
  estimate.size = theta[i];
  estimate.admissible = estimate.size >= effect.min && estimate.size <= effect.max;
  if (!effect.implied) return estimate;
  const double stated = model.effect_shapes[choice.effect][choice.shape].nonlinear[0];
  const double implied = effect.implied({theta.head(model.base_count), estimate.size});
  estimate.consistent =
      std::abs(implied - stated) <= kConsistent * std::max(std::abs(implied), std::abs(stated));
  return estimate;
}

/// Sizes of output, model and difference in the flow form, of `windows` whose augmented products sum to `flow`.
void JudgeFlows(const Eigen::MatrixXd& flow, double windows, ExtendedFit& fit) {
  if (windows <= 0) return;
  const auto n = fit.theta.size();
  fit.rms_measured = std::sqrt(flow(n, n) / windows);
  fit.rms_modelled = std::sqrt(NonNegative(fit.theta.dot(flow.topLeftCorner(n, n) * fit.theta) / windows));
  fit.rms_residual = std::sqrt(NonNegative(Energy(flow, fit.theta) / windows));
}

}  // namespace

std::vector<int> ShapesFor(const ModelStructure& model, int effect, std::span<const EffectChoice> others) {
  const auto& shapes = model.effect_shapes[effect];
  const auto in_others = [&](const Correction& on) {
    return std::any_of(others.begin(), others.end(), [&](const EffectChoice& other) {
      return other.effect == on.effect &&
             model.effect_shapes[other.effect][other.shape].nonlinear.front() == on.value;
    });
  };
  std::vector<int> all(shapes.size()), corrected, measured;
  std::iota(all.begin(), all.end(), 0);
  std::copy_if(all.begin(), all.end(), std::back_inserter(corrected),
               [&](int s) { return shapes[s].on && in_others(*shapes[s].on); });
  std::copy_if(all.begin(), all.end(), std::back_inserter(measured), [&](int s) { return !shapes[s].on; });
  return !corrected.empty() ? corrected : !measured.empty() ? measured : all;
}

std::optional<Correction> CorrectionOf(const ModelStructure& model, std::span<const EffectChoice> choices,
                                       std::span<const std::vector<double>> values, std::size_t k) {
  const bool corrects = static_cast<bool>(model.effects[choices[k].effect]->correct);
  for (std::size_t j = 0; j < choices.size(); ++j)
    if (j != k && model.effects[choices[j].effect]->correct && !values[j].empty() && (!corrects || j < k))
      return Correction{choices[j].effect, values[j].front()};
  return std::nullopt;
}

double ExcessStd(const ExtendedFit& fit) { return StandardErrorOfSum(fit.excess); }

void ScaleScatter(const Eigen::VectorXd& factor, ExtendedFit& fit) {
  fit.covariance = factor.asDiagonal() * fit.covariance * factor.asDiagonal();
  const auto base = factor.size() - static_cast<Eigen::Index>(fit.effects.size());
  for (std::size_t k = 0; k < fit.effects.size(); ++k)
    fit.effects[k].std *= factor[base + static_cast<Eigen::Index>(k)];
}

Eigen::MatrixXd Unpacked(const SymmetricMatrix& packed) {
  Eigen::MatrixXd full(packed.dimension(), packed.dimension());
  for (int j = 0; j < packed.dimension(); ++j)
    for (int i = 0; i <= j; ++i) full(i, j) = full(j, i) = packed(i, j);
  return full;
}

void StrokeSet::Stroke::TakeOut(int column) {
  for (SymmetricMatrix* matrix : {&clean, &noise, &flow})
    for (int other = 0; other < matrix->dimension(); ++other) (*matrix)(column, other) = 0;
}

StrokeSet::StrokeSet(std::shared_ptr<const ModelStructure> model, std::vector<StrokeGram> strokes,
                     const WindowSamples& window, double noise_scale)
    : model_(std::move(model)), window_(window), noise_scale_(noise_scale) {
  const int columns = model_->column_count();
  for (StrokeGram& gram : strokes) {
    Stroke stroke{std::move(gram.integral),
                  std::move(gram.noise),
                  std::move(gram.flow),
                  gram.blocks,
                  gram.spans,
                  gram.log,
                  static_cast<double>(gram.windows),
                  std::vector<bool>(static_cast<std::size_t>(columns), false)};
    stroke.clean -= stroke.noise;
    for (int c = 0; c < columns; ++c) {
      if (std::isfinite(stroke.clean(c, c))) continue;
      stroke.bad[static_cast<std::size_t>(c)] = true;
      stroke.TakeOut(c);
    }
    equations_ += stroke.equations();
    strokes_.push_back(std::make_shared<const Stroke>(std::move(stroke)));
  }
}

StrokeSet::Formed::Formed(std::span<const std::shared_ptr<const Stroke>> strokes)
    : student(StudentFactor(static_cast<double>(strokes.size()) - 1)) {
  for (const auto& stroke : strokes) {
    if (total.dimension() == 0)
      total = stroke->clean;
    else
      total += stroke->clean;
    clean.Add(stroke->clean);
    noise.Add(stroke->noise);
    flow.Add(stroke->flow);
  }
}

StrokeSet::Formed& StrokeSet::OfAll() const {
  std::call_once(lazily_->formed, [&] { lazily_->of_all = std::make_unique<Formed>(strokes_); });
  return *lazily_->of_all;
}

Eigen::MatrixXd StrokeSet::Total() const { return Unpacked(OfAll().total); }

std::vector<Eigen::MatrixXd> StrokeSet::TotalOfEach() const {
  std::vector<Eigen::MatrixXd> totals;
  for (const auto& stroke : strokes_) totals.push_back(Unpacked(stroke->clean));
  return totals;
}

double StrokeSet::OutputEnergy() const {
  const int output = model_->output_column();
  double energy = 0;
  for (const auto& stroke : strokes_) energy += stroke->clean(output, output);
  return energy;
}

Eigen::MatrixXd StrokeSet::TotalFlow() const {
  SymmetricMatrix total(model_->column_count());
  for (const auto& stroke : strokes_) total += stroke->flow;
  return Unpacked(total);
}

Eigen::VectorXd StrokeSet::Direction(const EffectChoice& choice, const Eigen::VectorXd& theta) const {
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(model_->column_count());
  const SparseColumns columns = Composite({&choice, 1}, theta);
  for (const auto& [column, weight] : columns[model_->base_count]) direction[column] += weight;
  return direction;
}

StrokeSet StrokeSet::Only(std::span<const std::size_t> strokes) const {
  StrokeSet some(model_, {}, window_, noise_scale_);
  for (const std::size_t s : strokes) {
    some.strokes_.push_back(strokes_[s]);
    some.equations_ += strokes_[s]->equations();
  }
  return some;
}

std::optional<StrokeSet> StrokeSet::Comparable() const {
  std::vector<std::size_t> good;
  for (std::size_t s = 0; s < strokes_.size(); ++s)
    if (!Contains(strokes_[s]->bad, true)) good.push_back(s);
  if (good.size() == strokes_.size() || good.size() < kLeastStrokes || 2 * good.size() < strokes_.size())
    return std::nullopt;
  return Only(good);
}

StrokeSet StrokeSet::WithEffectsIn(std::span<const std::size_t> strokes,
                                   std::span<const EffectChoice> everywhere) const {
  StrokeSet out = *this;
  out.lazily_ = std::make_shared<Lazily>();
  std::vector<bool> kept(static_cast<std::size_t>(model_->column_count()), false);
  std::fill_n(kept.begin(), model_->output_column() + 1, true);
  for (const EffectChoice& choice : everywhere)
    for (const int column : model_->effect_shapes[choice.effect][choice.shape].columns) kept[column] = true;
  for (std::size_t s = 0; s < strokes_.size(); ++s) {
    if (Contains(strokes, s)) continue;
    Stroke without = *strokes_[s];
    for (std::size_t c = 0; c < kept.size(); ++c) {
      if (kept[c]) continue;
      without.bad[c] = false;
      without.TakeOut(static_cast<int>(c));
    }
    out.strokes_[s] = std::make_shared<const Stroke>(std::move(without));
  }
  return out;
}

double StrokeSet::ExcessRatio(const ExtendedFit& fit, std::size_t stroke) const {
  const double noise = fit.noise_variance * Equations(stroke);
  const double excess = fit.excess[static_cast<Eigen::Index>(stroke)];
  return noise > 0 ? (excess - (1 - 1 / noise_scale_) * noise) / noise : 0.0;
}

std::vector<std::size_t> StrokeSet::Usable(std::span<const EffectChoice> choices) const {
  std::vector<std::size_t> strokes;
  for (std::size_t s = 0; s < strokes_.size(); ++s) {
    bool good = true;
    for (const EffectChoice& choice : choices)
      for (int column : model_->effect_shapes[choice.effect][choice.shape].columns)
        good = good && !strokes_[s]->bad[column];
    if (good) strokes.push_back(s);
  }
  return strokes;
}

bool StrokeSet::Measured(const EffectChoice& choice) const {
  const std::vector<std::size_t> usable = Usable({&choice, 1});
  if (usable.size() < std::min(kLeastStrokes, strokes_.size())) return false;
  for (int column : model_->effect_shapes[choice.effect][choice.shape].columns)
    for (std::size_t s : usable)
      if (strokes_[s]->clean(column, column) != 0.0) return true;
  return false;
}

EffectChoice StrokeSet::BestShape(int effect, std::span<const EffectChoice> others) const {
  EffectChoice best{effect, -1};
  double least = 0;
  bool lawful = false;
  std::vector<EffectChoice> choices(others.begin(), others.end());
  choices.push_back({effect, 0});
  for (const int shape : ShapesFor(*model_, effect, others)) {
    choices.back().shape = shape;
    const ExtendedFit fit = Fit(choices);
    if (!fit.solved) continue;
    const bool admissible = fit.effects.back().admissible;
    if (best.shape >= 0 && (lawful != admissible ? lawful : fit.excess_ratio >= least)) continue;
    best = choices.back();
    least = fit.excess_ratio;
    lawful = admissible;
  }
  return best;
}

SparseColumns StrokeSet::Composite(std::span<const EffectChoice> choices,
                                   const Eigen::VectorXd& theta) const {
  SparseColumns columns;
  for (int c = 0; c < model_->base_count; ++c) columns.push_back({{c, 1.0}});
  for (std::size_t k = 0; k < choices.size(); ++k) {
    const EffectShape& shape = model_->effect_shapes[choices[k].effect][choices[k].shape];
    const double size = theta.size() > model_->base_count ? theta[model_->base_count + k] : 0.0;
    const std::vector<double> weights = shape.weights({theta.head(model_->base_count), size});
    std::vector<std::pair<int, double>> column;
    for (std::size_t j = 0; j < weights.size(); ++j) column.emplace_back(shape.columns[j], weights[j]);
    columns.push_back(std::move(column));
  }
  columns.push_back({{model_->output_column(), 1.0}});
  return columns;
}

ExtendedFit StrokeSet::Fit(std::span<const EffectChoice> choices) const {
  ExtendedFit fit;
  const std::vector<std::size_t> usable = Usable(choices);
  if (usable.empty()) return fit;
  SparseColumns columns = Composite({}, Eigen::VectorXd::Zero(model_->base_count));
  const auto solve = [&] {
    if (usable.size() == strokes_.size())
      return SolveNormalEquations(AsEquations(Congruence(OfAll().total, columns), equations_));
    NormalEquations total;
    for (const std::size_t s : usable)
      total += AsEquations(Congruence(strokes_[s]->clean, columns), Equations(s));
    return SolveNormalEquations(total);
  };
  fit.theta = solve();
  if (fit.theta.size() == 0) return fit;
  for (int pass = 0; !choices.empty() && pass < kRelinearisations; ++pass) {
    columns = Composite(choices, fit.theta);
    const Eigen::VectorXd theta = solve();
    if (theta.size() == 0 || !theta.allFinite()) return fit;
    const bool settled =
        theta.size() == fit.theta.size() &&
        ((theta - fit.theta).cwiseAbs().array() <= kParametersSettled * theta.cwiseAbs().array()).all();
    fit.theta = theta;
    if (settled) break;
  }
  fit.solved = true;
  Judge(columns, usable, choices, fit);
  return fit;
}

void StrokeSet::Widen(std::span<const EffectChoice> choices, ExtendedFit& fit) const {
  if (!fit.solved) return;
  const SparseColumns columns = Composite(choices, fit.theta);
  std::vector<NormalEquations> equations;
  std::vector<StrokeOperation> operations;
  for (const std::size_t s : Usable(choices)) {
    const Stroke& stroke = *strokes_[s];
    equations.push_back(AsEquations(Congruence(stroke.clean, columns), stroke.equations()));
    const Eigen::VectorXd square = Congruence(stroke.flow, columns).diagonal().head(fit.theta.size());
    operations.push_back({stroke.log, (square / std::max(1.0, stroke.windows)).cwiseSqrt()});
  }
  fit.clusters = FindStrokeClusters(equations, operations, fit.theta);
  const Eigen::MatrixXd plain =
      JackknifeCovariance(ReplicasWithoutClusters(equations, SingleStrokes(equations.size())));
  if (plain.rows() != fit.covariance.rows()) return;
  const Eigen::MatrixXd wide = WidenedCovariance(equations, fit.clusters, plain);
  // As a factor, so that what else widens a fit (diagnosis/nonlinear_scatter.h) may come before or after.
  fit.widening = (wide.diagonal().array() / plain.diagonal().array().max(1e-300)).sqrt().matrix();
  ScaleScatter(fit.widening, fit);
}

void StrokeSet::Judge(const SparseColumns& columns, std::span<const std::size_t> strokes,
                      std::span<const EffectChoice> choices, ExtendedFit& fit) const {
  Formed& of_all = OfAll();
  const StrokeForms clean = of_all.clean.Congruence(columns), flow = of_all.flow.Congruence(columns);
  const Eigen::MatrixXd total_flow = flow.Sum(strokes), total_clean = clean.Sum(strokes),
                        total_noise = of_all.noise.Congruence(columns).Sum(strokes);
  NormalEquations total = AsEquations(total_clean, 0);
  double all_windows = 0;
  NoiseFloorSum floor(window_);
  for (const std::size_t s : strokes) {
    total.equations += Equations(s);
    all_windows += strokes_[s]->windows;
    floor.AddStroke(strokes_[s]->blocks, strokes_[s]->spans);
  }
  std::vector<int> added;
  for (const EffectChoice& choice : choices) added.push_back(choice.effect);
  floor.AddNoise(total_noise, fit.theta, model_->WalkingParameters(added));
  JudgeFlows(total_flow, all_windows, fit);

  // Leave one stroke out: spread of the parameters and error on the stroke left out.
  const LeftOutStrokes left_out = LeaveOutEach(clean, flow, total_clean, fit.theta, strokes);
  fit.excess.setConstant(static_cast<Eigen::Index>(strokes_.size()),
                         std::numeric_limits<double>::quiet_NaN());
  fit.flow_error = fit.excess;
  double excess = 0, flow_error = 0, windows = 0;
  for (std::size_t k = 0; k < strokes.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k), stroke = static_cast<Eigen::Index>(strokes[k]);
    fit.excess[stroke] = left_out.error[at];
    fit.flow_error[stroke] = left_out.flow_error[at];
    excess += left_out.error[at];
    if (left_out.indispensable[k]) {  // not judged: no model without it
      ++fit.indispensable_strokes;
      continue;
    }
    flow_error += left_out.flow_error[at];
    windows += strokes_[strokes[k]]->windows;
  }
  const double fit_excess = Energy(total_clean, fit.theta);
  double noise = Energy(total_noise, fit.theta);
  // Of the error, the noise shares were taken out already; the rest of the noise is still in it.
  const double further_noise = (noise_scale_ - 1) * noise;
  noise *= noise_scale_;
  fit.excess_ratio = (excess - further_noise) / noise;
  fit.excess_error = ExcessStd(fit) / noise;
  fit.noise_variance = noise / total.equations;
  fit.fit_excess_ratio = (fit_excess - further_noise) / noise;
  fit.rms_holdout = windows > 0 ? std::sqrt(NonNegative(flow_error / windows)) : 0.0;
  // Coloured noise reaches flows by a way that is not known: as much of the error as in the integral form.
  fit.noise_floor =
      noise_scale_ == 1.0 ? floor.Rms() : fit.rms_holdout / std::sqrt(1 + std::max(0.0, fit.excess_ratio));

  fit.covariance = JackknifeCovariance(left_out.theta);
  const double student = strokes.size() == strokes_.size()
                             ? of_all.student
                             : StudentFactor(static_cast<double>(strokes.size()) - 1);
  const Eigen::VectorXd scale = total.h.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse =
      scale.asDiagonal() * Inverse(scale.asDiagonal() * total.h * scale.asDiagonal()) * scale.asDiagonal();
  for (std::size_t k = 0; k < choices.size(); ++k) {
    const int i = model_->base_count + static_cast<int>(k);
    EffectEstimate estimate = SizeOf(*model_, choices[k], fit.theta, i);
    estimate.std = std::sqrt(fit.covariance(i, i)) * student;
    estimate.model_std = std::sqrt(NonNegative(inverse(i, i)) * fit.noise_variance);
    estimate.independent = std::clamp(1.0 / (inverse(i, i) * total.h(i, i)), 0.0, 1.0);
    fit.effects.push_back(estimate);
  }
}

}  // namespace hydroscope
