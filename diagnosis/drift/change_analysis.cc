#include "diagnosis/drift/change_analysis.h"

#include <algorithm>
#include <cmath>

namespace hydroscope::drift {
namespace {

constexpr double kInterval = 1.92;     ///< half of the 95 % point of chi-squared with one degree of freedom
constexpr double kLeastGain = 12.0;    ///< log-likelihood a further quantity must add ...
constexpr double kLeastShare = 0.10;   ///< ... also as a share of the first one's
constexpr double kRivalShare = 0.003;  ///< a rival explains the same up to this share, or up to ...
constexpr double kRivalGain = 6.0;     ///< ... this log-likelihood: odds of 400 to one

constexpr double kMostInflation =
    20.0;  ///< of a size's variance by the others: beyond, they cannot be told apart

struct Sums {
  Eigen::VectorXd score;
  Eigen::MatrixXd information;
};

Sums SumAfter(const std::deque<JudgedStroke>& strokes, std::int64_t last_before) {
  Sums sums;
  for (const JudgedStroke& s : strokes) {
    if (s.sequence <= last_before) continue;
    if (sums.score.size() == 0)
      sums = {s.score, s.information};
    else {
      sums.score += s.score;
      sums.information += s.information;
    }
  }
  return sums;
}

/// The sums with the reference's own error, normal with std `doubt` and the same for all strokes, integrated
/// out: what an error of the reference would explain as well no longer speaks for any quantity.
///   J' = (J^-1 + D)^-1 = J - J (J + D^-1)^-1 J,   s' = s - J (J + D^-1)^-1 s,   D = diag(doubt^2)
Sums WithoutReferenceError(const Sums& sums, const Eigen::VectorXd& doubt) {
  const Eigen::VectorXd unit = sums.information.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::MatrixXd j =
      unit.cwiseInverse().asDiagonal() * sums.information * unit.cwiseInverse().asDiagonal();
  const Eigen::VectorXd s = sums.score.cwiseQuotient(unit);
  const Eigen::VectorXd root = doubt.cwiseProduct(unit).cwiseMin(1e4);  // of D in the same units
  // (J + D^-1)^-1 = R (1 + R J R)^-1 R with R = D^(1/2): also for a reference without error.
  const Eigen::MatrixXd inner =
      Eigen::MatrixXd::Identity(j.rows(), j.cols()) + root.asDiagonal() * j * root.asDiagonal();
  const Eigen::MatrixXd taken = root.asDiagonal() * inner.llt().solve(Eigen::MatrixXd(root.asDiagonal()));
  return {unit.cwiseProduct(s - j * taken * s), unit.asDiagonal() * (j - j * taken * j) * unit.asDiagonal()};
}

/// Log-likelihood that shifts of `moved` together gain; 0 if a size has a sign that cannot be, or if they
/// cannot be told apart.
double Gain(const Sums& sums, const std::vector<int>& moved, const std::vector<DriftSize>& sizes) {
  double gain = 0;
  for (const Moved& m : FitTogether(sums.score, sums.information, moved)) {
    if (sizes[m.quantity].only_upwards && m.size < 0) return 0;
    if (m.std * m.std * sums.information(m.quantity, m.quantity) > kMostInflation) return 0;
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
  const Eigen::MatrixXd inverse = h.completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::VectorXd size = inverse * s;
  std::vector<Moved> fitted;
  for (Eigen::Index i = 0; i < n; ++i)
    fitted.push_back({moved[i], size[i] * scale[i], std::sqrt(std::max(0.0, inverse(i, i))) * scale[i]});
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
                                const std::vector<DriftSize>& sizes, const Eigen::VectorXd& doubt) {
  ChangeExplanation explanation;
  Sums sums = SumAfter(strokes, last_before);
  if (sums.score.size() == 0) return explanation;
  sums = WithoutReferenceError(sums, doubt);
  const int n = static_cast<int>(sums.score.size());
  std::vector<int> moved;
  double gained = 0;
  const auto enough = [&](const std::vector<int>& set) {
    const auto fitted = FitTogether(sums.score, sums.information, set);
    return std::abs(fitted.back().size) >= 0.5 * sizes[set.back()].smallest + 2 * doubt[set.back()];
  };
  while (static_cast<int>(moved.size()) < n) {
    int best = -1;
    double most = gained;
    for (int q = 0; q < n; ++q) {
      if (std::find(moved.begin(), moved.end(), q) != moved.end()) continue;
      std::vector<int> set = moved;
      set.push_back(q);
      const double gain = Gain(sums, set, sizes);
      if (gain > most && (moved.empty() || enough(set))) {
        most = gain;
        best = q;
      }
    }
    const double least = moved.empty() ? 0 : std::max(kLeastGain, kLeastShare * explanation.evidence);
    if (best < 0 || most - gained < least) break;
    if (moved.empty() && !enough({best}))
      return explanation;  // the true cause is too small to be worth telling
    moved.push_back(best);
    gained = most;
    if (moved.size() == 1) explanation.evidence = gained;
  }
  if (moved.empty()) return explanation;
  explanation.moved = FitTogether(sums.score, sums.information, moved);
  if (moved.size() == 1)
    for (int q = 0; q < n; ++q)
      if (q != moved.front() && explanation.evidence - Gain(sums, {q}, sizes) <
                                    std::max(kRivalGain, kRivalShare * explanation.evidence))
        explanation.rivals.push_back(q);
  explanation.decided = explanation.rivals.empty();
  return explanation;
}

}  // namespace hydroscope::drift
