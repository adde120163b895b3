#include "estimation/stroke_clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>

#include "estimation/decompositions.h"
#include "estimation/gram_fit.h"

namespace hydroscope {
namespace {

/// Of scaled normal equations without a group: below it they say nothing alone.
constexpr double kLeastPivot = 1e-10;
constexpr int kLeastStrokes = 8;      ///< signs of fewer do not give a tail
constexpr int kLeastGroups = 3;       ///< of operating points and times; two logs are two logs
constexpr int kMostEqualGroups = 8;   ///< where the values of a level do not lie together
constexpr int kSignDraws = 199;       ///< Davidson and MacKinnon 2000: 5 % of 199 + 1 is a whole number
constexpr double kFalseAlarm = 0.05;  ///< of independent strokes: it only widens
constexpr double kGap = 0.05;    ///< between values that do not lie together, relative to their range ...
constexpr double kMoved = 0.01;  ///< ... if the range is more than this of their size
constexpr double kFewestThatTell = 2;  ///< one by itself has no scatter, and no interval

using Order = std::vector<std::size_t>;

/// Numbers groups 0, 1, ... in order of their first stroke; nullopt if they are all one or all single.
std::optional<StrokeClusters> Numbered(ClusterUnit unit, const std::vector<int>& labels, int level = -1) {
  StrokeClusters out{unit, std::vector<int>(labels.size(), -1), 0, level};
  std::vector<int> seen;
  for (std::size_t s = 0; s < labels.size(); ++s) {
    const auto at = std::ranges::find(seen, labels[s]);
    out.of[s] = static_cast<int>(at - seen.begin());
    if (at == seen.end()) seen.push_back(labels[s]);
  }
  out.count = static_cast<int>(seen.size());
  const int least = unit == ClusterUnit::kLog ? 2 : kLeastGroups;
  if (out.count < least || 2 * out.count > static_cast<int>(labels.size())) return std::nullopt;
  return out;
}

std::optional<StrokeClusters> ByLog(std::span<const StrokeOperation> operations) {
  std::vector<int> labels;
  for (const StrokeOperation& o : operations) labels.push_back(o.log);
  return Numbered(ClusterUnit::kLog, labels);
}

/// Blocks of about `length` consecutive strokes, none over two logs.
std::optional<StrokeClusters> ByTime(std::span<const StrokeOperation> operations, int length) {
  std::vector<int> labels;
  for (std::size_t s = 0, in_block = 0, label = 0; s < operations.size(); ++s, ++in_block) {
    const bool next =
        s > 0 && (operations[s].log != operations[s - 1].log || in_block == static_cast<std::size_t>(length));
    if (next) {
      ++label;
      in_block = 0;
    }
    labels.push_back(static_cast<int>(label));
  }
  return Numbered(ClusterUnit::kTime, labels);
}

Order ByValue(std::span<const StrokeOperation> operations, int level) {
  Order order(operations.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return operations[a].level[level] < operations[b].level[level];
  });
  return order;
}

/// Values that lie together, with gaps between.
std::optional<StrokeClusters> ByGaps(std::span<const StrokeOperation> operations, int level) {
  const Order order = ByValue(operations, level);
  const auto value = [&](std::size_t k) { return operations[order[k]].level[level]; };
  const double range = value(order.size() - 1) - value(0);
  std::vector<int> labels(order.size());
  for (std::size_t k = 1; k < order.size(); ++k)
    labels[order[k]] = labels[order[k - 1]] + (value(k) - value(k - 1) > kGap * range ? 1 : 0);
  return Numbered(ClusterUnit::kOperatingPoint, labels, level);
}

/// Equally many strokes of neighbouring values.
std::optional<StrokeClusters> ByQuantiles(std::span<const StrokeOperation> operations, int level) {
  const Order order = ByValue(operations, level);
  const int groups = std::min(kMostEqualGroups, static_cast<int>(order.size()) / 2);
  std::vector<int> labels(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    labels[order[k]] = static_cast<int>(k * static_cast<std::size_t>(groups) / order.size());
  return Numbered(ClusterUnit::kOperatingPoint, labels, level);
}

bool Moves(std::span<const StrokeOperation> operations, int level) {
  double low = operations.front().level[level], high = low;
  for (const StrokeOperation& o : operations) {
    low = std::min(low, o.level[level]);
    high = std::max(high, o.level[level]);
  }
  return std::isfinite(high - low) && high - low > kMoved * std::abs(high);
}

std::vector<StrokeClusters> Candidates(std::span<const StrokeOperation> operations) {
  std::vector<StrokeClusters> out;
  const auto add = [&](std::optional<StrokeClusters> clusters) {
    if (!clusters) return;
    if (std::ranges::none_of(out, [&](const auto& known) { return known.of == clusters->of; }))
      out.push_back(std::move(*clusters));
  };
  add(ByLog(operations));
  for (int level = 0; level < operations.front().level.size(); ++level) {
    if (!Moves(operations, level)) continue;
    const auto together = ByGaps(operations, level);
    add(together ? together : ByQuantiles(operations, level));
  }
  const int count = static_cast<int>(operations.size());
  for (const int length : {2, (count + 7) / 8, (count + 3) / 4}) add(ByTime(operations, length));
  return out;
}

/// Variances of all parameters by the jackknife over groups, as a function of the strokes' scores alone.
class GroupVariance {
 public:
  /// Not usable() if some group holds what the rest does not determine.
  GroupVariance(std::span<const NormalEquations> strokes, const Eigen::MatrixXd& h, std::vector<int> of,
                int count)
      : of_(std::move(of)) {
    for (int group = 0; group < count; ++group) {
      Eigen::MatrixXd rest = h;
      for (std::size_t s = 0; s < strokes.size(); ++s)
        if (of_[s] == group) rest -= strokes[s].h;
      const SymmetricFactor factor(rest);
      // In scaled parameters a pivot is the share of a regressor that the others do not explain.
      if (!factor.sound() || !(factor.LeastPivot() > kLeastPivot)) return;
      without_.push_back(factor.SolveColumns(Eigen::MatrixXd::Identity(h.rows(), h.cols())));
    }
    usable_ = true;
  }

  bool usable() const { return usable_; }

  Eigen::VectorXd operator()(const Eigen::MatrixXd& scores) const {
    const int count = static_cast<int>(without_.size());
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(scores.rows(), count);
    for (std::size_t s = 0; s < of_.size(); ++s) sums.col(of_[s]) += scores.col(s);
    const Eigen::VectorXd total = sums.rowwise().sum();
    sums = (-sums).colwise() + total;
    Eigen::MatrixXd replicas(scores.rows(), count);
    for (int g = 0; g < count; ++g) replicas.col(g) = without_[g].lazyProduct(sums.col(g));
    replicas.colwise() -= replicas.rowwise().mean().eval();
    return (count - 1.0) / count * replicas.rowwise().squaredNorm();  // JackknifeCovariance's diagonal
  }

 private:
  std::vector<int> of_;
  std::vector<Eigen::MatrixXd> without_;
  bool usable_ = false;
};

/// Regressors scaled to unit diagonal of the sum, so that pivots can be judged.
std::vector<NormalEquations> ScaledEquations(std::span<const NormalEquations> strokes,
                                             Eigen::VectorXd& scale) {
  NormalEquations total;
  for (const NormalEquations& s : strokes) total += s;
  scale = total.h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  std::vector<NormalEquations> out(strokes.begin(), strokes.end());
  for (NormalEquations& s : out) {
    s.h = (scale.asDiagonal() * s.h * scale.asDiagonal()).eval();
    s.g = scale.cwiseProduct(s.g).eval();
  }
  return out;
}

/// Logarithm of the variance by groups over that by strokes, groupings x parameters, one column after the other.
class VarianceRatios {
 public:
  VarianceRatios(std::span<const NormalEquations> strokes, const std::vector<StrokeClusters>& candidates)
      : single_(strokes, Sum(strokes), SingleStrokes(strokes.size()).of, static_cast<int>(strokes.size())) {
    const Eigen::MatrixXd h = Sum(strokes);
    if (!single_.usable()) return;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      GroupVariance groups(strokes, h, candidates[c].of, candidates[c].count);
      if (!groups.usable()) continue;
      groups_.push_back(std::move(groups));
      candidate_.push_back(c);
    }
  }

  bool empty() const { return groups_.empty(); }
  int size() const { return static_cast<int>(groups_.size()); }
  std::size_t candidate(int k) const { return candidate_[k]; }

  Eigen::MatrixXd operator()(const Eigen::MatrixXd& scores) const {
    const Eigen::ArrayXd by_stroke = single_(scores).array().max(1e-300);
    Eigen::MatrixXd out(scores.rows(), size());
    for (int k = 0; k < size(); ++k)
      out.col(k) = (groups_[k](scores).array().max(1e-300) / by_stroke).log().matrix();
    return out;
  }

 private:
  static Eigen::MatrixXd Sum(std::span<const NormalEquations> strokes) {
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(strokes[0].h.rows(), strokes[0].h.cols());
    for (const NormalEquations& s : strokes) h += s.h;
    return h;
  }

  GroupVariance single_;
  std::vector<GroupVariance> groups_;
  std::vector<std::size_t> candidate_;
};

/// Scores of the strokes with signs drawn at random, each draw judged by `ratios`.
std::vector<Eigen::MatrixXd> DrawnRatios(const VarianceRatios& ratios, const Eigen::MatrixXd& scores) {
  std::mt19937_64 random(1);
  std::vector<Eigen::MatrixXd> out;
  for (int draw = 0; draw < kSignDraws; ++draw) {
    Eigen::MatrixXd drawn = scores;
    for (Eigen::Index s = 0; s < scores.cols(); ++s)
      if ((random() & 1U) != 0) drawn.col(s) = -drawn.col(s);
    out.push_back(ratios(drawn));
  }
  return out;
}

/// For every grouping: by how much its largest ratio stands out of the draws, less what 95 % of draws reach anywhere.
Eigen::VectorXd StandsOutBy(const Eigen::MatrixXd& measured, const std::vector<Eigen::MatrixXd>& drawn) {
  const double count = static_cast<double>(drawn.size());
  Eigen::ArrayXXd mean = Eigen::ArrayXXd::Zero(measured.rows(), measured.cols()), square = mean;
  for (const Eigen::MatrixXd& d : drawn) mean += d.array() / count;
  for (const Eigen::MatrixXd& d : drawn) square += (d.array() - mean).square() / (count - 1);
  const Eigen::ArrayXXd spread = square.sqrt().max(1e-9);
  std::vector<double> largest;
  for (const Eigen::MatrixXd& d : drawn) largest.push_back(((d.array() - mean) / spread).maxCoeff());
  std::ranges::sort(largest);
  const double limit = largest[static_cast<std::size_t>(std::ceil((1 - kFalseAlarm) * (count + 1))) - 1];
  return (((measured.array() - mean) / spread).colwise().maxCoeff() - limit).matrix().transpose();
}

/// What few groups add to an interval beside many strokes.
double FewGroups(double groups, std::size_t strokes) {
  return StudentFactor(groups - 1) / StudentFactor(static_cast<double>(strokes) - 1);
}

}  // namespace

const char* ClusterUnitName(ClusterUnit unit) {
  switch (unit) {
    case ClusterUnit::kStroke:
      return "stroke";
    case ClusterUnit::kTime:
      return "time";
    case ClusterUnit::kOperatingPoint:
      return "operating_point";
    case ClusterUnit::kLog:
      return "log";
  }
  return "stroke";
}

StrokeClusters SingleStrokes(std::size_t count) {
  StrokeClusters out;
  out.of.resize(count);
  std::iota(out.of.begin(), out.of.end(), 0);
  out.count = static_cast<int>(count);
  return out;
}

Eigen::MatrixXd ReplicasWithoutClusters(std::span<const NormalEquations> strokes,
                                        const StrokeClusters& clusters) {
  NormalEquations total;
  for (const NormalEquations& s : strokes) total += s;
  Eigen::MatrixXd replicas(total.g.size(), clusters.count);
  for (int group = 0; group < clusters.count; ++group) {
    NormalEquations rest = total;
    for (std::size_t s = 0; s < strokes.size(); ++s)
      if (clusters.of[s] == group) rest -= strokes[s];
    const Eigen::VectorXd theta = SolveNormalEquations(rest);
    if (theta.size() == 0) return {};
    replicas.col(group) = theta;
  }
  return replicas;
}

double AlikeStrokes(double sum_of_shares, double sum_of_squares) {
  return std::max(sum_of_shares * sum_of_shares / std::max(sum_of_squares, 1e-300), kFewestThatTell);
}

Eigen::VectorXd StrokesThatTell(std::span<const NormalEquations> strokes, const Eigen::MatrixXd& directions) {
  Eigen::VectorXd scale;
  const std::vector<NormalEquations> scaled = ScaledEquations(strokes, scale);
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(scale.size(), scale.size());
  for (const NormalEquations& s : scaled) total += s.h;
  const Eigen::MatrixXd w = total.completeOrthogonalDecomposition().solve(scale.asDiagonal() * directions);
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(directions.cols()), squares = sum;
  for (const NormalEquations& s : scaled) {
    const Eigen::ArrayXd share = w.cwiseProduct(s.h * w).colwise().sum().transpose().array().max(0.0);
    sum += share;
    squares += share.square();
  }
  return sum.binaryExpr(squares, &AlikeStrokes).matrix();
}

Eigen::MatrixXd JackknifeCovariance(const Eigen::MatrixXd& replicas) {
  const double count = static_cast<double>(replicas.cols());
  const Eigen::MatrixXd centred = replicas.colwise() - replicas.rowwise().mean();
  return (count - 1) / count * centred * centred.transpose();
}

StrokeClusters FindStrokeClusters(std::span<const NormalEquations> strokes,
                                  std::span<const StrokeOperation> operations, const Eigen::VectorXd& theta) {
  const StrokeClusters none = SingleStrokes(strokes.size());
  if (static_cast<int>(strokes.size()) < kLeastStrokes || operations.size() != strokes.size()) return none;
  const std::vector<StrokeClusters> candidates = Candidates(operations);
  Eigen::VectorXd scale;
  const std::vector<NormalEquations> scaled = ScaledEquations(strokes, scale);
  const VarianceRatios ratios(scaled, candidates);
  if (ratios.empty()) return none;
  Eigen::MatrixXd scores(theta.size(), static_cast<Eigen::Index>(scaled.size()));
  for (std::size_t s = 0; s < scaled.size(); ++s)
    scores.col(s) = scaled[s].g - scaled[s].h * theta.cwiseQuotient(scale);
  const Eigen::MatrixXd measured = ratios(scores);
  const Eigen::VectorXd beyond = StandsOutBy(measured, DrawnRatios(ratios, scores));
  double widest = 0;
  StrokeClusters best = none;
  for (int k = 0; k < ratios.size(); ++k) {
    const StrokeClusters& clusters = candidates[ratios.candidate(k)];
    const double width = measured.col(k).maxCoeff() / 2 + std::log(FewGroups(clusters.count, strokes.size()));
    if (!(beyond[k] > 0) || width <= widest) continue;
    widest = width;
    best = clusters;
  }
  return best;
}

Eigen::MatrixXd WidenedCovariance(std::span<const NormalEquations> strokes, const StrokeClusters& clusters,
                                  const Eigen::MatrixXd& alike) {
  if (strokes.size() < 2) return alike;
  const Eigen::Index n = alike.rows();
  const Eigen::VectorXd few_tell =
      StrokesThatTell(strokes, Eigen::MatrixXd::Identity(n, n)).unaryExpr([&](double tell) {
        return FewGroups(tell, strokes.size());
      });
  const Eigen::MatrixXd by_stroke = few_tell.asDiagonal() * alike * few_tell.asDiagonal();
  if (clusters.unit == ClusterUnit::kStroke) return by_stroke;
  const Eigen::MatrixXd replicas = ReplicasWithoutClusters(strokes, clusters);
  if (replicas.size() == 0) return by_stroke;
  const double few = FewGroups(clusters.count, strokes.size());
  const Eigen::MatrixXd by_group = few * few * JackknifeCovariance(replicas);
  // Groups never promise more than strokes: parameters for which they would keep the strokes' width.
  const Eigen::VectorXd factor =
      (by_stroke.diagonal().array() / by_group.diagonal().array().max(1e-300)).max(1.0).sqrt().matrix();
  return factor.asDiagonal() * by_group * factor.asDiagonal();
}

}  // namespace hydroscope
