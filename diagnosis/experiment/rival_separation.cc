#include "diagnosis/experiment/rival_separation.h"

#include <algorithm>
#include <numeric>

#include "core/contains.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/sample_grams.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

std::vector<int> IndicesOf(const ModelStructure& model, const std::vector<std::string>& ids) {
  std::vector<int> indices;
  for (const std::string& id : ids)
    for (std::size_t e = 0; e < model.effects.size(); ++e)
      if (model.effects[e]->id == id) indices.push_back(static_cast<int>(e));
  return indices;
}

/// Effects that are no rivals now, but that explain so much that they could be after an experiment that does
/// not tell them apart either.
std::vector<int> WatchedOf(const Explanation& explanation) {
  std::vector<int> watched;
  if (explanation.groups.size() != 1) return watched;
  const auto& group = explanation.groups.front();
  for (const RankedEffect& r : explanation.ranking)
    if (r.fit.solved && r.gain > kExperiment.watched * explanation.ranking.front().gain &&
        !Contains(group, r.id))
      watched.push_back(r.effect);
  return watched;
}

/// The first `known` columns and column `other`, at whatever sizes, from the products of all columns.
class TakenOver {
 public:
  TakenOver(const Eigen::MatrixXd& products, Eigen::Index known, Eigen::Index other)
      : products_(products), regressors_(static_cast<std::size_t>(known) + 1, other) {
    std::iota(regressors_.begin(), regressors_.end() - 1, Eigen::Index{0});
    const Eigen::MatrixXd h = products_(regressors_, regressors_);
    scale_ = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    inverse_ = PseudoInverse(scale_.asDiagonal() * h * scale_.asDiagonal());
  }
  /// Energy of column `own` that they cannot take over.
  double LeavesOf(Eigen::Index own) const {
    const Eigen::VectorXd cross = scale_.asDiagonal() * products_(regressors_, own);
    return std::max(0.0, products_(own, own) - cross.dot(inverse_ * cross));
  }

 private:
  const Eigen::MatrixXd& products_;
  std::vector<Eigen::Index> regressors_;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd inverse_;
};

}  // namespace

std::vector<std::size_t> OpenGroups(const Explanation& explanation) {
  std::vector<std::size_t> open;
  for (std::size_t g = 0; g < explanation.groups.size(); ++g)
    if (explanation.groups[g].size() > 1) open.push_back(g);
  return open;
}

RivalModel RivalModelOf(const Explanation& explanation) {
  const std::vector<std::size_t> open = OpenGroups(explanation);
  return RivalModelOf(explanation, open.empty() ? explanation.groups.size() : open.front());
}

RivalModel RivalModelOf(const Explanation& explanation, std::size_t group) {
  const std::vector<std::string> ids =
      group < explanation.groups.size() ? explanation.groups[group] : std::vector<std::string>();
  RivalModel out{std::make_shared<ModelStructure>(*explanation.model),
                 IndicesOf(*explanation.model, ids),
                 WatchedOf(explanation),
                 {}};
  ModelStructure& structure = *out.structure;
  structure.columns.resize(structure.output_column() + 1);
  for (auto& shapes : structure.effect_shapes) shapes.clear();
  for (const auto& effects : {out.rivals, out.watched})
    for (const int effect : effects)
      for (const EffectShape& shape : explanation.model->effect_shapes[effect])
        AddShape(structure, effect, shape.nonlinear, shape.on);
  for (const EffectChoice& choice : explanation.chosen) {
    if (Contains(out.rivals, choice.effect)) continue;
    const EffectShape& shape = explanation.model->effect_shapes[choice.effect][choice.shape];
    AddShape(structure, choice.effect, shape.nonlinear, shape.on);
    out.others.push_back({choice.effect, 0});
  }
  return out;
}

RivalEvidence& RivalEvidence::Add(const RivalEvidence& other, double times) {
  total =
      total.size() == 0 ? Eigen::MatrixXd(times * other.total) : Eigen::MatrixXd(total + times * other.total);
  noise += times * other.noise;
  equations += times * other.equations;
  return *this;
}

RivalEvidence EvidenceOf(const RivalModel& model, const Eigen::VectorXd& theta, std::vector<StrokeGram> grams,
                         const WindowSamples& window) {
  RivalEvidence out;
  out.noise = NoiseEnergy(theta, grams);
  for (const StrokeGram& gram : grams) out.equations += static_cast<double>(gram.blocks - gram.spans);
  out.total = StrokeSet(model.structure, std::move(grams), window).Total();
  return out;
}

RivalEvidence EvidenceOf(const RivalModel& model, const Eigen::VectorXd& theta,
                         std::span<const StrokeStretches> strokes, const WindowSamples& window) {
  return EvidenceOf(model, theta, GramsOf(model.structure, strokes, window), window);
}

double NoiseEnergy(const Eigen::VectorXd& theta, std::span<const StrokeGram> grams) {
  Eigen::VectorXd balance(theta.size() + 1);
  balance << -theta, 1;
  double energy = 0;
  for (const StrokeGram& gram : grams) {
    const Eigen::MatrixXd noise = Unpacked(gram.noise).topLeftCorner(balance.size(), balance.size());
    energy += balance.dot(noise * balance);
  }
  return energy;
}

Rivals::Rivals(const RivalModel& model, const StrokeSet& recorded) {
  const int base = model.structure->base_count;
  const auto others = static_cast<Eigen::Index>(model.others.size());
  known_ = Eigen::MatrixXd::Identity(model.structure->column_count(), base + others);
  for (const std::vector<int>* effects : {&model.rivals, &model.watched}) {
    for (const int effect : *effects) {
      std::vector<EffectChoice> choices = model.others;
      choices.push_back(recorded.BestShape(effect, model.others));
      if (choices.back().shape < 0) continue;
      const ExtendedFit fit = recorded.Fit(choices);
      const auto direction = [&](std::size_t k) {
        Eigen::VectorXd at(base + 1);
        at << fit.theta.head(base), fit.effects[k].size;
        return recorded.Direction(choices[k], at);
      };
      unit_.push_back(direction(model.others.size()));
      ids_.push_back(model.structure->effects[effect]->id);
      if (effects != &model.rivals) continue;
      for (std::size_t k = 0; k < model.others.size(); ++k)
        known_.col(base + static_cast<Eigen::Index>(k)) = direction(k);
      fitted_.push_back(unit_.back() * fit.effects.back().size);
    }
  }
  if (fitted_.size() < 2) return;
  for (std::size_t a = 0; a < fitted_.size(); ++a)
    for (std::size_t b = 0; b < unit_.size(); ++b)
      if (a != b) {
        const Effect::Twin* const twin = FindTwin(*model.structure, ids_[a], ids_[b]);
        const bool weaker = twin != nullptr && twin->share < 1;
        pairs_.push_back({a, b, weaker ? kExperiment.twins_apart * twin->excess : 0.0, b >= fitted_.size()});
      }
}

std::vector<double> Rivals::Separations(const RivalEvidence& evidence) const {
  // Columns: what is known, rivals at their sizes, rivals and watched effects at size one.
  const Eigen::Index known = known_.cols(), fitted = known + static_cast<Eigen::Index>(fitted_.size());
  Eigen::MatrixXd columns(known_.rows(), fitted + static_cast<Eigen::Index>(unit_.size()));
  columns.leftCols(known) = known_;
  for (std::size_t k = 0; k < fitted_.size(); ++k)
    columns.col(known + static_cast<Eigen::Index>(k)) = fitted_[k];
  for (std::size_t k = 0; k < unit_.size(); ++k)
    columns.col(fitted + static_cast<Eigen::Index>(k)) = unit_[k];
  const Eigen::MatrixXd products = columns.transpose() * (evidence.total * columns);
  std::vector<TakenOver> taken_over;
  for (std::size_t k = 0; k < unit_.size(); ++k)
    taken_over.emplace_back(products, known, fitted + static_cast<Eigen::Index>(k));
  std::vector<double> out;
  for (const Pair& pair : pairs_) {
    const double energy = taken_over[pair.b].LeavesOf(known + static_cast<Eigen::Index>(pair.a)) *
                          evidence.equations / evidence.noise;
    const double apart = pair.apart * evidence.equations;
    const double weight = pair.apart > 0 ? kExperiment.settled / std::max(apart, kExperiment.settled)
                                         : (pair.watched ? kExperiment.watched_weight : 1);
    out.push_back(energy * weight);
  }
  return out;
}

double Rivals::Nearest(const RivalEvidence& evidence) const {
  if (pairs_.empty()) return 0;
  const std::vector<double> separations = Separations(evidence);
  return *std::min_element(separations.begin(), separations.end());
}

int StrokesToSettle(int most, const std::function<double(int)>& separation) {
  if (separation(most) < kExperiment.settled) return most;
  int enough = most;
  for (int few = kExperiment.fewest_strokes - 1; enough - few > 1;) {
    const int middle = (few + enough) / 2;
    (separation(middle) < kExperiment.settled ? few : enough) = middle;
  }
  return enough;
}

}  // namespace hydroscope
