#include "estimation/linear_form/linear_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/decompositions.h"
#include "estimation/left_out.h"
#include "estimation/linear_form/noisier_copies.h"

namespace hydroscope {
namespace {

/// Information and gradient of the windows of a piece, weighted.
struct PieceSums {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

class LinearFitter {
 public:
  LinearFitter(const WindowEquations& windows, const std::vector<int>& kept)
      : known_(windows.known), noise_(windows.known.size(), 1.0) {
    for (const Eigen::MatrixXd& whole : windows.regressor) {
      Eigen::MatrixXd columns(whole.rows(), static_cast<Eigen::Index>(kept.size()));
      for (std::size_t k = 0; k < kept.size(); ++k) columns.col(k) = whole.col(kept[k]);
      regressor_.push_back(std::move(columns));
    }
    for (std::size_t e = 0; e < known_.size(); ++e) noise_[e] = std::max(Rms(known_[e]), 1e-300);
  }

  /// Weighs each equation by what `rounds` of least squares leave of it.
  void FindNoise(int rounds) {
    for (int round = 0; round < rounds; ++round) {
      const Eigen::VectorXd theta = Without(0, 0);
      for (std::size_t e = 0; e < known_.size(); ++e)
        noise_[e] = std::max(Rms(Left(e, theta)), 1e-12 * Rms(known_[e]) + 1e-300);
    }
  }
  void TakeNoise(const std::vector<double>& noise) { noise_ = noise; }
  const std::vector<double>& noise() const { return noise_; }
  Eigen::Index windows() const { return known_.front().size(); }
  /// What parameters leave of an equation.
  Eigen::VectorXd Left(std::size_t equation, const Eigen::VectorXd& theta) const {
    return known_[equation] - regressor_[equation] * theta;
  }
  static double Rms(const Eigen::VectorXd& values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, values.size())));
  }

  /// Least squares without the windows first ... last - 1.
  Eigen::VectorXd Without(Eigen::Index first, Eigen::Index last) {
    if (all_.noise != noise_) all_ = {Sums(0, windows()), noise_};
    const PieceSums out = Sums(first, last);
    return Solved({all_.sums.information - out.information, all_.sums.gradient - out.gradient});
  }

 private:
  static Eigen::VectorXd Solved(const PieceSums& sums) {
    const Eigen::VectorXd scale = sums.information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * sums.information * scale.asDiagonal();
    return scale.cwiseProduct(SymmetricFactor(scaled).Solve(scale.cwiseProduct(sums.gradient)));
  }
  PieceSums Sums(Eigen::Index first, Eigen::Index last) const {
    const Eigen::Index count = regressor_.front().cols();
    PieceSums sums{Eigen::MatrixXd::Zero(count, count), Eigen::VectorXd::Zero(count)};
    for (std::size_t e = 0; e < known_.size(); ++e) {
      const auto rows = regressor_[e].middleRows(first, last - first);
      const double weight = 1 / (noise_[e] * noise_[e]);
      sums.information += weight * rows.transpose() * rows;
      sums.gradient += weight * rows.transpose() * known_[e].segment(first, last - first);
    }
    return sums;
  }

  struct AllSums {
    PieceSums sums;
    std::vector<double> noise;  ///< that they are weighted by
  };
  std::vector<Eigen::MatrixXd> regressor_;
  std::vector<Eigen::VectorXd> known_;
  std::vector<double> noise_;
  AllSums all_;
};

/// What least squares would give without noise in the regressors, which draws it towards 0 (errors in variables): fits of noisier
/// copies tell how far as much noise again moves it, and as far the record's own has moved it (simulation and extrapolation, Cook
/// and Stefanski 1994).
class WithoutNoise {
 public:
  WithoutNoise(LinearFitter record, std::vector<LinearFitter> noisier)
      : record_(std::move(record)), noisier_(std::move(noisier)) {
    for (LinearFitter& copy : noisier_) copy.TakeNoise(record_.noise());
  }

  Eigen::VectorXd Without(Eigen::Index first, Eigen::Index last) {
    const Eigen::VectorXd own = record_.Without(first, last);
    if (noisier_.empty()) return own;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(own.size());
    for (LinearFitter& copy : noisier_) sum += copy.Without(first, last);
    return 2 * own - sum / static_cast<double>(noisier_.size());
  }

  /// Standard deviations from the fits with each piece left out, wider for Student's t (an edge may be open in few of them).
  Eigen::VectorXd Jackknife(const Eigen::VectorXd& theta, int pieces) {
    const Eigen::Index windows = record_.windows();
    Eigen::MatrixXd changes(theta.size(), pieces);
    for (int p = 0; p < pieces; ++p)
      changes.col(p) = Without(windows * p / pieces, windows * (p + 1) / pieces) - theta;
    Eigen::VectorXd std = changes.rowwise().norm() * std::sqrt((pieces - 1.0) / pieces);
    for (Eigen::Index k = 0; k < std.size(); ++k) std[k] *= StudentOfPieces(changes.row(k).transpose());
    return std;
  }

 private:
  LinearFitter record_;
  std::vector<LinearFitter> noisier_;
};

/// Noise of the signals: what their sixth differences show, but no more than leaves of each balance what is left of it. A spool
/// that follows a command made of noisy readings does move from row to row, and the balances know it.
Eigen::VectorXd NoiseOfSignals(const LinearForm& form, const Machine& machine,
                               std::span<const Episode> episodes, const std::vector<int>& kept,
                               LinearFitter& record, const LinearFitOptions& options) {
  Eigen::VectorXd noise = WhiteNoiseOfSignals(episodes);
  const Eigen::VectorXd theta = record.Without(0, 0);
  for (Eigen::Index s = 0; s < noise.size(); ++s) {
    Eigen::VectorXd alone = Eigen::VectorXd::Zero(noise.size());
    alone[s] = noise[s];
    const std::vector<Episode> copy = NoisierCopies(episodes, alone, 1, options.seed).front();
    const LinearFitter noisier(WindowsOf(form, machine, copy, options.windows), kept);
    for (std::size_t e = 0; e < form.equations.size(); ++e) {
      const double left = record.noise()[e],
                   from_signal = LinearFitter::Rms(noisier.Left(e, theta) - record.Left(e, theta));
      if (from_signal > left) noise[s] = std::min(noise[s], alone[s] * left / from_signal);
    }
  }
  return noise;
}

/// All equations one under the other, each over the size of what is known of it.
Eigen::MatrixXd Stacked(const WindowEquations& windows) {
  const auto equations = static_cast<Eigen::Index>(windows.regressor.size());
  const Eigen::Index rows = windows.regressor.front().rows();
  Eigen::MatrixXd all(rows * equations, windows.regressor.front().cols());
  for (Eigen::Index e = 0; e < equations; ++e) {
    const auto at = static_cast<std::size_t>(e);
    all.middleRows(e * rows, rows) = windows.regressor[at] / std::max(windows.known[at].norm(), 1e-300);
  }
  return all;
}

}  // namespace

LinearFit FitLinearForm(const LinearForm& form, const Machine& machine, std::span<const Episode> episodes,
                        const LinearFitOptions& options) {
  LinearFit fit;
  const WindowEquations windows = WindowsOf(form, machine, episodes, options.windows);
  fit.windows = static_cast<int>(windows.time.size());
  const int needed = static_cast<int>(form.parameters.size()) + 2 * options.pieces;
  if (fit.windows < needed) {
    fit.failed = fmt::format("{} windows of {} s without a gap, at least {} are needed: record longer",
                             fit.windows, 4 * options.windows.box, needed);
    return fit;
  }
  fit.base = FindBaseParameters(Stacked(windows));
  for (const int column : fit.base.kept) fit.parameters.push_back(form.parameters[column]);
  LinearFitter record(windows, fit.base.kept);
  record.FindNoise(options.rounds);
  fit.noise = record.noise();
  const Eigen::VectorXd noise = NoiseOfSignals(form, machine, episodes, fit.base.kept, record, options);
  std::vector<LinearFitter> noisier;
  for (const std::vector<Episode>& copy : NoisierCopies(episodes, noise, options.noise_pairs, options.seed))
    noisier.emplace_back(WindowsOf(form, machine, copy, options.windows), fit.base.kept);
  WithoutNoise fitter(std::move(record), std::move(noisier));
  fit.value = fitter.Without(0, 0);
  fit.std = fitter.Jackknife(fit.value, options.pieces);
  if (!fit.value.allFinite() || !fit.std.allFinite())
    fit.failed = "the record does not move the machine enough to tell its parameters apart";
  return fit;
}

std::string BaseParameterText(const LinearForm& form, const BaseParameterSet& base, std::size_t kept) {
  const int own = base.kept[kept];
  std::string text = form.parameters[static_cast<std::size_t>(own)];
  for (Eigen::Index j = 0; j < base.combination.cols(); ++j) {
    const double share = base.combination(static_cast<Eigen::Index>(kept), j);
    if (j == own || share == 0) continue;
    text += fmt::format(" {} {:.4g} {}", share < 0 ? "-" : "+", std::abs(share), form.parameters[j]);
  }
  return text;
}

}  // namespace hydroscope
