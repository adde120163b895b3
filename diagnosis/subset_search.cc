#include "diagnosis/subset_search.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "core/contains.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

/// Share of a column that the others must leave, else it is one of them.
constexpr double kIndependent = 1e-9;

using Members = std::vector<int>;  ///< entries of SubsetScreen, ascending

double StandardErrors(const Eigen::VectorXd& worse) {
  const double n = static_cast<double>(worse.size());
  if (n < 2) return 0;
  const double error = std::sqrt((worse.array() - worse.mean()).square().sum() / (n - 1) / n);
  return error > 0 ? worse.mean() / error : 0;
}

/// An effect in one shape.
struct Entry {
  EffectChoice choice;
  double min = 0, max = 0;  ///< admissible sizes
};

/// A subset solved on the sum of all strokes.
struct Solved {
  Members members;
  double removed = 0;     ///< of the squared error in the integral form, noise taken out
  double flow_error = 0;  ///< squared error in the flow form
};

/// Least squares of any subset, from the Grams of all strokes with the start model projected out.
class SubsetScreen {
 public:
  SubsetScreen(const StrokeSet& strokes, const CandidateModel& start, const std::vector<int>& candidates) {
    const ModelStructure& model = strokes.model();
    std::vector<Eigen::VectorXd> columns;
    for (int c = 0; c < model.base_count; ++c)
      columns.push_back(Eigen::VectorXd::Unit(model.column_count(), c));
    for (const EffectChoice& choice : start.choices)
      columns.push_back(strokes.Direction(choice, start.fit.theta));
    const auto base = static_cast<Eigen::Index>(columns.size());
    for (const int effect : candidates)
      for (const int shape : ShapesFor(model, effect, start.choices)) {
        if (!strokes.Measured({effect, shape})) continue;
        entries_.push_back({{effect, shape}, model.effects[effect]->min, model.effects[effect]->max});
        columns.push_back(strokes.Direction({effect, shape}, start.fit.theta));
      }
    columns.push_back(Eigen::VectorXd::Unit(model.column_count(), model.output_column()));
    Eigen::MatrixXd w(model.column_count(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t c = 0; c < columns.size(); ++c) w.col(static_cast<Eigen::Index>(c)) = columns[c];
    Project(w.transpose() * strokes.Total() * w, w.transpose() * strokes.TotalFlow() * w, base);
  }

  const std::vector<Entry>& entries() const { return entries_; }

  /// nullopt if its columns are not independent or physics forbids a size.
  std::optional<Solved> Solve(const Members& members) const {
    const auto k = static_cast<Eigen::Index>(members.size());
    Eigen::MatrixXd h(k, k), flow(k, k);
    Eigen::VectorXd g(k), flow_g(k), scale(k);
    for (Eigen::Index i = 0; i < k; ++i) {
      if (!(independent_[members[i]] > kIndependent)) return std::nullopt;
      scale[i] = 1 / std::sqrt(h_(members[i], members[i]));
      g[i] = g_[members[i]];
      flow_g[i] = flow_g_[members[i]];
      for (Eigen::Index j = 0; j < k; ++j) {
        h(i, j) = h_(members[i], members[j]);
        flow(i, j) = flow_(members[i], members[j]);
      }
    }
    const SymmetricFactor factor(scale.asDiagonal() * h * scale.asDiagonal());
    if (!(factor.LeastPivot() > kIndependent)) return std::nullopt;
    const Eigen::VectorXd size = scale.asDiagonal() * factor.Solve(scale.asDiagonal() * g);
    for (Eigen::Index i = 0; i < k; ++i)
      if (!(size[i] >= entries_[members[i]].min && size[i] <= entries_[members[i]].max)) return std::nullopt;
    return Solved{members, size.dot(g), flow_0_ - 2 * size.dot(flow_g) + size.dot(flow * size)};
  }

  /// Of one effect, the shapes' entries.
  Members ShapesOf(int effect) const {
    Members out;
    for (std::size_t e = 0; e < entries_.size(); ++e)
      if (entries_[e].choice.effect == effect) out.push_back(static_cast<int>(e));
    return out;
  }

  /// The subset with each member in turn in the shape that suits it best beside the others.
  Members Tuned(Members members) const {
    for (std::size_t i = 0; i < members.size(); ++i) {
      const Members shapes = ShapesOf(entries_[members[i]].choice.effect);
      if (shapes.size() < 2) continue;
      double most = -1;
      int best = members[i];
      for (const int shape : shapes) {
        members[i] = shape;
        const auto solved = Solve(members);
        if (!solved || solved->removed <= most) continue;
        most = solved->removed;
        best = shape;
      }
      members[i] = best;
    }
    return members;
  }

 private:
  /// Takes the first `base` columns and the output (last) out of the rest.
  void Project(const Eigen::MatrixXd& clean, const Eigen::MatrixXd& flow, Eigen::Index base) {
    const Eigen::Index count = clean.rows() - base - 1;
    const Eigen::VectorXd scale = clean.diagonal().head(base).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const SymmetricFactor factor(scale.asDiagonal() * clean.topLeftCorner(base, base) * scale.asDiagonal());
    const Eigen::MatrixXd inside = clean.block(0, base, base, count + 1);
    const Eigen::MatrixXd mimic = scale.asDiagonal() * factor.SolveColumns(scale.asDiagonal() * inside);
    const Eigen::MatrixXd rest = clean.bottomRightCorner(count + 1, count + 1) - inside.transpose() * mimic;
    h_ = rest.topLeftCorner(count, count);
    g_ = rest.col(count).head(count);
    independent_ = h_.diagonal().cwiseQuotient(clean.diagonal().segment(base, count).cwiseMax(1e-300));
    // The error of a model in the flow form, as a function of the added sizes alone.
    Eigen::MatrixXd turn(clean.rows(), count + 1);
    turn << -mimic, Eigen::MatrixXd::Identity(count + 1, count + 1);
    const Eigen::MatrixXd error = turn.transpose() * flow * turn;
    flow_ = error.topLeftCorner(count, count);
    flow_g_ = error.col(count).head(count);
    flow_0_ = error(count, count);
  }

  std::vector<Entry> entries_;
  Eigen::MatrixXd h_, flow_;
  Eigen::VectorXd g_, flow_g_, independent_;
  double flow_0_ = 0;
};

/// All subsets of a size, one after the other.
template <typename Use>
void ForSubsets(const Members& of, int size, Use use) {
  std::vector<int> at(static_cast<std::size_t>(size));
  std::iota(at.begin(), at.end(), 0);
  const int count = static_cast<int>(of.size());
  while (size <= count) {
    Members members;
    for (const int i : at) members.push_back(of[static_cast<std::size_t>(i)]);
    use(members);
    int k = size - 1;
    while (k >= 0 && at[k] == count - size + k) --k;
    if (k < 0) return;
    ++at[k];
    for (int j = k + 1; j < size; ++j) at[j] = at[j - 1] + 1;
  }
}

/// Fits subsets with strokes left out and compares them.
class Subsets {
 public:
  Subsets(const StrokeSet& strokes, const CandidateModel& start, const std::vector<int>& candidates,
          const SubsetOptions& options)
      : strokes_(strokes), start_(start), options_(options), screen_(strokes, start, candidates) {
    for (const int effect : candidates) AddAlone(effect);
    std::stable_sort(alone_.begin(), alone_.end(),
                     [](const Solved& a, const Solved& b) { return a.removed > b.removed; });
    if (static_cast<int>(alone_.size()) > options_.max_candidates) alone_.resize(options_.max_candidates);
  }

  SubsetResult Search() {
    SubsetResult out{start_, {}};
    for (int size = 1; size <= options_.max_effects; ++size) {
      const std::vector<CandidateModel> valid = Valid(size);
      if (valid.empty()) continue;
      const CandidateModel& best = Best(valid);
      if (!Improves(out.best.fit, best.fit)) continue;
      SubsetResult next{best, {}};
      for (const CandidateModel& other : valid)
        if (&other != &best && IsRival(other.fit, best.fit)) next.rivals.push_back(other);
      std::stable_sort(next.rivals.begin(), next.rivals.end(),
                       [](const auto& a, const auto& b) { return a.fit.rms_holdout < b.fit.rms_holdout; });
      out = std::move(next);
    }
    return out;
  }

 private:
  /// The effect in the shape that suits it best alone; in the first, if physics forbids it alone.
  void AddAlone(int effect) {
    std::optional<Solved> best;
    const Members shapes = screen_.ShapesOf(effect);
    for (const int shape : shapes)
      if (const auto solved = screen_.Solve({shape}); solved && (!best || solved->removed > best->removed))
        best = solved;
    if (!shapes.empty()) alone_.push_back(best.value_or(Solved{{shapes.front()}, 0, 0}));
  }

  /// Subsets of a size that promise most, by either error.
  std::vector<Members> Promising(int size) const {
    Members of;
    for (const Solved& one : alone_) of.push_back(one.members.front());
    std::vector<Solved> solved;
    ForSubsets(of, size, [&](const Members& members) {
      if (auto one = screen_.Solve(members)) solved.push_back(std::move(*one));
    });
    std::vector<Members> out;
    const auto take = [&](auto less) {
      const auto count = std::min(solved.size(), static_cast<std::size_t>(options_.fitted));
      std::partial_sort(solved.begin(), solved.begin() + static_cast<std::ptrdiff_t>(count), solved.end(),
                        less);
      for (std::size_t k = 0; k < count; ++k) {
        const Members tuned = screen_.Tuned(solved[k].members);
        if (!Contains(out, tuned)) out.push_back(tuned);
      }
    };
    take([](const Solved& a, const Solved& b) { return a.removed > b.removed; });
    take([](const Solved& a, const Solved& b) { return a.flow_error < b.flow_error; });
    return out;
  }

  const ExtendedFit& Fit(Members members) {
    std::sort(members.begin(), members.end());
    if (members.empty()) return start_.fit;
    const auto known = fits_.find(members);
    if (known != fits_.end()) return known->second;
    return fits_.emplace(members, strokes_.Fit(Choices(members))).first->second;
  }

  std::vector<EffectChoice> Choices(const Members& members) const {
    std::vector<EffectChoice> choices = start_.choices;
    for (const int m : members) choices.push_back(screen_.entries()[m].choice);
    return choices;
  }

  /// The added effects have sizes beyond `t` standard errors by strokes.
  bool AreSeen(const ExtendedFit& fit, double t) const {
    const double student = strokes_.student();
    return std::all_of(fit.effects.begin() + static_cast<std::ptrdiff_t>(start_.choices.size()),
                       fit.effects.end(),
                       [&](const EffectEstimate& e) { return std::abs(e.size) > t * e.std / student; });
  }

  /// Every effect is seen, and its going raises the error on strokes left out.
  bool EveryEffectCounts(const Members& members, const ExtendedFit& fit) {
    if (!fit.solved || !AreSeen(fit, options_.min_t)) return false;
    for (const EffectEstimate& e : fit.effects)
      if (!e.admissible) return false;
    for (std::size_t k = 0; k < members.size(); ++k) {
      Members rest = members;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
      const ExtendedFit& without = Fit(rest);
      if (without.solved && without.rms_holdout <= fit.rms_holdout) return false;
    }
    return true;
  }

  std::vector<CandidateModel> Valid(int size) {
    std::vector<CandidateModel> valid;
    for (const Members& members : Promising(size)) {
      const ExtendedFit fit = Fit(members);
      Members sorted = members;
      std::sort(sorted.begin(), sorted.end());
      if (EveryEffectCounts(sorted, fit)) valid.push_back({Choices(sorted), fit});
    }
    return valid;
  }

  /// Of those whose error in the units shown is not clearly worse than the least, and whose error with the
  /// noise taken out is not clearly worse than the least of these, the one that errs least.
  const CandidateModel& Best(const std::vector<CandidateModel>& valid) const {
    const auto rms = [](const CandidateModel* a, const CandidateModel* b) {
      return a->fit.rms_holdout < b->fit.rms_holdout;
    };
    const auto excess = [](const CandidateModel* a, const CandidateModel* b) {
      return a->fit.excess_ratio < b->fit.excess_ratio;
    };
    std::vector<const CandidateModel*> pool;
    for (const CandidateModel& v : valid) pool.push_back(&v);
    const CandidateModel* least = *std::min_element(pool.begin(), pool.end(), rms);
    std::erase_if(pool, [&](const CandidateModel* v) {
      return StandardErrors(WorseInFlow(v->fit, least->fit)) > options_.better_t ||
             IsFarWorse(v->fit, least->fit);
    });
    const CandidateModel* cleanest = *std::min_element(pool.begin(), pool.end(), excess);
    std::erase_if(pool, [&](const CandidateModel* v) {
      return StandardErrors(Worse(v->fit, cleanest->fit)) > options_.better_t;
    });
    least = *std::min_element(pool.begin(), pool.end(), rms);
    const bool same = cleanest->fit.rms_holdout <= (1 + kSameError) * least->fit.rms_holdout;
    return same ? *cleanest : *least;
  }

  bool Improves(const ExtendedFit& from, const ExtendedFit& to) const {
    if (!(to.rms_holdout < from.rms_holdout)) return false;
    const double gain = Worse(from, to).sum() / from.noise_variance;
    if (gain < options_.min_gain) return false;
    if (from.excess_ratio - to.excess_ratio < options_.min_share * std::max(0.0, from.excess_ratio))
      return false;
    return AreSeen(to, options_.sure_t) || IsClearlyWorse(from, to);
  }

  bool IsRival(const ExtendedFit& other, const ExtendedFit& best) const {
    const Eigen::VectorXd worse = Worse(other, best);
    const double unit = best.noise_variance * (1 + std::max(0.0, best.excess_ratio));
    if (worse.sum() < options_.rival_gain * unit) return true;
    return !IsClearlyWorse(other, best);
  }

  /// By so much that no scatter over the strokes matters: a few strokes that err most may make it large.
  bool IsFarWorse(const ExtendedFit& a, const ExtendedFit& b) const {
    return a.rms_holdout > options_.far_worse * b.rms_holdout &&
           Worse(a, b).sum() > options_.min_gain * b.noise_variance;
  }

  bool IsClearlyWorse(const ExtendedFit& a, const ExtendedFit& b) const {
    return StandardErrors(Worse(a, b)) > options_.better_t ||
           StandardErrors(WorseInFlow(a, b)) > options_.better_t || IsFarWorse(a, b);
  }

  const StrokeSet& strokes_;
  const CandidateModel& start_;
  const SubsetOptions& options_;
  SubsetScreen screen_;
  std::vector<Solved> alone_;
  std::map<Members, ExtendedFit> fits_;
};

}  // namespace

SubsetResult SearchSubsets(const StrokeSet& strokes, const CandidateModel& start,
                           const std::vector<int>& candidates, const SubsetOptions& options) {
  if (!start.fit.solved || candidates.empty()) return {start, {}};
  return Subsets(strokes, start, candidates, options).Search();
}

}  // namespace hydroscope
