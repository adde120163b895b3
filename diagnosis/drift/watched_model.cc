#include "diagnosis/drift/watched_model.h"

#include <cmath>
#include <numeric>

#include "core/contains.h"
#include "core/told_error.h"
#include "estimation/decompositions.h"
#include "models/effect.h"
#include "models/machine_kind.h"
#include "models/parameter_unit.h"

namespace hydroscope::drift {
namespace {

/// The first parameters, as many as `count`, of which none follows from those before.
std::vector<std::size_t> Independent(const std::vector<DerivedParameter>& derived, int count) {
  constexpr double kLeast = 1e-9;  ///< share of a gradient that those before do not hold
  std::vector<std::size_t> picked;
  std::vector<Eigen::VectorXd> basis;
  for (std::size_t i = 0; i < derived.size() && static_cast<int>(picked.size()) < count; ++i) {
    Eigen::VectorXd rest = derived[i].gradient.normalized();
    for (const Eigen::VectorXd& b : basis) rest -= b.dot(rest) * b;
    if (!(rest.norm() > kLeast)) continue;
    basis.push_back(rest.normalized());
    picked.push_back(i);
  }
  return picked;
}

}  // namespace

Result<WatchedModel> WatchedModel::Create(std::shared_ptr<const ModelStructure> model,
                                          const std::vector<std::string>& effects) {
  WatchedModel watched;
  watched.model_ = model;
  watched.columns_.resize(model->base_count);
  std::iota(watched.columns_.begin(), watched.columns_.end(), 0);
  const auto derived = model->derive(Eigen::VectorXd::Ones(model->base_count));
  watched.picked_ = Independent(derived, model->base_count);
  if (static_cast<int>(watched.picked_.size()) != model->base_count)
    return BadInput(Tell(
        "the {} parameters of model {} follow from fewer than its {} regressors; "
        "drift can only be watched of as many",
        "die {} Parameter des Modells {} folgen aus weniger als seinen {} Regressoren; überwacht werden können nur "
        "ebenso viele",
        derived.size(), model->name, model->base_count));
  for (const std::size_t picked : watched.picked_) {
    const DerivedParameter& p = derived[picked];
    const MachineParameter* known = FindParameter(*model->kind, p.name);
    watched.quantities_.push_back({p.name, p.unit, known != nullptr ? known->over_oil : OilLaw::kSmooth,
                                   false, p.unit == "1" && known != nullptr && !known->relative, Told(),
                                   ToldInPercent(*model->kind, p.name, p.unit)});
  }
  for (std::size_t e = 0; e < model->effects.size(); ++e) {
    const Effect& effect = *model->effects[e];
    if (!Contains(effects, effect.id)) continue;
    if (model->effect_shapes[e].empty()) continue;
    const EffectShape& shape = model->effect_shapes[e].front();
    if (shape.columns.size() != 1 || !effect.nonlinear.empty()) continue;
    watched.quantities_.push_back({effect.id, effect.unit, OilLaw::kSmooth, true, effect.unit == "1",
                                   Told(effect.title, effect.german.title)});
    watched.columns_.push_back(shape.columns.front());
  }
  return watched;
}

StrokeEvidence WatchedModel::Evidence(const StrokeRecord& record, std::int64_t sequence) const {
  const StrokeSummary& s = record.summary;
  return {sequence, s.end, s.oil_temperature, s.conditions,
          IntegralEquations(record.gram, columns_, model_->output_column())};
}

Eigen::VectorXd WatchedModel::SolveBase(const NormalEquations& equations) const {
  const int n = base_count();
  return SolveNormalEquations(
      {equations.h.topLeftCorner(n, n), equations.g.head(n), equations.yy, equations.equations});
}

Eigen::VectorXd WatchedModel::Solve(const NormalEquations& equations) const {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(size());
  const Eigen::VectorXd base = SolveBase(equations);
  if (base.size() == 0) return {};
  theta.head(base_count()) = base;
  return Values(theta);
}

Eigen::VectorXd WatchedModel::Values(const Eigen::VectorXd& theta) const {
  Eigen::VectorXd values = theta;
  const auto derived = model_->derive(theta.head(base_count()));
  for (std::size_t i = 0; i < picked_.size(); ++i)
    values[static_cast<Eigen::Index>(i)] = derived[picked_[i]].value;
  return values;
}

Eigen::MatrixXd WatchedModel::Jacobian(const Eigen::VectorXd& theta) const {
  const int n = base_count();
  Eigen::MatrixXd gradients(n, n);
  const auto derived = model_->derive(theta.head(n));
  for (int i = 0; i < n; ++i)
    gradients.row(i) = derived[picked_[static_cast<std::size_t>(i)]].gradient.transpose();
  // Rows and columns differ by twenty orders of magnitude: scaled to about one before the inverse.
  const Eigen::VectorXd column = theta.head(n).cwiseAbs().cwiseMax(1e-300);
  const Eigen::VectorXd row =
      (gradients * column.asDiagonal()).cwiseAbs().rowwise().maxCoeff().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = row.asDiagonal() * gradients * column.asDiagonal();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Identity(size(), size());
  jacobian.topLeftCorner(n, n) = column.asDiagonal() * Inverse(scaled) * row.asDiagonal();
  return jacobian;
}

Eigen::VectorXd WatchedModel::Theta(const Eigen::VectorXd& quantities, const Eigen::VectorXd& start) const {
  Eigen::VectorXd theta = start;
  constexpr int kSteps = 12;
  constexpr double kExact = 1e-12;  // relative, and least size: Newton's steps end at rounding
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::VectorXd missing = quantities - Values(theta);
    theta += Jacobian(theta) * missing;
    if (!theta.allFinite()) return {};
    if ((missing.array().abs() <= kExact * quantities.array().abs().max(kExact)).all()) return theta;
  }
  return {};
}

Score WatchedModel::Deviation(const NormalEquations& equations, const Eigen::VectorXd& theta) const {
  const Eigen::MatrixXd jacobian = Jacobian(theta);
  return {jacobian.transpose() * (equations.g - equations.h * theta),
          jacobian.transpose() * equations.h * jacobian};
}

}  // namespace hydroscope::drift
