#include "diagnosis/drift/curve_learning.h"

#include <algorithm>
#include <cmath>

#include "estimation/decompositions.h"

namespace hydroscope::drift {
namespace {

constexpr double kBinWidth = 1.5;  ///< K
constexpr std::size_t kBinStrokes = 12;
constexpr int kMostBins = 40;
constexpr int kSteps = 6;  ///< of Gauss and Newton

/// Strokes of nearly the same oil temperature, summed.
struct Bin {
  double temperature = 0;
  NormalEquations equations;
  double strokes = 0;
};

std::vector<Bin> BinByTemperature(std::span<const StrokeEvidence> strokes) {
  std::vector<const StrokeEvidence*> order;
  for (const StrokeEvidence& s : strokes) order.push_back(&s);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto* a, const auto* b) { return a->oil_temperature < b->oil_temperature; });
  const double range = order.back()->oil_temperature - order.front()->oil_temperature;
  const double width = std::max(kBinWidth, range / kMostBins);
  std::vector<Bin> bins;
  double low = 0;
  for (const StrokeEvidence* s : order) {
    const bool full = !bins.empty() && bins.back().strokes >= kBinStrokes && s->oil_temperature - low > width;
    if (bins.empty() || full) {
      bins.emplace_back();
      low = s->oil_temperature;
    }
    bins.back().equations += s->equations;
    bins.back().temperature += s->oil_temperature;
    ++bins.back().strokes;
  }
  if (bins.size() > 1 && bins.back().strokes < kBinStrokes) {
    bins[bins.size() - 2].equations += bins.back().equations;
    bins[bins.size() - 2].temperature += bins.back().temperature;
    bins[bins.size() - 2].strokes += bins.back().strokes;
    bins.pop_back();
  }
  for (Bin& bin : bins) bin.temperature /= bin.strokes;
  return bins;
}

/// Mean square of the points about the curve in units of their std, at least 1.
double Misfit(const std::vector<TemperaturePoint>& points, const TemperatureModel& curve) {
  double sum = 0;
  for (const TemperaturePoint& p : points)
    sum += std::pow((p.value - curve.At(p.temperature).value) / p.std, 2);
  return std::max(1.0, sum / std::max<double>(1.0, static_cast<double>(points.size())));
}

/// Terms of the curve that a law over the oil may need.
int TermsOf(OilLaw law) {
  switch (law) {
    case OilLaw::kNone:
      return 1;
    case OilLaw::kViscosity:
      return 3;
    case OilLaw::kSmooth:
      return 2;
  }
  return 2;
}

/// Normal equations of the coefficients of all curves, about the curves as they are.
struct CurveEquations {
  explicit CurveEquations(int coefficients, int quantities)
      : h(Eigen::MatrixXd::Zero(coefficients, coefficients)),
        g(Eigen::VectorXd::Zero(coefficients)),
        points(quantities) {}
  double MeanSquare() const { return std::max(squares / equations, 1e-300); }

  Eigen::MatrixXd h;
  Eigen::VectorXd g;
  std::vector<std::vector<TemperaturePoint>> points;  ///< of each quantity, one a bin
  double squares = 0, equations = 0;
};

class CurveLearning {
 public:
  /// Curves that are constant at the typical values.
  CurveLearning(const WatchedModel& model, const std::vector<Bin>& bins, const Eigen::VectorXd& theta,
                const Eigen::VectorXd& typical)
      : model_(model), bins_(bins), theta_(bins.size(), theta) {
    for (int q = 0; q < model.size(); ++q) {
      std::vector<TemperaturePoint> flat;
      for (const Bin& bin : bins)
        flat.push_back({bin.temperature, typical[q], std::max(std::abs(typical[q]), 1e-30)});
      const OilLaw law = model.quantities()[q].over_oil;
      const CurveFamily family = law == OilLaw::kViscosity ? CurveFamily::kFlow : CurveFamily::kSmooth;
      curves_.push_back(IsEffect(q) ? TemperatureModel::Known(0)
                                    : TemperatureModel::FitTerms(flat, family, TermsOf(law)).value());
      first_.push_back(first_.back() + Terms(q));
    }
  }

  /// One step of Gauss and Newton. Misfit of the bins beyond the noise widens the covariance.
  void Step() {
    const CurveEquations equations = Linearised();
    const Eigen::VectorXd scale = equations.h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd inverse = PseudoInverse(scale.asDiagonal() * equations.h * scale.asDiagonal());
    const Eigen::MatrixXd covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
    const Eigen::VectorXd change = covariance * equations.g;
    for (int q = 0; q < model_.size(); ++q) {
      if (IsEffect(q)) continue;
      // Each quantity is judged alone, so its own information counts, not what the others leave of it.
      const Eigen::MatrixXd own = equations.h.block(first_[q], first_[q], Terms(q), Terms(q));
      const Eigen::VectorXd unit = own.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
      const Eigen::MatrixXd own_inverse = PseudoInverse(unit.asDiagonal() * own * unit.asDiagonal());
      const double misfit = Misfit(equations.points[q], curves_[q]);
      curves_[q].Adjust(
          equations.points[q], change.segment(first_[q], Terms(q)),
          misfit * equations.MeanSquare() * (unit.asDiagonal() * own_inverse * unit.asDiagonal()));
    }
  }

  std::vector<TemperatureModel> Curves() && { return std::move(curves_); }

 private:
  bool IsEffect(int q) const { return model_.quantities()[q].effect; }
  /// Coefficients of a quantity's curve.
  int Terms(int q) const {
    return IsEffect(q) ? 0 : static_cast<int>(curves_[q].Basis(bins_.front().temperature).size());
  }

  CurveEquations Linearised() {
    CurveEquations out(first_.back(), model_.size());
    for (std::size_t b = 0; b < bins_.size(); ++b) AddBin(bins_[b], theta_[b], out);
    return out;
  }

  /// `theta`: where the bin's parameters were, comes out as where they are.
  void AddBin(const Bin& bin, Eigen::VectorXd& theta, CurveEquations& out) const {
    Eigen::VectorXd values(model_.size());
    Eigen::MatrixXd design = Eigen::MatrixXd::Zero(model_.size(), first_.back());
    for (int q = 0; q < model_.size(); ++q) {
      values[q] = curves_[q].At(bin.temperature).value;
      if (!IsEffect(q))
        design.row(q).segment(first_[q], Terms(q)) = curves_[q].Basis(bin.temperature).transpose();
    }
    if (const Eigen::VectorXd solved = model_.Theta(values, theta); solved.size() > 0) theta = solved;
    const Score score = model_.Deviation(bin.equations, theta);
    out.h += design.transpose() * score.information * design;
    out.g += design.transpose() * score.score;
    out.squares += MeanSquaredError(bin.equations, theta) * bin.equations.equations;
    out.equations += bin.equations.equations;
    for (int q = 0; q < model_.size(); ++q)
      if (score.information(q, q) > 0)
        out.points[q].push_back({bin.temperature, values[q] + score.score[q] / score.information(q, q),
                                 std::sqrt(out.MeanSquare() / score.information(q, q))});
  }

  const WatchedModel& model_;
  const std::vector<Bin>& bins_;
  std::vector<Eigen::VectorXd> theta_;  ///< of each bin
  std::vector<TemperatureModel> curves_;
  std::vector<int> first_ = {0};  ///< of each quantity's coefficients; then their number
};

}  // namespace

std::vector<TemperatureModel> LearnCurves(const WatchedModel& model, std::span<const StrokeEvidence> strokes,
                                          const Eigen::VectorXd& theta, const Eigen::VectorXd& typical) {
  const std::vector<Bin> bins = BinByTemperature(strokes);
  CurveLearning learning(model, bins, theta, typical);
  for (int step = 0; step < kSteps; ++step) learning.Step();
  return std::move(learning).Curves();
}

}  // namespace hydroscope::drift
