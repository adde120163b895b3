#include "diagnosis/remainder/predictability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/quantile.h"
#include "diagnosis/remainder/feature_banks.h"
#include "diagnosis/remainder/held_out_form.h"
#include "diagnosis/sample_grams.h"
#include "estimation/column_products.h"

namespace hydroscope {
namespace {

/// Penalties of the ridge, on features scaled to unit energy.
constexpr std::array<double, 5> kPenalties = {1e-4, 1e-3, 1e-2, 5e-2, 0.3};
constexpr std::uint64_t kFlipSeed = 20250101;
constexpr std::size_t kLeastGroups = 5;  ///< 2^5 signs and fewer have no p-value of use
constexpr double kLeastEnergy = 1e-12;   ///< of a feature over the largest of its bank: less is rounding

/// Sums of products of one group: features f; z are regressors of the model and at last the residual, whose products with all others
/// are without noise.
struct GroupGram {
  Eigen::MatrixXd features;  ///< a column each; rows are features, on and below the diagonal, then z
  Eigen::MatrixXd zz;        ///< on and below the diagonal
  double rows = 0;           ///< equations

  Eigen::Index feature_count() const { return features.cols(); }
  double ff(Eigen::Index i, Eigen::Index j) const { return features(std::max(i, j), std::min(i, j)); }
  double fz(Eigen::Index f, Eigen::Index c) const { return features(features.cols() + c, f); }
};

/// A model's regressors and residual as combinations of its columns.
Eigen::MatrixXd RegressorsOf(const ModelStructure& model, const ExtendedFit& fit,
                             std::span<const EffectChoice> choices) {
  const int count = model.base_count + static_cast<int>(choices.size());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(model.column_count(), count + 1);
  const Eigen::VectorXd base = fit.theta.head(model.base_count);
  for (int c = 0; c < model.base_count; ++c) out(c, c) = 1;
  for (std::size_t k = 0; k < choices.size(); ++k) {
    const EffectShape& shape = model.effect_shapes[choices[k].effect][choices[k].shape];
    const std::vector<double> weights = shape.weights({base, fit.effects[k].size});
    for (std::size_t j = 0; j < weights.size(); ++j)
      out(shape.columns[j], model.base_count + static_cast<int>(k)) += weights[j];
  }
  out(model.output_column(), count) = 1;
  out.col(count) -= out.leftCols(count) * fit.theta;
  return out;
}

/// The model with no more columns than the fits use, and their choices in it.
struct UsedModel {
  ModelStructure structure;
  std::vector<Eigen::MatrixXd> regressors;  ///< per fit
};

UsedModel Used(const ModelStructure& model, std::span<const ExtendedFit* const> fits) {
  UsedModel used{BaseOnly(model), {}};
  std::vector<std::vector<EffectChoice>> choices(fits.size());
  for (std::size_t f = 0; f < fits.size(); ++f)
    for (const EffectEstimate& e : fits[f]->effects) {
      const EffectShape& shape = model.effect_shapes[e.choice.effect][e.choice.shape];
      choices[f].push_back(
          {e.choice.effect, AddShape(used.structure, e.choice.effect, shape.nonlinear, shape.on)});
    }
  for (std::size_t f = 0; f < fits.size(); ++f)
    used.regressors.push_back(fits[f]->solved ? RegressorsOf(used.structure, *fits[f], choices[f])
                                              : Eigen::MatrixXd());
  return used;
}

/// Group of each stretch: strokes in turn, or neighbouring pieces of strokes where there are few.
class Grouping {
 public:
  Grouping(std::size_t strokes, std::size_t most)
      : pieces_(strokes >= most ? 1 : (most + strokes - 1) / std::max<std::size_t>(1, strokes)),
        count_(strokes >= most ? most : strokes * pieces_) {}
  std::size_t count() const { return count_; }
  std::size_t Of(std::size_t stroke, std::size_t part, std::size_t parts) const {
    return (stroke * pieces_ + part * pieces_ / std::max<std::size_t>(1, parts)) % count_;
  }

 private:
  std::size_t pieces_, count_;
};

/// Per fit and bank, the Grams of all groups.
using BankGrams = std::vector<GroupGram>;

/// A fit's regressors and residual over one stretch, and their products.
class FitRows {
 public:
  FitRows(const BlockColumns& model, const Eigen::MatrixXd& regressors)
      : z_{regressors.transpose() * model.means, regressors.transpose() * model.noise} {
    const auto residual = z_.means.rows() - 1;
    zz_.setZero(PaddedColumns(static_cast<int>(z_.means.rows())), z_.means.rows());
    AddColumnProducts(z_.means, {}, static_cast<int>(z_.means.cols()), packed_, zz_);
    zz_.row(residual).head(residual).noalias() -=
        z_.noise.row(residual) * z_.noise.topRows(residual).transpose();
  }
  bool finite() const { return z_.means.allFinite(); }

  /// `lost`: rows that centring takes. White sensor noise that features and regressors share with the residual is no law: it is
  /// taken out of their products with it.
  void AddTo(const BlockColumns& bank, double lost, GroupGram& sum) {
    const auto f = bank.means.rows(), m = z_.means.rows();
    const auto blocks = static_cast<int>(bank.means.cols());
    if (sum.zz.size() == 0) {
      sum.features.setZero(PaddedColumns(static_cast<int>(f + m)), f);
      sum.zz.setZero(zz_.rows(), m);
    }
    AddColumnProducts(bank.means, z_.means, blocks, packed_, sum.features);
    sum.features.row(f + m - 1).noalias() -= z_.noise.row(m - 1) * bank.noise.transpose();
    sum.zz += zz_;
    sum.rows += blocks - lost;
  }

 private:
  BlockColumns z_;
  Eigen::MatrixXd zz_, packed_;
};

/// Normal equations of features and regressors with the features scaled to unit energy over all groups.
struct BankProblem {
  GroupEquations equations;
  int features = 0;

  BankProblem(const BankGrams& groups, bool with_features);
  /// HeldOutForms with each of `penalties` on the features.
  std::vector<Eigen::MatrixXd> HeldOut(std::span<const double> penalties) const;
};

BankProblem::BankProblem(const BankGrams& groups, bool with_features) {
  const auto m = groups.front().zz.cols() - 1;
  Eigen::VectorXd energies = Eigen::VectorXd::Zero(groups.front().feature_count());
  Eigen::VectorXd own = Eigen::VectorXd::Zero(m);
  for (const GroupGram& g : groups) {
    energies += g.features.diagonal();
    own += g.zz.diagonal().head(m);
  }
  std::vector<int> kept;
  for (int f = 0; with_features && f < energies.size(); ++f)
    if (energies[f] > kLeastEnergy * energies.maxCoeff()) kept.push_back(f);
  features = static_cast<int>(kept.size());
  const auto n = features + m;
  Eigen::VectorXd scale(n);
  for (int f = 0; f < features; ++f) scale[f] = 1 / std::sqrt(energies[kept[f]]);
  for (int c = 0; c < m; ++c) scale[features + c] = own[c] > 0 ? 1 / std::sqrt(own[c]) : 0.0;
  auto& [h, q, energy] = equations;
  q.resize(n, static_cast<Eigen::Index>(groups.size()));
  energy.resize(static_cast<Eigen::Index>(groups.size()));
  for (std::size_t s = 0; s < groups.size(); ++s) {
    const GroupGram& g = groups[s];
    Eigen::MatrixXd both(n, n);
    for (int i = 0; i < features; ++i) {
      for (int j = 0; j < features; ++j) both(i, j) = g.ff(kept[i], kept[j]);
      for (int c = 0; c < m; ++c) both(i, features + c) = both(features + c, i) = g.fz(kept[i], c);
      q(i, s) = g.fz(kept[i], m);
    }
    both.bottomRightCorner(m, m) = g.zz.topLeftCorner(m, m).selfadjointView<Eigen::Lower>();
    q.col(s).tail(m) = g.zz.row(m).head(m);
    q.col(s).array() *= scale.array();
    h.push_back(scale.asDiagonal() * both * scale.asDiagonal());
    energy[s] = g.zz(m, m);
  }
}

std::vector<Eigen::MatrixXd> BankProblem::HeldOut(std::span<const double> penalties) const {
  constexpr double kRidge = 1e-10;  // holds regressors that the other groups do not move
  Eigen::MatrixXd ridges =
      Eigen::MatrixXd::Constant(equations.q.rows(), static_cast<Eigen::Index>(penalties.size()), kRidge);
  for (std::size_t k = 0; k < penalties.size(); ++k)
    ridges.col(static_cast<Eigen::Index>(k)).head(features).array() += penalties[k];
  return HeldOutForms(equations, ridges);
}

/// Scores of the features, of the residual as it is, scatter between groups like those of white noise times
/// this: the median over all features.
double ScoreScatter(const std::vector<BankGrams>& banks) {
  std::vector<double> ratios;
  for (const BankGrams& groups : banks) {
    double energy = 0, rows = 0;
    for (const GroupGram& g : groups) {
      const auto residual = g.zz.cols() - 1;
      energy += g.zz(residual, residual);
      rows += g.rows;
    }
    for (Eigen::Index f = 0; f < groups.front().feature_count(); ++f) {
      double scores = 0, features = 0;
      for (const GroupGram& g : groups) {
        const double score = g.fz(f, g.zz.cols() - 1);
        scores += score * score;
        features += g.ff(f, f);
      }
      if (features > 0 && energy > 0) ratios.push_back(scores / features / (energy / rows));
    }
  }
  return std::max(1.0, Median(ratios, 1.0));
}

/// In the first choice all are as they are.
SignChoices SignFlips(int flips, std::size_t groups) {
  std::mt19937_64 random(kFlipSeed);
  Eigen::MatrixXd signs = Eigen::MatrixXd::Ones(static_cast<Eigen::Index>(groups), flips + 1);
  for (double& sign : signs.rightCols(flips).reshaped()) sign = (random() >> 63) != 0 ? 1.0 : -1.0;
  return SignChoices(signs);
}

Predictability Judge(const std::vector<BankGrams>& banks, const std::vector<FeatureBank>& named,
                     const PredictabilityOptions& options) {
  Predictability out;
  const std::size_t groups = banks.front().size();
  const SignChoices signs = SignFlips(options.flips, groups);
  const Eigen::VectorXd plain =
      signs.Energies(BankProblem(banks.front(), false).HeldOut(std::array{0.0}).front());
  Eigen::VectorXd best = Eigen::VectorXd::Zero(plain.size());
  for (std::size_t b = 0; b < banks.size(); ++b) {
    const BankProblem problem(banks[b], true);
    if (problem.features == 0) continue;
    for (const Eigen::MatrixXd& form : problem.HeldOut(kPenalties)) {
      const Eigen::VectorXd share = 1.0 - signs.Energies(form).array() / plain.array();
      if (share[0] > best[0]) out.about = named[b].about;
      best = best.cwiseMax(share);
    }
  }
  double rows = 0;
  for (const GroupGram& g : banks.front()) rows += g.rows;
  out.tested = plain[0] > 0 && best.allFinite();
  out.share = best[0];
  out.energy = rows > 0 ? plain[0] / rows : 0.0;
  const auto null = best.tail(best.size() - 1);
  out.p_value =
      (1.0 + static_cast<double>((null.array() >= best[0]).count())) / static_cast<double>(best.size());
  out.null_share = Quantile(std::vector<double>(null.begin(), null.end()), 0.95, 0.0);
  out.correlation = ScoreScatter(banks);
  return out;
}

}  // namespace

std::vector<Predictability> PredictabilityOf(const ModelStructure& model,
                                             std::span<const StrokeStretches> strokes,
                                             const WindowSamples& window,
                                             std::span<const ExtendedFit* const> fits,
                                             const PredictabilityOptions& options) {
  std::vector<Predictability> out(fits.size());
  const UsedModel used = Used(model, fits);
  const Grouping grouping(strokes.size(), options.groups);
  if (strokes.empty() || grouping.count() < kLeastGroups) return out;
  FeatureBanks banks(used.structure, strokes, window);
  std::vector<std::vector<BankGrams>> grams(
      fits.size(), std::vector<BankGrams>(banks.banks().size(), BankGrams(grouping.count())));
  for (std::size_t s = 0; s < strokes.size(); ++s)
    for (std::size_t part = 0; part < strokes[s].size(); ++part) {
      const FeatureRows& rows = banks.Rows(s, part);
      const std::size_t group = grouping.Of(s, part, strokes[s].size());
      for (std::size_t f = 0; f < fits.size(); ++f) {
        if (used.regressors[f].size() == 0) continue;
        FitRows fit(rows.model, used.regressors[f]);
        if (!fit.finite()) continue;
        for (std::size_t b = 0; b < rows.banks.size(); ++b)
          if (rows.banks[b].means.allFinite())
            fit.AddTo(rows.banks[b], window.level_form ? 0.0 : 1.0, grams[f][b][group]);
      }
    }
  for (std::size_t f = 0; f < fits.size(); ++f) {
    for (BankGrams& groups : grams[f])
      std::erase_if(groups, [](const GroupGram& g) { return g.zz.size() == 0; });
    const bool filled = std::all_of(grams[f].begin(), grams[f].end(), [&](const BankGrams& groups) {
      return groups.size() >= kLeastGroups && groups.size() == grams[f].front().size();
    });
    if (filled) out[f] = Judge(grams[f], banks.banks(), options);
  }
  return out;
}

}  // namespace hydroscope
