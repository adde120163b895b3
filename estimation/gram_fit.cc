#include "estimation/gram_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/constants.h"
#include "core/distributions.h"
#include "core/non_negative.h"
#include "core/told_error.h"
#include "estimation/decompositions.h"
#include "estimation/error_trust.h"

namespace hydroscope {
namespace {

NormalEquations Extract(const SymmetricMatrix& gram, std::span<const int> columns, int output) {
  const int k = static_cast<int>(columns.size());
  NormalEquations e{Eigen::MatrixXd(k, k), Eigen::VectorXd(k), gram(output, output), 0.0};
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < k; ++j) e.h(i, j) = gram(columns[i], columns[j]);
    e.g[i] = gram(columns[i], output);
  }
  return e;
}

std::vector<int> BaseColumns(const ModelStructure& model) {
  std::vector<int> columns(model.base_count);
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
}

/// Centred energy that a random walk of unit variance per block leaves in the spans of a stroke, (B^2 - 1) /
/// 6 each: full spans and the rest of one segment.
double WalkGain(std::int64_t stroke_blocks, int span) {
  const auto gain = [](double blocks) { return (blocks * blocks - 1.0) / 6.0; };
  const auto full = stroke_blocks / span;
  const auto rest = stroke_blocks % span;
  return static_cast<double>(full) * gain(span) + (rest > 0 ? gain(static_cast<double>(rest)) : 0.0);
}

/// Noise share of a stroke over chosen regressors, output last.
Eigen::MatrixXd NoiseShare(const StrokeGram& gram, std::span<const int> columns, int output) {
  const NormalEquations e = Extract(gram.noise, columns, output);
  const auto n = e.g.size();
  Eigen::MatrixXd share(n + 1, n + 1);
  share << e.h, e.g, e.g.transpose(), e.yy;
  return share;
}

/// How a stroke was driven: rms of its regressors.
StrokeOperation OperationOf(const StrokeGram& gram, std::span<const int> columns) {
  StrokeOperation out{gram.log, Eigen::VectorXd(static_cast<Eigen::Index>(columns.size()))};
  const double windows = static_cast<double>(std::max<std::int64_t>(1, gram.windows));
  for (std::size_t i = 0; i < columns.size(); ++i)
    out.level[i] = std::sqrt(gram.flow(columns[i], columns[i]) / windows);
  return out;
}

/// The strokes' groups, where they hang together.
StrokeClusters ClustersOf(std::span<const StrokeGram> strokes, std::span<const NormalEquations> equations,
                          std::span<const int> columns, const Eigen::VectorXd& theta) {
  std::vector<StrokeOperation> operations;
  for (const StrokeGram& gram : strokes) operations.push_back(OperationOf(gram, columns));
  return FindStrokeClusters(equations, operations, theta);
}

/// Variances of the physical parameters by the jackknife over replicas of theta.
Eigen::VectorXd DerivedVariance(const ModelStructure& model, const Eigen::MatrixXd& replicas) {
  Eigen::MatrixXd derived;
  for (Eigen::Index s = 0; s < replicas.cols(); ++s) {
    const std::vector<DerivedParameter> values = model.derive(replicas.col(s));
    if (derived.size() == 0) derived.resize(static_cast<Eigen::Index>(values.size()), replicas.cols());
    for (std::size_t i = 0; i < values.size(); ++i)
      derived(static_cast<Eigen::Index>(i), s) = values[i].value;
  }
  return JackknifeCovariance(derived).diagonal();
}

/// Stds of the physical parameters by leaving out single strokes (`replicas`) or `clusters`, whichever is
/// wider, with Student's t in them.
Eigen::VectorXd DerivedStd(const ModelStructure& model, std::span<const NormalEquations> strokes,
                           const std::vector<DerivedParameter>& derived, const StrokeClusters& clusters,
                           const Eigen::MatrixXd& replicas) {
  Eigen::MatrixXd gradients(replicas.rows(), static_cast<Eigen::Index>(derived.size()));
  for (std::size_t i = 0; i < derived.size(); ++i)
    gradients.col(static_cast<Eigen::Index>(i)) = derived[i].gradient;
  const Eigen::VectorXd single =
      DerivedVariance(model, replicas)
          .cwiseSqrt()
          .cwiseProduct(
              StrokesThatTell(strokes, gradients).unaryExpr([](double n) { return StudentFactor(n - 1); }));
  if (clusters.unit == ClusterUnit::kStroke) return single;
  const Eigen::MatrixXd grouped = ReplicasWithoutClusters(strokes, clusters);
  if (grouped.size() == 0) return single;
  return single.cwiseMax(DerivedVariance(model, grouped).cwiseSqrt() * StudentFactor(clusters.count - 1.0));
}

/// Sizes of output, model and difference in the flow form.
void TakeSizes(const NormalEquations& flow, GramFit& fit) {
  if (!(flow.equations > 0)) return;
  fit.rms_measured = std::sqrt(flow.yy / flow.equations);
  fit.rms_modelled = std::sqrt(NonNegative(fit.theta.dot(flow.h * fit.theta) / flow.equations));
  fit.rms_residual = std::sqrt(NonNegative(MeanSquaredError(flow, fit.theta)));
}

}  // namespace

EstimateReason TrustOf(const DerivedParameter& parameter, double std) {
  constexpr double kWidest = 0.3, kWidestNumber = 0.05;
  if (!parameter.admissible) return EstimateReason::kOutsidePhysics;
  const double scale = parameter.unit == "1" ? kWidestNumber : kWidest * std::abs(parameter.value);
  return std <= scale ? EstimateReason::kUpdated : EstimateReason::kConfounded;
}

NormalEquations& NormalEquations::operator+=(const NormalEquations& other) {
  if (h.size() == 0) return *this = other;
  h += other.h;
  g += other.g;
  yy += other.yy;
  equations += other.equations;
  return *this;
}

NormalEquations& NormalEquations::operator-=(const NormalEquations& other) {
  h -= other.h;
  g -= other.g;
  yy -= other.yy;
  equations -= other.equations;
  return *this;
}

NormalEquations IntegralEquations(const StrokeGram& gram, std::span<const int> columns, int output,
                                  NoiseCorrection correction) {
  NormalEquations e = Extract(gram.integral, columns, output);
  if (correction == NoiseCorrection::kSubtract) {
    const NormalEquations noise = Extract(gram.noise, columns, output);
    e.h -= noise.h;
    e.g -= noise.g;
  }
  e.equations = static_cast<double>(gram.blocks - gram.spans);
  return e;
}

NormalEquations FlowEquations(const StrokeGram& gram, std::span<const int> columns, int output) {
  NormalEquations e = Extract(gram.flow, columns, output);
  e.equations = static_cast<double>(gram.windows);
  return e;
}

namespace {

/// `Matrix` holds as many columns as there are.
template <typename Matrix>
Eigen::VectorXd SolveIn(const NormalEquations& equations) {
  const Eigen::VectorXd scale = equations.h.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Matrix> factor(Matrix(scale.asDiagonal() * equations.h * scale.asDiagonal()));
  // A pivot is the share of a regressor the others do not explain; the condition passes over pivots of exactly zero. No entry of L
  // is above one, nor of the scaled matrix: the condition is no worse than the least pivot over n 4^n.
  const double least = factor.vectorD().minCoeff();
  if (factor.info() != Eigen::Success || !(least > kLeastCondition)) return {};
  const auto n = static_cast<double>(scale.size());
  const bool certain = least > kLeastCondition * n * std::pow(4.0, n);
  if (!certain && factor.rcond() < kLeastCondition) return {};
  return scale.asDiagonal() * factor.solve(scale.asDiagonal() * equations.g);
}

}  // namespace

Eigen::VectorXd SolveNormalEquations(const NormalEquations& equations) {
  if (!(equations.h.diagonal().minCoeff() > 0) || !equations.h.allFinite()) return {};
  constexpr int kFew = 12;  // as nearly all models have: on the stack
  using FewColumns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kFew, kFew>;
  return equations.h.cols() <= kFew ? SolveIn<FewColumns>(equations) : SolveIn<Eigen::MatrixXd>(equations);
}

double MeanSquaredError(const NormalEquations& e, const Eigen::VectorXd& theta) {
  return (theta.dot(e.h * theta) - 2 * theta.dot(e.g) + e.yy) / e.equations;
}

double StudentFactor(double degrees) {
  if (!(degrees >= 1)) return kInfinity;
  return StudentHalfWidth95(degrees) / kNormal95;
}

Eigen::VectorXd Excitation(const Eigen::MatrixXd& h) {
  const Eigen::VectorXd scale = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * h * scale.asDiagonal();
  const Eigen::MatrixXd inverse = PseudoInverse(correlation);
  Eigen::VectorXd share(h.rows());
  for (int i = 0; i < h.rows(); ++i) share[i] = inverse(i, i) > 0 ? std::min(1.0, 1.0 / inverse(i, i)) : 0.0;
  return share;
}

std::vector<int> OwnParameters(const std::vector<DerivedParameter>& derived, const Eigen::VectorXd& theta) {
  std::vector<int> own(derived.size(), -1);
  std::vector<bool> taken(theta.size(), false);
  for (bool found = true; found;) {
    found = false;
    for (std::size_t d = 0; d < derived.size(); ++d) {
      int free = 0, last = -1;
      for (int i = 0; i < theta.size(); ++i)
        if (!taken[i] && derived[d].gradient[i] != 0) {
          ++free;
          last = i;
        }
      if (own[d] >= 0 || free != 1) continue;
      own[d] = last;
      taken[last] = found = true;
    }
  }
  for (std::size_t d = 0; d < derived.size(); ++d)
    if (own[d] < 0) derived[d].gradient.cwiseProduct(theta).cwiseAbs().maxCoeff(&own[d]);
  return own;
}

void NoiseFloorSum::AddStroke(std::int64_t blocks, std::int64_t spans) {
  equations_ += static_cast<double>(blocks - spans);
  walk_gain_ += WalkGain(blocks, window_.span);
}

void NoiseFloorSum::AddNoise(const Eigen::MatrixXd& noise, const Eigen::VectorXd& theta,
                             std::span<const int> walk) {
  const auto n = theta.size();
  Eigen::VectorXd residual(n + 1);
  residual << theta, -1.0;
  double walking = 0;
  for (const int i : walk)
    for (const int j : walk) walking += residual[i] * noise(i, j) * residual[j];
  white_ += residual.dot(noise * residual) - walking;
  walk_ += walking;
}

double NoiseFloorSum::Rms() const {
  if (equations_ <= 0) return 0.0;
  const double walk = walk_gain_ > 0 ? walk_ / walk_gain_ : 0.0;
  return std::sqrt(NonNegative(window_.FlowNoiseVariance(white_ / equations_, walk)));
}

double NoiseFloor(std::span<const StrokeGram> strokes, std::span<const int> columns, int output,
                  const Eigen::VectorXd& theta, const WindowSamples& window, std::span<const int> walk) {
  NoiseFloorSum sum(window);
  for (const StrokeGram& gram : strokes) {
    sum.AddStroke(gram.blocks, gram.spans);
    sum.AddNoise(NoiseShare(gram, columns, output), theta, walk);
  }
  return sum.Rms();
}

Told WhyNotSolved(const ModelStructure& model, std::span<const StrokeGram> strokes,
                  const WindowSamples& window) {
  if (std::ranges::all_of(strokes, [](const StrokeGram& gram) { return gram.blocks == 0; }))
    return Tell(
        "gaps, repeated rows and bad values cut the log into pieces shorter than the {:.3g} s that an equation needs: see "
        "'hydroscope check', and record without them",
        "Lücken, wiederholte Zeilen und schlechte Werte zerschneiden das Log in Stücke, die kürzer sind als die {:.3g} s, die eine "
        "Gleichung braucht: 'hydroscope check' zeigt sie; ohne sie aufzeichnen",
        window.min_span * window.block * window.period);
  return Tell(
      "the strokes do not excite all parameters of the model: vary {}, or record longer",
      "die Hübe regen nicht alle Parameter des Modells an: verändern, was hier steht, oder länger aufzeichnen: {}",
      model.words.vary);
}

Result<GramFit> FitBaseModel(const ModelStructure& model, std::span<const StrokeGram> strokes,
                             const WindowSamples& window) {
  const std::vector<int> columns = BaseColumns(model);
  const int output = model.output_column();
  std::vector<NormalEquations> integral, flow;
  NormalEquations total;
  for (const StrokeGram& gram : strokes) {
    integral.push_back(IntegralEquations(gram, columns, output));
    flow.push_back(FlowEquations(gram, columns, output));
    total += integral.back();
  }
  GramFit fit;
  fit.strokes = static_cast<int>(strokes.size());
  if (fit.strokes == 0)
    return BadInput(
        Tell("no {} found: check the [gate] of the machine file against the log with 'hydroscope check'",
             "nicht gefunden: {}; [gate] der Maschinendatei am Log prüfen ('hydroscope check')",
             model.words.stroke));
  fit.theta = SolveNormalEquations(total);
  if (fit.theta.size() == 0) return BadInput(WhyNotSolved(model, strokes, window));

  // Delete one stroke at a time: spread of the parameters, and the error on the stroke left out.
  const std::vector<DerivedParameter> derived = model.derive(fit.theta);
  Eigen::MatrixXd replicas(fit.theta.size(), fit.strokes);
  double squared_error = 0, judged = 0;
  NormalEquations total_flow;
  for (int s = 0; s < fit.strokes; ++s) {
    fit.windows += strokes[s].windows;
    total_flow += flow[s];
    NormalEquations rest = total;
    rest -= integral[s];
    Eigen::VectorXd theta = SolveNormalEquations(rest);
    if (theta.size() == 0) {
      ++fit.indispensable_strokes;
      theta = fit.theta;
    } else if (flow[s].equations > 0) {
      squared_error += MeanSquaredError(flow[s], theta) * flow[s].equations;
      judged += flow[s].equations;
    }
    replicas.col(s) = theta;
  }
  fit.rms_holdout = judged > 0 ? std::sqrt(NonNegative(squared_error / judged)) : 0.0;
  TakeSizes(total_flow, fit);
  fit.noise_floor = NoiseFloor(strokes, columns, output, fit.theta, window, model.WalkingParameters());

  fit.clusters = ClustersOf(strokes, integral, columns, fit.theta);
  fit.covariance = WidenedCovariance(integral, fit.clusters, JackknifeCovariance(replicas));
  const Eigen::VectorXd stds = DerivedStd(model, integral, derived, fit.clusters, replicas);
  const Eigen::VectorXd excitation = Excitation(total.h);
  const std::vector<int> own = OwnParameters(derived, fit.theta);
  const std::vector<bool> carried =
      CarriedByError(total.h, total_flow, fit.theta, fit.rms_holdout, fit.noise_floor);
  const bool spread_known = fit.strokes > 1 && fit.indispensable_strokes == 0;
  for (std::size_t i = 0; i < derived.size(); ++i) {
    const double random = spread_known ? stds[i] : kInfinity;
    Estimate estimate;
    estimate.parameter = derived[i].name;
    estimate.value = derived[i].value;
    estimate.unit = derived[i].unit;
    estimate.std = std::hypot(random, derived[i].geometry_std);
    estimate.excitation = excitation[own[i]];
    estimate.reason = TrustOf(derived[i], estimate.std);
    if (estimate.reason == EstimateReason::kUpdated && carried[static_cast<std::size_t>(own[i])])
      estimate.reason = EstimateReason::kConfounded;
    fit.parameters.push_back(estimate);
  }
  return fit;
}

}  // namespace hydroscope
