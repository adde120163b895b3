#include "diagnosis/closed_loop/change.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/distributions.h"
#include "core/non_negative.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMoreThanAnySet = 100;
/// Parameters that are not known vary by this much: a factor of e^30.
constexpr double kUnknownStd = 30;
/// Times that chords of changes that are no straight lines are drawn anew.
constexpr int kChords = 4;
/// Reciprocal condition of scaled normal equations below which directions are one: those that are differ by rounding alone.
constexpr double kIndependentDirections = 1e-9;

double ChanceOfMore(double chi_squared, int dof) {
  if (dof <= 0) return chi_squared > 0 ? 0 : 1;
  if (!std::isfinite(chi_squared)) return 0;
  return ChiSquaredAbove(std::max(0.0, chi_squared), dof);
}

bool IsDelay(const LoopParameter& parameter) { return parameter.kind == LoopParameter::Kind::kDelay; }

/// Whether the gain changed its sign. No change of the plant does that.
bool Reversed(const ClosedLoopPlant& plant, const LoopState& before, const LoopState& after) {
  for (std::size_t k = 0; k < plant.parameters.size(); ++k)
    if (plant.parameters[k].kind == LoopParameter::Kind::kGain &&
        after.parameters[k] * before.parameters[k] < 0)
      return true;
  return false;
}

/// What the parameters moved by, and the covariance of that.
struct Movement {
  VectorXd by;
  MatrixXd weight;           // inverse covariance
  std::vector<double> from;  // SI
};

Movement MovementOf(const ClosedLoopPlant& plant, const LoopState& before, const LoopState& after) {
  const auto count = static_cast<std::ptrdiff_t>(plant.parameters.size());
  Movement movement{VectorXd(count), MatrixXd(), before.parameters};
  MatrixXd covariance = before.covariance + after.covariance;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (IsDelay(plant.parameters[k])) {
      movement.by(i) = after.parameters[k] - before.parameters[k];
    } else {
      movement.by(i) = std::log(std::abs(after.parameters[k] / before.parameters[k]));
      covariance(i, i) += 2 * plant.repeatability * plant.repeatability;
    }
    if (!std::isfinite(movement.by(i))) {
      movement.by(i) = 0;
      covariance(i, i) += kUnknownStd * kUnknownStd;
    }
  }
  const VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  movement.weight =
      scale.asDiagonal() * Inverse(scale.asDiagonal() * covariance * scale.asDiagonal()) * scale.asDiagonal();
  return movement;
}

/// NaN where the directions are not independent: the same movement can be shared out among them in many ways.
MatrixXd InverseOf(const MatrixXd& normal) {
  const VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::FullPivLU<MatrixXd> scaled(scale.asDiagonal() * normal * scale.asDiagonal());
  if (scaled.rcond() < kIndependentDirections) return MatrixXd::Constant(normal.rows(), normal.cols(), kNaN);
  return scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
}

/// A column for each change of a set, for the sizes that they have.
MatrixXd DirectionsOf(const Movement& movement, const LoopChangeSet& set) {
  MatrixXd directions(movement.by.size(), static_cast<std::ptrdiff_t>(set.changes.size()));
  for (std::size_t k = 0; k < set.changes.size(); ++k) {
    auto column = directions.col(static_cast<std::ptrdiff_t>(k));
    const SizedChange& sized = set.changes[k];
    if (sized.change->chord != nullptr)
      sized.change->chord(movement.from, std::isfinite(sized.size) ? sized.size : 0,
                          {column.data(), static_cast<std::size_t>(column.size())});
    else
      column = Eigen::Map<const VectorXd>(sized.change->direction.data(), movement.by.size());
  }
  return directions;
}

LoopChangeSet FitChanges(const Movement& movement, const std::vector<const LoopChange*>& changes) {
  LoopChangeSet set;
  set.degrees_of_freedom = static_cast<int>(movement.by.size()) - static_cast<int>(changes.size());
  VectorXd left = movement.by;
  bool bent = false;
  for (const LoopChange* change : changes) {
    set.changes.push_back({change, 0, 0});
    bent = bent || change->chord != nullptr;
  }
  for (int pass = 0; !changes.empty() && pass < (bent ? kChords : 1); ++pass) {
    const MatrixXd directions = DirectionsOf(movement, set);
    const MatrixXd normal = directions.transpose() * movement.weight * directions;
    const MatrixXd covariance = InverseOf(normal);
    const VectorXd sizes = covariance * (directions.transpose() * movement.weight * movement.by);
    for (std::size_t k = 0; k < changes.size(); ++k) {
      const auto at = static_cast<std::ptrdiff_t>(k);
      set.changes[k].size = sizes(at);
      set.changes[k].std = std::sqrt(NonNegative(covariance(at, at)));
    }
    left = movement.by - directions * sizes;
  }
  set.chi_squared = left.dot(movement.weight * left);
  set.p_value = ChanceOfMore(set.chi_squared, set.degrees_of_freedom);
  return set;
}

/// Every member has an effect, and the sign that it can have.
bool Possible(const LoopChangeSet& set, double least_p) {
  return std::all_of(set.changes.begin(), set.changes.end(), [&](const SizedChange& c) {
    const double squared = c.size * c.size / (c.std * c.std);
    return std::isfinite(c.size) && c.std > 0 && c.size * c.change->sign >= 0 &&
           ChanceOfMore(squared, 1) < least_p;
  });
}

/// All sets of `size` changes that are possible, best first.
std::vector<LoopChangeSet> SetsOf(const ClosedLoopPlant& plant, const Movement& movement, std::size_t size,
                                  double least_p) {
  std::vector<LoopChangeSet> sets;
  std::vector<bool> taken(plant.changes.size(), false);
  std::fill_n(taken.begin(), std::min(size, taken.size()), true);
  do {
    std::vector<const LoopChange*> changes;
    for (std::size_t k = 0; k < taken.size(); ++k)
      if (taken[k]) changes.push_back(&plant.changes[k]);
    LoopChangeSet set = FitChanges(movement, changes);
    if (Possible(set, least_p)) sets.push_back(std::move(set));
  } while (std::prev_permutation(taken.begin(), taken.end()));
  std::sort(sets.begin(), sets.end(),
            [](const auto& a, const auto& b) { return a.chi_squared < b.chi_squared; });
  return sets;
}

/// Whether no change of one is in the other.
bool Apart(const LoopChangeSet& a, const LoopChangeSet& b) {
  return std::none_of(a.changes.begin(), a.changes.end(), [&](const SizedChange& mine) {
    return std::any_of(b.changes.begin(), b.changes.end(),
                       [&](const SizedChange& theirs) { return theirs.change == mine.change; });
  });
}

/// Whether nothing is left beyond chance, neither over all parameters nor in the direction of any change: what is left over all
/// of them drowns a single sharp one. Of so many directions one is the likelier to stand out by chance.
bool NothingChanged(const Movement& movement, const LoopComparisonOptions& options,
                    const LoopComparison& comparison) {
  const double each = options.least_p / static_cast<double>(comparison.plant->changes.size());
  return comparison.nothing.p_value >= options.least_p &&
         SetsOf(*comparison.plant, movement, 1, each).empty();
}

/// The smallest set that suffices, those that do as well, and those of one change more whose parts make up the same movement.
void FindSet(const Movement& movement, const LoopComparisonOptions& options, LoopComparison& comparison) {
  if (NothingChanged(movement, options, comparison)) {
    comparison.verdict = LoopComparison::Verdict::kAdequate;
    comparison.set = comparison.nothing;
    return;
  }
  for (std::size_t size = 1; size <= options.most; ++size) {
    std::vector<LoopChangeSet> sets = SetsOf(*comparison.plant, movement, size, options.least_p);
    if (!sets.empty() &&
        (comparison.set.changes.empty() || sets.front().chi_squared < comparison.set.chi_squared))
      comparison.set = sets.front();
    if (sets.empty() || sets.front().p_value < options.least_p) continue;
    for (std::size_t k = 1; k < sets.size(); ++k)
      if (sets[k].p_value >= options.least_p &&
          sets[k].chi_squared < sets.front().chi_squared + options.as_good)
        comparison.others.push_back(sets[k]);
    for (LoopChangeSet& larger : SetsOf(*comparison.plant, movement, size + 1, options.least_p))
      if (Apart(larger, comparison.set) && larger.p_value >= options.least_p &&
          larger.chi_squared < comparison.set.chi_squared + options.as_good)
        comparison.imitators.push_back(std::move(larger));
    comparison.verdict =
        comparison.others.empty() ? LoopComparison::Verdict::kNamed : LoopComparison::Verdict::kAmbiguous;
    return;
  }
  comparison.verdict = LoopComparison::Verdict::kUnknown;
}

/// What a change alone must be to stand out (NothingChanged), where that is large.
std::vector<SizedChange> Unseen(const LoopComparison& comparison, const LoopComparisonOptions& options) {
  const double each = options.least_p / static_cast<double>(comparison.plant->changes.size());
  const double beyond = std::sqrt(ChiSquaredQuantile(1 - each, 1));
  std::vector<SizedChange> unseen;
  for (const LoopChangeSet& single : comparison.singles) {
    SizedChange change = single.changes.front();
    double large = std::log1p(options.large);
    for (std::size_t i = 0; i < comparison.plant->parameters.size(); ++i)
      if (IsDelay(comparison.plant->parameters[i]) && change.change->direction[i] != 0)
        large = comparison.plant->parameters[i].scale;
    change.size = (change.change->sign < 0 ? -1 : 1) * beyond * change.std;
    if (!(std::abs(change.size) < large)) unseen.push_back(change);
  }
  return unseen;
}

LoopComparison CompareOneWay(const ClosedLoopPlant& plant, const LoopState& before, const LoopState& after,
                             const LoopComparisonOptions& options) {
  LoopComparison comparison;
  comparison.plant = &plant;
  comparison.before = before;
  comparison.after = after;
  const Movement movement = MovementOf(plant, before, after);
  comparison.nothing = FitChanges(movement, {});
  for (const LoopChange& change : plant.changes)
    comparison.singles.push_back(FitChanges(movement, {&change}));
  std::sort(comparison.singles.begin(), comparison.singles.end(),
            [](const auto& a, const auto& b) { return a.chi_squared < b.chi_squared; });
  FindSet(movement, options, comparison);
  if (comparison.verdict == LoopComparison::Verdict::kAdequate)
    comparison.unseen = Unseen(comparison, options);
  return comparison;
}

/// Gain and delay alone.
LoopState WithoutPoles(const ClosedLoopPlant& plant, LoopState state) {
  for (std::size_t k = 0; k < plant.parameters.size(); ++k)
    if (plant.parameters[k].kind == LoopParameter::Kind::kPositive) state.parameters[k] = kNaN;
  return state;
}

LoopComparison CompareWithoutPoles(const ClosedLoopPlant& plant, const LoopState& before,
                                   const LoopState& after, const LoopComparisonOptions& options) {
  LoopComparison comparison =
      CompareOneWay(plant, WithoutPoles(plant, before), WithoutPoles(plant, after), options);
  comparison.before = before;
  comparison.after = after;
  comparison.poles_unknown = true;
  return comparison;
}

/// Fewer changes are better, then a smaller remainder.
bool Simpler(const LoopComparison& a, const LoopComparison& b) {
  const auto rank = [](const LoopComparison& c) {
    return c.verdict == LoopComparison::Verdict::kUnknown ? kMoreThanAnySet : c.set.changes.size();
  };
  return rank(a) != rank(b) ? rank(a) < rank(b) : a.set.chi_squared < b.set.chi_squared;
}

}  // namespace

const char* VerdictName(LoopComparison::Verdict verdict) {
  switch (verdict) {
    case LoopComparison::Verdict::kAdequate:
      return "adequate";
    case LoopComparison::Verdict::kNamed:
      return "named";
    case LoopComparison::Verdict::kAmbiguous:
      return "ambiguous";
    case LoopComparison::Verdict::kUnknown:
      return "unknown";
  }
  return "";
}

LoopState StateOf(const LoopResponse& response) {
  LoopState state{*response.fit, response};
  state.covariance *= response.fit->Widening() * response.fit->Widening();
  return state;
}

LoopComparison CompareLoopStates(const ClosedLoopPlant& plant, const LoopState& before,
                                 const LoopState& after, const LoopComparisonOptions& options) {
  if (Reversed(plant, before, after)) {
    LoopComparison comparison;
    comparison.plant = &plant;
    comparison.verdict = LoopComparison::Verdict::kUnknown;
    comparison.reversed = true;
    comparison.before = before;
    comparison.after = after;
    return comparison;
  }
  const bool poles_known = KnownOneByOne(plant, before) && KnownOneByOne(plant, after);
  LoopComparison comparison = poles_known ? CompareOneWay(plant, before, after, options)
                                          : CompareWithoutPoles(plant, before, after, options);
  for (int way = 0; poles_known && way < plant.ways; ++way) {
    const auto other = SharedOut(plant, after, way);
    if (!other || !KnownOneByOne(plant, *other)) continue;
    LoopComparison compared = CompareOneWay(plant, before, {*other, after}, options);
    if (Simpler(compared, comparison)) comparison = std::move(compared);
  }
  comparison.limit_appeared = after.input_limit && !before.input_limit;
  comparison.limit_went = before.input_limit && !after.input_limit;
  if ((comparison.limit_appeared || comparison.limit_went) &&
      comparison.verdict == LoopComparison::Verdict::kAdequate)
    comparison.verdict = LoopComparison::Verdict::kNamed;
  if (comparison.poles_unknown && comparison.verdict == LoopComparison::Verdict::kAdequate)
    comparison.verdict = LoopComparison::Verdict::kUnknown;
  comparison.dead_band = after.dead_band.has_value() != before.dead_band.has_value();
  comparison.readings_end = after.readings_end.has_value() != before.readings_end.has_value() &&
                            comparison.verdict != LoopComparison::Verdict::kAdequate;
  if (comparison.dead_band || comparison.readings_end) {
    comparison.verdict = LoopComparison::Verdict::kUnknown;
    comparison.others.clear();
    comparison.imitators.clear();
  }
  return comparison;
}

}  // namespace hydroscope
