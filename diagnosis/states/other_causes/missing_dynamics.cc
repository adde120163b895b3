#include "diagnosis/states/other_causes/missing_dynamics.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "diagnosis/states/left_out_columns.h"
#include "diagnosis/states/tangent.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

/// Inputs, then simulated states of an episode, each less its mean over its spread; row x series.
Eigen::MatrixXd SeriesOf(const StateFit& fit, const Episode& episode, std::size_t index) {
  const auto& inputs = fit.model->inputs;
  const auto count = static_cast<Eigen::Index>(inputs.size());
  Eigen::MatrixXd series(episode.rows(), count + fit.model->states());
  for (Eigen::Index i = 0; i < count; ++i)
    series.col(i) = episode.signal.col(inputs[static_cast<std::size_t>(i)]);
  series.rightCols(fit.model->states()) = fit.runs[index].states;
  for (auto column : series.colwise()) {
    column = column.unaryExpr([](double value) { return std::isfinite(value) ? value : 0.0; });
    column.array() -= column.mean();
    column /= std::max(column.norm() / std::sqrt(static_cast<double>(column.size())), 1e-300);
  }
  return series;
}

/// What filters remember at each row of the rows before: per series and pole one column, two of a pole that swings.
Eigen::MatrixXd PastOf(const Eigen::MatrixXd& series, const std::vector<std::complex<double>>& poles) {
  Eigen::Index width = 0;
  for (const std::complex<double>& pole : poles) width += pole.imag() == 0 ? 1 : 2;
  Eigen::MatrixXd past(series.rows(), series.cols() * width);
  Eigen::Index at = 0;
  for (Eigen::Index s = 0; s < series.cols(); ++s)
    for (const std::complex<double>& pole : poles) {
      std::complex<double> memory = 0;
      for (Eigen::Index row = 0; row < series.rows(); ++row) {
        past(row, at) = memory.real();
        if (pole.imag() != 0) past(row, at + 1) = memory.imag();
        memory = pole * memory + series(row, s);
      }
      at += pole.imag() == 0 ? 1 : 2;
    }
  return past;
}

/// One that decays and one that swings at each of some frequencies.
std::vector<std::complex<double>> Poles(int count, const MissingDynamicsOptions& options) {
  std::vector<std::complex<double>> poles;
  for (int k = 0; k < count; ++k) {
    const double share = count > 1 ? static_cast<double>(k) / (count - 1) : 0.5;
    const double rate =
        2 * std::numbers::pi * options.slowest * std::pow(options.fastest / options.slowest, share);
    poles.emplace_back(std::exp(-rate));
    poles.push_back(std::exp(rate * std::complex<double>(-options.damping, 1)));
  }
  return poles;
}

/// Whether past errors foresee an input beyond what its own past does (Granger 1969): somebody controls by what is measured.
bool IsFedBack(const StateFit& fit, std::span<const Episode> episodes,
               const MissingDynamicsOptions& options) {
  const Eigen::Index lags = options.feedback_rows, outputs = fit.model->output.rows;
  for (const int input : fit.model->inputs) {
    double alone = 0, with_errors = 0, variation = 0;
    for (std::size_t e = 0; e < episodes.size(); ++e) {
      const Eigen::Index rows = episodes[e].rows() - lags;
      if (rows < 20 * lags) continue;
      const RowMatrix& residual = fit.residuals[e];
      Eigen::VectorXd u = episodes[e].signal.col(input);
      if (!u.allFinite()) continue;
      u.array() -= u.mean();
      Eigen::MatrixXd columns(rows, lags * (1 + outputs) + 1);
      for (Eigen::Index lag = 0; lag < lags; ++lag) {
        columns.col(lag) = u.segment(lag, rows);
        for (Eigen::Index j = 0; j < outputs; ++j)
          columns.col(lags * (1 + j) + lag) = residual.col(j).segment(lag, rows).unaryExpr(
              [&](double value) { return std::isfinite(value) ? value / fit.noise[j] : 0.0; });
      }
      columns.rightCols(1) = u.tail(rows);
      Eigen::MatrixXd own(rows, lags + 1);
      own << columns.leftCols(lags), columns.rightCols(1);
      alone += EnergyLeft(own.transpose() * own);
      with_errors += EnergyLeft(columns.transpose() * columns);
      variation += u.squaredNorm();
    }
    if (alone > 1e-6 * variation && with_errors < (1 - options.feedback) * alone) return true;
  }
  return false;
}

}  // namespace

std::optional<double> FindMissingDynamics(const StateFit& fit, const StateRemainder& left,
                                          std::span<const Episode> episodes,
                                          const MissingDynamicsOptions& options) {
  const int outputs = fit.model->output.rows,
            drivers = static_cast<int>(fit.model->inputs.size()) + fit.model->states(),
            frequencies = std::clamp(options.columns / (3 * drivers * outputs), 1, options.frequencies);
  if (IsFedBack(fit, episodes, options)) return std::nullopt;
  const std::vector<std::complex<double>> poles = Poles(frequencies, options);
  LeftOutColumns columns(fit, episodes.size(), 3 * frequencies * drivers * outputs);
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    const Eigen::MatrixXd past = PastOf(SeriesOf(fit, episodes[e], e), poles);
    std::vector<RowMatrix> series;
    for (Eigen::Index c = 0; c < past.cols(); ++c)
      for (int j = 0; j < outputs; ++j) {
        series.push_back(RowMatrix::Zero(past.rows(), outputs));
        series.back().col(j) = past.col(c);
      }
    std::vector<const RowMatrix*> beside;
    for (const RowMatrix& one : series) beside.push_back(&one);
    beside.push_back(&fit.residuals[e]);
    columns.Add(fit, e, TangentColumns(fit, episodes[e], e, {}, beside));
  }
  const StateRemainder past = columns.Remainder(fit, options.remainder);
  const double least =
      std::max(options.min_share, left.structured ? options.beyond_functions * left.least_share : 0.0);
  if (past.p_value > options.max_p || past.least_share < least) return std::nullopt;
  return past.least_share;
}

Told MissingDynamicsText(double share) {
  return Tell(
      "the past of inputs and states predicts at least {:.0f} % of the error that is left, their present does not: dynamics are "
      "missing (a lag, a further mode, a delay), or a sensor lags. Give the model a state more, or a delay(...)",
      "die Vergangenheit von Eingängen und Zuständen sagt mindestens {:.0f} % des Fehlers voraus, der bleibt, ihre Gegenwart "
      "nicht: Dynamik fehlt (eine Verzögerung, eine weitere Eigenform, eine Totzeit), oder ein Sensor hinkt nach. Dem Modell einen "
      "Zustand mehr geben oder delay(...)",
      100 * share);
}

}  // namespace hydroscope
