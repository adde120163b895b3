#include "diagnosis/drift/change_analysis.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/contains.h"
#include "core/non_negative.h"
#include "core/quantile.h"
#include "diagnosis/drift/drift_thresholds.h"
#include "estimation/decompositions.h"

namespace hydroscope::drift {
namespace {

constexpr double kInterval = 1.92;  ///< half of the 95 % point of chi-squared with one degree of freedom

struct Sums {
  Eigen::VectorXd score;
  Eigen::MatrixXd information;

  void Add(const Eigen::VectorXd& s, const Eigen::MatrixXd& j) {
    if (score.size() == 0) {
      score = s;
      information = j;
    } else {
      score += s;
      information += j;
    }
  }
};

/// The sums with an error of the reference integrated out that all their strokes share: what it would explain
/// as well no longer speaks for any quantity. With U = diag(J)^(1/2), C = U^-1 J U^-1 the scores U^-1 s
/// scatter by C + `error`, and
///   s' = U C (C + error)^-1 U^-1 s,   J' = U C (C + error)^-1 C U
/// are those of generalised least squares (Aitken 1936).
Sums WithoutError(const Sums& sums, const auto& error) {
  constexpr double kRounding = 1e-12;
  const Eigen::VectorXd unit = sums.information.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::MatrixXd c =
      unit.cwiseInverse().asDiagonal() * sums.information * unit.cwiseInverse().asDiagonal();
  Eigen::MatrixXd v = c + error(c, unit);
  v.diagonal() *= 1 + kRounding;
  const Eigen::MatrixXd weight = SymmetricFactor(v).SolveColumns(c);
  const Eigen::MatrixXd left = c * weight;
  return {unit.cwiseProduct(weight.transpose() * sums.score.cwiseQuotient(unit)),
          unit.asDiagonal() * (0.5 * (left + left.transpose())) * unit.asDiagonal()};
}

constexpr double kMostDoubt = 1e4;  ///< std of an error over the std of a size, against overflow

/// Offsets of a class are medians of strokes like these: their errors (`doubt`, SI, each quantity alone) are
/// correlated as the strokes' scores are. What these strokes hardly tell apart the offsets do not know either.
Sums WithoutOffsetError(const Sums& sums, const Eigen::VectorXd& doubt) {
  return WithoutError(sums, [&](const Eigen::MatrixXd& c, const Eigen::VectorXd& unit) -> Eigen::MatrixXd {
    const Eigen::VectorXd r = doubt.cwiseProduct(unit).cwiseMin(kMostDoubt);
    return r.asDiagonal() * c * r.asDiagonal();
  });
}

/// A curve, or a class's dependence on the oil, that errs (`doubt`, SI) shifts its own quantity.
Sums WithoutShift(const Sums& sums, const Eigen::VectorXd& doubt) {
  return WithoutError(sums, [&](const Eigen::MatrixXd& c, const Eigen::VectorXd& unit) -> Eigen::MatrixXd {
    const Eigen::VectorXd r = doubt.cwiseProduct(unit).cwiseMin(kMostDoubt);
    return c * r.cwiseAbs2().asDiagonal() * c;
  });
}

/// Weights of strokes against single bad ones: those of a t distribution about the shift that all of them
/// show (Lange, Little and Taylor 1989), with their misfit in units of its median.
std::vector<double> RobustWeights(const std::vector<const JudgedStroke*>& strokes) {
  constexpr double kDegrees = 4;  ///< of freedom
  constexpr int kIterations = 5;
  constexpr double kRounding = 1e-9;
  const auto n = strokes.front()->score.size();
  std::vector<double> weights(strokes.size(), 1.0), misfits(strokes.size());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Sums all;
    for (std::size_t k = 0; k < strokes.size(); ++k)
      all.Add(weights[k] * strokes[k]->score, weights[k] * strokes[k]->information);
    const Eigen::VectorXd unit = all.information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const auto solve = [&](const Eigen::MatrixXd& j, const Eigen::VectorXd& s) -> Eigen::VectorXd {
      Eigen::MatrixXd scaled = unit.asDiagonal() * j * unit.asDiagonal();
      scaled.diagonal() *= 1 + kRounding;
      return unit.cwiseProduct(SymmetricFactor(scaled).Solve(unit.cwiseProduct(s)));
    };
    const Eigen::VectorXd shift = solve(all.information, all.score);
    for (std::size_t k = 0; k < strokes.size(); ++k) {
      const Eigen::VectorXd rest = strokes[k]->score - strokes[k]->information * shift;
      misfits[k] = NonNegative(rest.dot(solve(strokes[k]->information, rest)));
    }
    const double typical = std::max(Median(misfits, 0), 1e-300) / static_cast<double>(n);
    for (std::size_t k = 0; k < strokes.size(); ++k)
      weights[k] = std::min(1.0, (kDegrees + static_cast<double>(n)) / (kDegrees + misfits[k] / typical));
  }
  return weights;
}

/// Strokes after `last_before`, each operating class relieved of its own error, then all of the curves'.
Sums SumAfter(const std::deque<JudgedStroke>& strokes, std::int64_t last_before,
              const Eigen::VectorXd& curve_doubt) {
  std::vector<const JudgedStroke*> after;
  for (const JudgedStroke& s : strokes)
    if (s.sequence > last_before) after.push_back(&s);
  if (after.empty()) return {};
  struct OfClass {
    Sums sums;
    Eigen::VectorXd offset, outside;  ///< doubts
  };
  std::map<int, OfClass> classes;
  const std::vector<double> weights = RobustWeights(after);
  for (std::size_t k = 0; k < after.size(); ++k) {
    OfClass& own = classes[after[k]->operating_class];
    const bool first = own.sums.score.size() == 0;
    own.offset = first ? after[k]->offset_doubt : own.offset.cwiseMax(after[k]->offset_doubt).eval();
    own.outside = first ? after[k]->outside_doubt : own.outside.cwiseMax(after[k]->outside_doubt).eval();
    own.sums.Add(weights[k] * after[k]->score, weights[k] * after[k]->information);
  }
  Sums all;
  for (const auto& [index, own] : classes) {
    const Sums left = WithoutShift(WithoutOffsetError(own.sums, own.offset), own.outside);
    all.Add(left.score, left.information);
  }
  return WithoutShift(all, curve_doubt);
}

/// Log-likelihood that shifts of `moved` together gain; 0 if a size has a sign that cannot be, or if they
/// cannot be told apart.
double Gain(const Sums& sums, const std::vector<int>& moved, const std::vector<DriftSize>& sizes) {
  double gain = 0;
  for (const Moved& m : FitTogether(sums.score, sums.information, moved)) {
    if (sizes[m.quantity].only_upwards && m.size < 0) return 0;
    if (m.std * m.std * sums.information(m.quantity, m.quantity) > kDriftThresholds.most_inflation) return 0;
    gain += 0.5 * m.size * sums.score[m.quantity];
  }
  return gain;
}

}  // namespace

std::vector<Moved> FitTogether(const Eigen::VectorXd& score, const Eigen::MatrixXd& information,
                               const std::vector<int>& moved) {
  const auto n = static_cast<Eigen::Index>(moved.size());
  Eigen::VectorXd scale(n), s(n);
  for (Eigen::Index i = 0; i < n; ++i)
    scale[i] = 1.0 / std::sqrt(std::max(information(moved[i], moved[i]), 1e-300));
  Eigen::MatrixXd h(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    s[i] = score[moved[i]] * scale[i];
    for (Eigen::Index j = 0; j < n; ++j) h(i, j) = information(moved[i], moved[j]) * scale[i] * scale[j];
  }
  const Eigen::MatrixXd inverse = PseudoInverse(h);
  const Eigen::VectorXd size = inverse * s;
  std::vector<Moved> fitted;
  for (Eigen::Index i = 0; i < n; ++i)
    fitted.push_back({moved[i], size[i] * scale[i], std::sqrt(NonNegative(inverse(i, i))) * scale[i]});
  return fitted;
}

ChangeTime FindChangeTime(const std::deque<JudgedStroke>& strokes, int quantity) {
  ChangeTime change;
  std::vector<double> likelihood(strokes.size(), 0.0);
  double score = 0, information = 0, best = -1;
  for (std::size_t k = strokes.size(); k-- > 1;) {  // change between strokes k - 1 and k
    score += strokes[k].score[quantity];
    information += strokes[k].information(quantity, quantity);
    if (!(information > 0)) continue;
    likelihood[k] = score * score / (2 * information);
    if (likelihood[k] > best) {
      best = likelihood[k];
      change.last_before = strokes[k - 1].sequence;
    }
  }
  for (std::size_t k = 1; k < strokes.size(); ++k)
    if (likelihood[k] >= best - kInterval) {
      if (change.low < 0) change.low = strokes[k - 1].sequence;
      change.high = strokes[k - 1].sequence;
    }
  return change;
}

ChangeExplanation ExplainChange(const std::deque<JudgedStroke>& strokes, std::int64_t last_before,
                                const std::vector<DriftSize>& sizes, const Eigen::VectorXd& curve_doubt) {
  ChangeExplanation explanation;
  const Sums sums = SumAfter(strokes, last_before, curve_doubt);
  if (sums.score.size() == 0) return explanation;
  const Eigen::VectorXd doubt = (curve_doubt.cwiseAbs2() + strokes.back().offset_doubt.cwiseAbs2() +
                                 strokes.back().outside_doubt.cwiseAbs2())
                                    .cwiseSqrt();
  const int n = static_cast<int>(sums.score.size());
  std::vector<int> moved;
  double gained = 0;
  const auto enough = [&](const std::vector<int>& set, double share) {
    const auto fitted = FitTogether(sums.score, sums.information, set);
    return std::abs(fitted.back().size) >= share * sizes[set.back()].smallest + 2 * doubt[set.back()];
  };
  while (static_cast<int>(moved.size()) < n) {
    int best = -1;
    double most = gained;
    for (int q = 0; q < n; ++q) {
      if (Contains(moved, q)) continue;
      std::vector<int> set = moved;
      set.push_back(q);
      const double gain = Gain(sums, set, sizes);
      if (gain > most && (moved.empty() || enough(set, 1.0))) {
        most = gain;
        best = q;
      }
    }
    const double least = moved.empty() ? 0
                                       : std::max(kDriftThresholds.least_gain,
                                                  kDriftThresholds.least_share * explanation.evidence);
    if (best < 0 || most - gained < least) break;
    if (moved.empty() && !enough({best}, 0.5))
      return explanation;  // the true cause is too small to be worth telling
    moved.push_back(best);
    gained = most;
    if (moved.size() == 1) explanation.evidence = gained;
  }
  if (moved.empty()) return explanation;
  explanation.moved = FitTogether(sums.score, sums.information, moved);
  explanation.alone = FitTogether(sums.score, sums.information, {moved.front()}).front();
  if (moved.size() == 1)
    for (int q = 0; q < n; ++q)
      if (q != moved.front() &&
          explanation.evidence - Gain(sums, {q}, sizes) <
              std::max(kDriftThresholds.rival_gain, kDriftThresholds.rival_share * explanation.evidence))
        explanation.rivals.push_back(q);
  explanation.decided = explanation.rivals.empty();
  return explanation;
}

}  // namespace hydroscope::drift
