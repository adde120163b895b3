#include "estimation/states/evidence.h"

#include <algorithm>
#include <cmath>

#include "estimation/column_products.h"
#include "estimation/decompositions.h"
#include "estimation/left_out.h"

namespace hydroscope {

void TakePieces(const shooting::Task& task, const StateFitOptions& options, StateFit& fit) {
  const int outputs = task.model->output.rows, parameters = static_cast<int>(task.scale.size());
  const auto episodes = static_cast<int>(task.episodes.size());
  fit.pieces.clear();
  const int parts = std::max(1, (options.least_clusters + episodes - 1) / episodes);
  for (int e = 0; e < episodes; ++e) {
    const auto at = static_cast<std::size_t>(e);
    const Episode& episode = task.episodes[at];
    const StateRun& run = fit.runs[at];
    RowMatrix slopes = run.slopes;
    Eigen::VectorXd error(episode.rows() * outputs);
    for (int row = 0; row < episode.rows(); ++row)
      for (int j = 0; j < outputs; ++j) {
        const int r = row * outputs + j;
        const double residual = fit.residuals[at](row, j);
        const bool good = std::isfinite(residual);
        error[r] = good ? residual / task.noise[j] : 0.0;
        slopes.row(r) *= good ? 1 / task.noise[j] : 0.0;
      }
    const Eigen::Index free = slopes.cols() - parameters;
    RowMatrix by_parameter = slopes.leftCols(parameters);
    if (free > 0) {
      const Eigen::MatrixXd local = slopes.rightCols(free);
      const Eigen::MatrixXd basis = OrthonormalBasis(local);
      by_parameter -= basis * (basis.transpose() * by_parameter);
      error -= basis * (basis.transpose() * error);
    }
    for (int k = 0; k < parts; ++k) {
      StatePiece piece;
      piece.episode = e;
      piece.first = episode.rows() * k / parts;
      piece.last = episode.rows() * (k + 1) / parts;
      const Eigen::Index first = piece.first * outputs, count = (piece.last - piece.first) * outputs;
      if (count == 0) continue;
      const auto rows = by_parameter.middleRows(first, count);
      const auto errors = error.segment(first, count);
      piece.information = ColumnProducts(rows);
      piece.gradient = rows.transpose() * errors;
      piece.energy = errors.squaredNorm();
      piece.readings = static_cast<int>((errors.array() != 0).count());
      fit.pieces.push_back(std::move(piece));
    }
  }
}

namespace {

/// What the parameters, each over its size, would be without each piece of the log, linearised about the fit: jackknife over
/// clusters of residuals that are correlated in time (the CR3 estimator of MacKinnon and White 1985).
class LeftOutPieces {
 public:
  LeftOutPieces(const std::vector<StatePiece>& pieces, const Eigen::VectorXd& size) {
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size.size(), size.size());
    for (const StatePiece& piece : pieces) information += piece.information;
    const SymmetricEigen whole = EigenOf(size.asDiagonal() * information * size.asDiagonal());
    const double floor = 1e-14 * std::max(whole.values.maxCoeff(), 1e-300);
    directions_ = whole.vectors;
    white_ = whole.values.cwiseMax(floor).cwiseInverse();
    const Eigen::MatrixXd root = directions_ * white_.cwiseSqrt().asDiagonal(),
                          to_parameters = size.asDiagonal() * root;
    changes_.resize(size.size(), static_cast<Eigen::Index>(pieces.size()));
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const SymmetricEigen of_piece =
          EigenOf(to_parameters.transpose() * pieces[k].information * to_parameters);
      const Eigen::VectorXd rest = (1 - of_piece.values.array()).max(kLeastRest);
      changes_.col(k) = root * of_piece.vectors *
                        (of_piece.vectors.transpose() * (to_parameters.transpose() * pieces[k].gradient))
                            .cwiseQuotient(rest);
    }
  }

  /// Of the parameters, each over its size: wider for Student's t (StudentOfPieces), and never less than what white residuals
  /// would leave. `lasting`: residuals may be alike over longer than a piece.
  Eigen::MatrixXd Covariance(bool lasting) const {
    const Eigen::MatrixXd of_white = directions_ * white_.asDiagonal() * directions_.transpose();
    const auto pieces = static_cast<double>(changes_.cols());
    Eigen::MatrixXd covariance = changes_ * changes_.transpose() * ((pieces - 1) / std::max(pieces, 1.0));
    for (Eigen::Index p = 0; p < covariance.rows(); ++p) {
      const double found = covariance(p, p);
      if (!(found > 0)) {  // nothing depends on it
        covariance(p, p) = of_white(p, p);
        continue;
      }
      const double student = StudentOfPieces(changes_.row(p).transpose());
      const double wider = lasting ? WiderByNeighbours(p) : 1;
      const double factor = std::max(student * wider, std::sqrt(of_white(p, p) / found));
      covariance.row(p) *= factor;
      covariance.col(p) *= factor;
    }
    return covariance;
  }
  /// Directions of the parameters, and the variance of each if the residuals were white.
  const Eigen::MatrixXd& directions() const { return directions_; }
  const Eigen::VectorXd& white() const { return white_; }

 private:
  /// By how much the standard deviation of a parameter grows where two or four pieces side by side are left out at once: more than
  /// by 1 if their residuals pull alike.
  double WiderByNeighbours(Eigen::Index p) const {
    const auto variance = [&](Eigen::Index together) {
      double sum = 0, groups = 0;
      for (Eigen::Index k = 0; k < changes_.cols(); k += together, ++groups) {
        const double change = changes_.row(p).segment(k, std::min(together, changes_.cols() - k)).sum();
        sum += change * change;
      }
      return groups > 1 ? sum * (groups - 1) / groups : 0.0;
    };
    return std::sqrt(std::max({1.0, variance(2) / variance(1), variance(4) / variance(1)}));
  }

  /// Share of a direction's information that the other pieces have at least: what a single one tells of has no interval, a very
  /// wide one is given.
  static constexpr double kLeastRest = 0.05;
  Eigen::MatrixXd directions_;
  Eigen::VectorXd white_;
  Eigen::MatrixXd changes_;  ///< parameter x piece: what leaving the piece out takes from it
};

}  // namespace

void TakeCovariance(const shooting::Task& task, StateFit& fit) {
  constexpr double kUnseen = 0.7;  // standard error of a relative change that says nothing of it any more
  constexpr double kPart = 0.15;   // of a direction: parameters with less stay unnamed
  const int count = static_cast<int>(task.scale.size()), parameters = task.model->parameter_count();
  fit.covariance = Eigen::MatrixXd::Zero(parameters, parameters);
  if (parameters == 0) return;
  Eigen::VectorXd size(count);
  for (int g = parameters; g < count; ++g) size[g] = task.scale.Slope(static_cast<std::size_t>(g), 0);
  for (int p = 0; p < parameters; ++p) {
    const ParameterSpec& spec = task.model->parameters[p].spec;
    const double range = std::isfinite(spec.max - spec.min) ? spec.max - spec.min : std::abs(spec.start);
    size[p] = std::max(std::abs(fit.parameters[p]), 1e-3 * range);
    if (size[p] == 0) size[p] = 1;
  }
  const LeftOutPieces left_out(fit.pieces, size);
  // Of means over revolutions what rows between, edges and ripple leave goes with the load, whose levels may last longer than a piece.
  const bool lasting = std::ranges::any_of(task.episodes, [](const Episode& e) { return e.mean_rows > 1; });
  const Eigen::MatrixXd covariance = left_out.Covariance(lasting);
  fit.covariance = (size.asDiagonal() * covariance * size.asDiagonal()).topLeftCorner(parameters, parameters);
  for (int d = 0; d < count; ++d) {
    const double standard_error = std::sqrt(left_out.white()[d]);
    if (standard_error < kUnseen) continue;
    UnseenDirection unseen;
    const double largest = left_out.directions().col(d).head(parameters).cwiseAbs().maxCoeff();
    if (largest < kPart) continue;  // of gains
    for (int p = 0; p < parameters; ++p)
      if (const double part = left_out.directions()(p, d); std::abs(part) > kPart * largest)
        unseen.parts.emplace_back(task.model->parameters[p].name, part / largest);
    fit.unseen.push_back(std::move(unseen));
  }
}

int StateFit::readings() const {
  int sum = 0;
  for (const StatePiece& piece : pieces) sum += piece.readings;
  return sum;
}

std::vector<double> HeldOutEnergies(std::span<const StatePiece> pieces) {
  std::vector<double> energies;
  const Eigen::Index count = pieces.empty() ? 0 : pieces.front().information.rows();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(count);
  for (const StatePiece& piece : pieces) {
    information += piece.information;
    gradient += piece.gradient;
  }
  for (const StatePiece& piece : pieces) {
    if (count == 0) {
      energies.push_back(piece.energy);
      continue;
    }
    const Eigen::VectorXd change =
        ScaledFactor(information - piece.information).Solve(gradient - piece.gradient);
    // Errors of the piece after the change: r - J change.
    energies.push_back(std::max(
        0.0, piece.energy - 2 * piece.gradient.dot(change) + change.dot(piece.information * change)));
  }
  return energies;
}

std::vector<double> StateFit::HeldOutEnergies() const {
  const Eigen::Index count = pieces.empty() ? 0 : pieces.front().information.rows();
  std::vector<Eigen::Index> free;
  for (Eigen::Index p = 0; p < count; ++p) {
    const auto at = static_cast<std::size_t>(p);
    if (at >= at_limit.size() || !at_limit[at]) free.push_back(p);
  }
  if (static_cast<Eigen::Index>(free.size()) == count) return hydroscope::HeldOutEnergies(pieces);
  std::vector<StatePiece> inside = pieces;
  for (StatePiece& piece : inside) {
    piece.information = piece.information(free, free).eval();
    piece.gradient = piece.gradient(free).eval();
  }
  return hydroscope::HeldOutEnergies(inside);
}

double StateFit::HeldOutEnergy() const {
  double sum = 0;
  for (const double energy : HeldOutEnergies()) sum += energy;
  return sum;
}

}  // namespace hydroscope
