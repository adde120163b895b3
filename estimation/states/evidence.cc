#include "estimation/states/evidence.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {

void TakePieces(const shooting::Task& task, const StateFitOptions& options, StateFit& fit) {
  const int outputs = task.model->output.rows, parameters = static_cast<int>(task.scale.size());
  const auto episodes = static_cast<int>(task.episodes.size());
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
      const Eigen::HouseholderQR<Eigen::MatrixXd> qr(local);
      const Eigen::MatrixXd basis = qr.householderQ() * Eigen::MatrixXd::Identity(local.rows(), free);
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
      piece.information = rows.transpose() * rows;
      piece.gradient = rows.transpose() * errors;
      piece.energy = errors.squaredNorm();
      piece.readings = static_cast<int>((errors.array() != 0).count());
      fit.pieces.push_back(std::move(piece));
    }
  }
}

void TakeCovariance(const shooting::Task& task, StateFit& fit) {
  constexpr double kUnseen = 0.7;  // standard error of a relative change that says nothing of it any more
  constexpr double kPart = 0.15;   // of a direction: parameters with less stay unnamed
  const int count = static_cast<int>(task.scale.size()), parameters = task.model->parameter_count();
  fit.covariance = Eigen::MatrixXd::Zero(parameters, parameters);
  if (parameters == 0) return;
  Eigen::VectorXd size(count);
  for (int g = parameters; g < count; ++g) size[g] = task.scale.Slope(static_cast<std::size_t>(g), 0);
  for (int p = 0; p < parameters; ++p) {
    const ParameterSpec& spec = task.model->parameters[static_cast<std::size_t>(p)].spec;
    const double range = std::isfinite(spec.max - spec.min) ? spec.max - spec.min : std::abs(spec.start);
    size[p] = std::max(std::abs(fit.parameters[p]), 1e-3 * range);
    if (size[p] == 0) size[p] = 1;
  }
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count), scatter = information;
  for (const StatePiece& piece : fit.pieces) {
    information += piece.information;
    scatter += piece.gradient * piece.gradient.transpose();
  }
  const double pieces = static_cast<double>(fit.pieces.size());
  if (pieces > 1) scatter *= pieces / (pieces - 1);
  information = size.asDiagonal() * information * size.asDiagonal();
  scatter = size.asDiagonal() * scatter * size.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(information);
  const Eigen::MatrixXd& directions = solver.eigenvectors();
  const double floor = 1e-14 * std::max(solver.eigenvalues().maxCoeff(), 1e-300);
  const Eigen::VectorXd weights = solver.eigenvalues().cwiseMax(floor).cwiseInverse();
  const Eigen::MatrixXd inverse = directions * weights.asDiagonal() * directions.transpose();
  // White residuals make the scatter the information itself: never less than that.
  Eigen::MatrixXd covariance = inverse * scatter * inverse;
  for (int p = 0; p < count; ++p) {
    const double white = inverse(p, p), found = covariance(p, p);
    if (!(found > 0)) covariance(p, p) = white;  // nothing depends on it
    if (found >= white || !(found > 0)) continue;
    const double factor = std::sqrt(white / found);
    covariance.row(p) *= factor;
    covariance.col(p) *= factor;
  }
  fit.covariance = (size.asDiagonal() * covariance * size.asDiagonal()).topLeftCorner(parameters, parameters);
  for (int d = 0; d < count; ++d) {
    const double standard_error = std::sqrt(weights[d]);
    if (standard_error < kUnseen) continue;
    UnseenDirection unseen;
    const double largest = directions.col(d).head(parameters).cwiseAbs().maxCoeff();
    if (largest < kPart) continue;  // of gains
    for (int p = 0; p < parameters; ++p)
      if (std::abs(directions(p, d)) > kPart * largest)
        unseen.parts.emplace_back(task.model->parameters[static_cast<std::size_t>(p)].name,
                                  directions(p, d) / largest);
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
    Eigen::MatrixXd rest = information - piece.information;
    const Eigen::VectorXd size = rest.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    rest = size.asDiagonal() * rest * size.asDiagonal();
    rest.diagonal().array() += 1e-10;
    const Eigen::VectorXd change =
        size.cwiseProduct(rest.ldlt().solve(size.cwiseProduct(gradient - piece.gradient)));
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
