#include "estimation/closed_loop/transfer_fit.h"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/distributions.h"
#include "core/told_error.h"
#include "estimation/closed_loop/open_parameters.h"
#include "estimation/decompositions.h"
#include "estimation/frequency_response/second_order.h"
#include "estimation/frequency_response/welch.h"

namespace hydroscope {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using LoopKind = LoopParameter::Kind;

// A plant that integrates and has a corner falls with the square of the frequency and more: images beyond the second are
// below a thousandth.
constexpr int kImagesOfPlant = 2;
constexpr std::size_t kPointsOfLoopSearch = 40;  // more do not tell one valley from another
constexpr std::size_t kPolishedStarts = 8;
constexpr int kPasses = 3;            // noise from the ratio, then twice from the model
constexpr double kSameValley = 1e-3;  // relative difference of chi^2 of two ends of the search in one valley
// Chance of a smaller chi^2 from noise alone, from which intervals are widened.
constexpr double kLikelyMisfit = 0.999;
constexpr double kMeanSquareOfHann = 3.0 / 8;
constexpr double kSlopeStep = 1e-5;  // of a search coordinate: its slopes are good to 1e-9

/// One frequency as the fit sees it.
struct LoopTarget {
  std::size_t bin = 0;
  double frequency = 0;
  Complex difference;  // of the output, to be multiplied with the model
  Complex ru, ry;
  double sigma = 1;  // of real and of imaginary part of ry - g ru
};

/// LoopSearch coordinates: logarithms of positive parameters, gain over its first value, delay in rows.
class LoopSearch {
 public:
  LoopSearch(const TransferModel& model, double sample_period, bool free_delay)
      : model_(model), sample_period_(sample_period) {
    const auto parameters = model.plant->parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i)
      if (free_delay || parameters[i].kind != LoopKind::kDelay) free_.push_back(i);
  }

  std::size_t size() const { return free_.size(); }
  const std::vector<std::size_t>& free() const { return free_; }
  LoopKind KindOf(std::size_t coordinate) const { return model_.plant->parameters[free_[coordinate]].kind; }
  void set_gain_scale(double scale) { gain_scale_ = scale; }

  VectorXd Coordinates(const std::vector<double>& parameters) const {
    VectorXd p(static_cast<std::ptrdiff_t>(size()));
    for (std::size_t k = 0; k < size(); ++k) {
      const double value = parameters[free_[k]];
      p(static_cast<std::ptrdiff_t>(k)) = KindOf(k) == LoopKind::kPositive ? std::log(value)
                                          : KindOf(k) == LoopKind::kGain   ? value / gain_scale_
                                                                           : value / sample_period_;
    }
    return p;
  }
  std::vector<double> Parameters(const VectorXd& p) const {
    std::vector<double> parameters(model_.plant->parameters.size(), 0.0);
    for (std::size_t k = 0; k < size(); ++k) {
      const double x = p(static_cast<std::ptrdiff_t>(k));
      parameters[free_[k]] = KindOf(k) == LoopKind::kPositive ? std::exp(x)
                             : KindOf(k) == LoopKind::kGain   ? x * gain_scale_
                                                              : x * sample_period_;
    }
    return parameters;
  }
  /// Change of the parameter, SI, with the coordinate.
  double Slope(std::size_t coordinate, const VectorXd& p) const {
    if (KindOf(coordinate) == LoopKind::kPositive)
      return std::exp(p(static_cast<std::ptrdiff_t>(coordinate)));
    return KindOf(coordinate) == LoopKind::kGain ? gain_scale_ : sample_period_;
  }
  /// Change of the logarithm (of a delay: s) with the coordinate.
  double LogSlope(std::size_t coordinate, const VectorXd& p) const {
    if (KindOf(coordinate) == LoopKind::kPositive) return 1;
    return KindOf(coordinate) == LoopKind::kGain ? 1 / p(static_cast<std::ptrdiff_t>(coordinate))
                                                 : sample_period_;
  }
  const TransferModel& model() const { return model_; }

 private:
  const TransferModel& model_;
  double sample_period_;
  std::vector<std::size_t> free_;
  double gain_scale_ = 1;
};

/// The misfit as Ceres asks for it.
struct LoopMisfit {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  const std::vector<LoopTarget>& targets;
  const LoopSearch& search;

  int NumResiduals() const { return static_cast<int>(2 * targets.size()); }
  int NumParameters() const { return static_cast<int>(search.size()); }

  void Responses(const VectorXd& p, std::vector<Complex>& responses) const {
    const std::vector<double> parameters = search.Parameters(p);
    responses.resize(targets.size());
    for (std::size_t i = 0; i < targets.size(); ++i)
      responses[i] = targets[i].difference * search.model().Response(targets[i].frequency, parameters);
  }
  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    const VectorXd p = Eigen::Map<const VectorXd>(parameters, NumParameters());
    std::vector<Complex> response, up, down;
    Responses(p, response);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const Complex misfit = (response[i] * targets[i].ru - targets[i].ry) / targets[i].sigma;
      residuals[2 * i] = misfit.real();
      residuals[2 * i + 1] = misfit.imag();
      if (!std::isfinite(misfit.real()) || !std::isfinite(misfit.imag())) return false;
    }
    if (jacobian == nullptr) return true;
    for (int k = 0; k < NumParameters(); ++k) {
      VectorXd changed = p;
      changed(k) = p(k) + kSlopeStep;
      Responses(changed, up);
      changed(k) = p(k) - kSlopeStep;
      Responses(changed, down);
      for (std::size_t i = 0; i < targets.size(); ++i) {
        const Complex slope = (up[i] - down[i]) * targets[i].ru / (2 * kSlopeStep * targets[i].sigma);
        jacobian[k * NumResiduals() + static_cast<int>(2 * i)] = slope.real();
        jacobian[k * NumResiduals() + static_cast<int>(2 * i + 1)] = slope.imag();
      }
    }
    return true;
  }
};

double ChiSquared(const std::vector<LoopTarget>& targets, const LoopSearch& search, const VectorXd& p) {
  VectorXd residuals(static_cast<std::ptrdiff_t>(2 * targets.size()));
  return LoopMisfit{targets, search}(p.data(), residuals.data(), nullptr)
             ? residuals.squaredNorm()
             : std::numeric_limits<double>::infinity();
}

double PolishLoop(const std::vector<LoopTarget>& targets, const LoopSearch& search, VectorXd& p,
                  int iterations) {
  ceres::TinySolver<LoopMisfit> solver;
  solver.options.function_tolerance = 1e-9;
  solver.options.parameter_tolerance = 1e-12;
  solver.options.gradient_tolerance = 0;
  solver.options.cost_threshold = 0;
  solver.options.max_num_iterations = iterations;
  const double cost = 2 * solver.Solve({targets, search}, &p).final_cost;
  return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
}

/// Brings the parameters to those that are meant among equals; false if they are.
bool Settle(const LoopSearch& search, VectorXd& p) {
  const ClosedLoopPlant& plant = *search.model().plant;
  std::vector<double> parameters = search.Parameters(p);
  if (plant.share_out == nullptr || !plant.share_out(parameters, 0)) return false;
  const VectorXd settled = search.Coordinates(parameters);
  if (!settled.allFinite() || (settled - p).norm() < kSlopeStep) return false;
  p = settled;
  return true;
}

/// Noise of each target from `response` (times the difference).
template <typename Response>
void TakeNoise(const LoopSpectra& spectra, std::vector<LoopTarget>& targets, Response response) {
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const LoopSums& sums = spectra.bins[targets[i].bin];
    const double independent = spectra.segments * kIndependentShareOfSegment;
    const double noise =
        std::max(sums.Residual(response(i)), 1e-12 * sums.yy) / std::max(1.0, independent - 1);
    targets[i].sigma = std::sqrt(sums.rr * noise / 2);
  }
}

void TakeNoiseOfRatio(const LoopSpectra& spectra, std::vector<LoopTarget>& targets) {
  TakeNoise(spectra, targets, [&](std::size_t i) { return spectra.bins[targets[i].bin].Ratio(); });
}

/// Of equal steps of log frequency the target each that says most.
std::vector<LoopTarget> ThinnedTargets(const std::vector<LoopTarget>& targets) {
  if (targets.size() <= kPointsOfLoopSearch) return targets;
  const double first = std::log(targets.front().frequency), span = std::log(targets.back().frequency) - first;
  const auto said = [](const LoopTarget& t) { return std::abs(t.ry) / t.sigma; };
  std::vector<LoopTarget> thinned;
  std::size_t step = kPointsOfLoopSearch;
  for (const LoopTarget& target : targets) {
    const double place =
        (std::log(target.frequency) - first) / span * static_cast<double>(kPointsOfLoopSearch);
    const std::size_t here = std::min(kPointsOfLoopSearch - 1, static_cast<std::size_t>(place));
    if (here != step)
      thinned.push_back(target);
    else if (said(target) > said(thinned.back()))
      thinned.back() = target;
    step = here;
  }
  return thinned;
}

/// Every combination of the starts of positive parameters, the gain 1 and the delay 0.
std::vector<std::vector<double>> Combinations(const ClosedLoopPlant& plant) {
  std::vector<std::vector<double>> all = {{}};
  for (const LoopParameter& parameter : plant.parameters) {
    const double fixed[] = {parameter.kind == LoopKind::kGain ? 1.0 : 0.0};
    std::vector<std::vector<double>> longer;
    for (const std::vector<double>& begun : all) {
      for (const double value :
           parameter.kind == LoopKind::kPositive ? parameter.starts : std::span<const double>(fixed)) {
        longer.push_back(begun);
        longer.back().push_back(value);
      }
    }
    all = std::move(longer);
  }
  return all;
}

/// Sets the gain to its best value, the others given.
void ProjectGain(const std::vector<LoopTarget>& targets, const TransferModel& model,
                 std::vector<double>& parameters) {
  const auto gain = std::ranges::find_if(model.plant->parameters,
                                         [](const LoopParameter& p) { return p.kind == LoopKind::kGain; });
  if (gain == model.plant->parameters.end()) return;
  double along = 0, squared = 0;
  for (const LoopTarget& t : targets) {
    const Complex shape = t.difference * model.Response(t.frequency, parameters) * t.ru / t.sigma;
    along += (std::conj(shape) * t.ry).real() / t.sigma;
    squared += std::norm(shape);
  }
  parameters[gain - model.plant->parameters.begin()] *= along / squared;
}

double GainOf(const TransferModel& model, const std::vector<double>& parameters) {
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (model.plant->parameters[i].kind == LoopKind::kGain) return parameters[i];
  return 1;
}

/// Where the starts lead to, few points looked at, best first.
std::vector<TransferMinimum> Valleys(const std::vector<LoopTarget>& all, LoopSearch& search) {
  const std::vector<LoopTarget> targets = ThinnedTargets(all);
  std::vector<std::pair<double, std::vector<double>>> starts;
  for (std::vector<double>& start : Combinations(*search.model().plant)) {
    ProjectGain(targets, search.model(), start);
    search.set_gain_scale(GainOf(search.model(), start));
    starts.emplace_back(ChiSquared(targets, search, search.Coordinates(start)), std::move(start));
  }
  std::ranges::sort(starts, [](const auto& a, const auto& b) { return a.first < b.first; });
  starts.resize(std::min(starts.size(), kPolishedStarts));
  std::vector<TransferMinimum> valleys;
  for (const auto& [cost, start] : starts) {
    search.set_gain_scale(GainOf(search.model(), start));
    VectorXd p = search.Coordinates(start);
    double end = PolishLoop(targets, search, p, 60);
    // Where poles coincide the search stands still between two ways to share them out.
    if (Settle(search, p)) end = PolishLoop(targets, search, p, 60);
    if (!std::isfinite(end)) continue;
    const auto known = std::ranges::find_if(valleys, [end = end](const TransferMinimum& v) {
      return std::abs(v.chi_squared - end) <= kSameValley * end;
    });
    if (known != valleys.end())
      ++known->starts;
    else
      valleys.push_back({search.Parameters(p), end, 1});
  }
  std::ranges::sort(valleys, [](const auto& a, const auto& b) { return a.chi_squared < b.chi_squared; });
  return valleys;
}

/// Errors of a part of the record, as LoopMisfit has those of all of it.
VectorXd ErrorsOfBlock(const std::vector<LoopSums>& block, const std::vector<LoopTarget>& targets,
                       const std::vector<Complex>& responses) {
  VectorXd errors(static_cast<std::ptrdiff_t>(2 * targets.size()));
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const LoopSums& sums = block[targets[i].bin];
    const Complex e = (responses[i] * sums.ru - sums.ry) / targets[i].sigma;
    errors(static_cast<std::ptrdiff_t>(2 * i)) = e.real();
    errors(static_cast<std::ptrdiff_t>(2 * i + 1)) = e.imag();
  }
  return errors;
}

/// Slopes of a part's errors by the search coordinates.
MatrixXd SlopesOfBlock(const std::vector<LoopSums>& block, const std::vector<LoopTarget>& targets,
                       const MatrixXd& jacobian) {
  MatrixXd slopes(jacobian.rows(), jacobian.cols());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Complex share = block[targets[i].bin].ru / targets[i].ru;
    const auto re = static_cast<std::ptrdiff_t>(2 * i), im = re + 1;
    slopes.row(re) = share.real() * jacobian.row(re) - share.imag() * jacobian.row(im);
    slopes.row(im) = share.imag() * jacobian.row(re) + share.real() * jacobian.row(im);
  }
  return slopes;
}

/// Sandwich: inverse of J'J around the sum over blocks of the squares of what each pulls.
MatrixXd ClusteredCovariance(const LoopSpectra& spectra, const std::vector<LoopTarget>& targets,
                             const LoopSearch& search, const VectorXd& p) {
  const LoopMisfit misfit{targets, search};
  VectorXd residuals(misfit.NumResiduals());
  MatrixXd jacobian(misfit.NumResiduals(), misfit.NumParameters());
  misfit(p.data(), residuals.data(), jacobian.data());
  std::vector<Complex> responses;
  misfit.Responses(p, responses);
  MatrixXd pulls(static_cast<std::ptrdiff_t>(spectra.blocks.size()), jacobian.cols());
  for (std::size_t b = 0; b < spectra.blocks.size(); ++b)
    pulls.row(static_cast<std::ptrdiff_t>(b)) =
        (jacobian.transpose() * ErrorsOfBlock(spectra.blocks[b], targets, responses)).transpose();
  // The fit has taken out of the pulls as many directions as it has parameters.
  const double blocks = static_cast<double>(spectra.blocks.size());
  const MatrixXd meat =
      blocks / std::max(1.0, blocks - static_cast<double>(search.size())) * pulls.transpose() * pulls;
  const VectorXd scale = jacobian.colwise().norm().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * (jacobian.transpose() * jacobian) * scale.asDiagonal();
  const MatrixXd bread = scale.asDiagonal() * Inverse(scaled) * scale.asDiagonal();
  return bread * meat * bread;
}

std::vector<LoopTarget> TargetsOf(const LoopSpectra& spectra, const std::vector<std::size_t>& used) {
  std::vector<LoopTarget> targets;
  for (const std::size_t bin : used) {
    const double frequency = spectra.Frequency(bin);
    targets.push_back(
        {bin, frequency, spectra.Difference(frequency), spectra.bins[bin].ru, spectra.bins[bin].ry});
  }
  return targets;
}

}  // namespace

Complex TransferModel::Response(double frequency, const std::vector<double>& parameters) const {
  double delay = 0;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (plant->parameters[i].kind == LoopKind::kDelay) delay += parameters[i];
  Complex sum = 0;
  ForEachImage(
      kTwoPi * frequency, hold,
      [&](double omega, Complex factor) {
        sum += Times(Times(factor, plant->response({0, omega}, parameters, geometry)),
                     std::polar(1.0, -omega * delay));
      },
      kImagesOfPlant);
  return sum;
}

double TransferFit::Widening() const {
  const double degrees = std::max(1.0, blocks - static_cast<double>(parameters.size()));
  return StudentHalfWidth95(degrees) / kNormal95;
}

Result<TransferFit> FitTransfer(const LoopSpectra& spectra, const std::vector<std::size_t>& used,
                                const TransferModel& model, const TransferFitOptions& options) {
  LoopSearch search(model, spectra.sample_period, options.free_delay);
  std::vector<LoopTarget> targets = TargetsOf(spectra, used);
  if (targets.size() <= search.size())
    return BadInput("a model of {} parameters needs more than as many frequencies, {} are usable",
                    search.size(), targets.size());
  TakeNoiseOfRatio(spectra, targets);

  TransferFit fit;
  if (options.near != nullptr)
    fit.parameters = options.near->parameters;
  else if (fit.minima = Valleys(targets, search); !fit.minima.empty())
    fit.parameters = fit.minima.front().parameters;
  else
    return BadInput(
        "no start leads to a response of this plant: check the columns of set point, input and output");
  search.set_gain_scale(GainOf(model, fit.parameters));
  VectorXd p = search.Coordinates(fit.parameters);
  for (int pass = 0; pass < kPasses; ++pass) {
    if (pass > 0) {
      std::vector<Complex> responses;
      LoopMisfit{targets, search}.Responses(p, responses);
      TakeNoise(spectra, targets, [&](std::size_t i) { return responses[i]; });
    }
    fit.chi_squared = PolishLoop(targets, search, p, 100);
    if (Settle(search, p)) fit.chi_squared = PolishLoop(targets, search, p, 100);
  }
  if (!std::isfinite(fit.chi_squared)) return BadInput("the response diverges at every step of the search");
  fit.parameters = search.Parameters(p);
  fit.lowest = targets.front().frequency;
  fit.highest = targets.back().frequency;
  fit.degrees_of_freedom = static_cast<int>(2 * targets.size() - search.size());
  fit.blocks = static_cast<double>(spectra.blocks.size());

  MatrixXd covariance = ClusteredCovariance(spectra, targets, search, p);
  const double independent = fit.degrees_of_freedom / kHannCorrelation;
  if (ChiSquaredBelow(fit.chi_squared / kHannCorrelation, std::max(1.0, independent)) > kLikelyMisfit)
    fit.inflation = std::max(1.0, std::sqrt(fit.chi_squared / fit.degrees_of_freedom));
  if (!covariance.allFinite()) return BadInput(WhyParametersStayOpen(spectra, used, fit));
  const auto all = static_cast<std::ptrdiff_t>(fit.parameters.size());
  fit.covariance = MatrixXd::Zero(all, all);
  for (std::size_t i = 0; i < search.size(); ++i)
    for (std::size_t j = 0; j < search.size(); ++j)
      fit.covariance(static_cast<std::ptrdiff_t>(search.free()[i]),
                     static_cast<std::ptrdiff_t>(search.free()[j])) =
          covariance(static_cast<std::ptrdiff_t>(i), static_cast<std::ptrdiff_t>(j)) * search.LogSlope(i, p) *
          search.LogSlope(j, p) * fit.inflation * fit.inflation;
  return fit;
}

LinearisedEpisode LineariseTransfer(const LoopSpectra& spectra, const std::vector<std::size_t>& used,
                                    const TransferModel& model, const std::vector<double>& parameters,
                                    const std::vector<double>& slopes_of) {
  LoopSearch search(model, spectra.sample_period, true);
  search.set_gain_scale(GainOf(model, slopes_of));
  const VectorXd p = search.Coordinates(parameters), from = search.Coordinates(slopes_of);
  std::vector<LoopTarget> targets = TargetsOf(spectra, used);
  TakeNoiseOfRatio(spectra, targets);
  const LoopMisfit misfit{targets, search};
  VectorXd errors(misfit.NumResiduals());
  MatrixXd slopes(misfit.NumResiduals(), misfit.NumParameters());
  misfit(from.data(), errors.data(), slopes.data());
  misfit(p.data(), errors.data(), nullptr);
  for (std::size_t k = 0; k < search.size(); ++k)
    slopes.col(static_cast<std::ptrdiff_t>(k)) /= search.Slope(k, from);  // by SI units of the parameters
  std::vector<Complex> responses;
  misfit.Responses(p, responses);
  const MatrixXd weighted = slopes.transpose() / kHannCorrelation;
  LinearisedEpisode out;
  for (const std::vector<LoopSums>& block : spectra.blocks)
    out.pieces.push_back({weighted * SlopesOfBlock(block, targets, slopes),
                          -weighted * ErrorsOfBlock(block, targets, responses)});
  out.energy = errors.squaredNorm() / kHannCorrelation;
  out.readings = static_cast<int>(static_cast<double>(errors.size()) / kHannCorrelation);
  return out;
}

double RemainderOfTransfer(const LoopSpectra& spectra, const std::vector<std::size_t>& used,
                           const TransferModel& model, const std::vector<double>& parameters) {
  const double length = static_cast<double>(spectra.segment_length);
  const double per_bin = 2 / (length * length * kMeanSquareOfHann) / spectra.segments;
  double mean_square = 0;
  for (const std::size_t bin : used) {
    const double frequency = spectra.Frequency(bin);
    const Complex difference = spectra.Difference(frequency);
    const double left = spectra.bins[bin].Residual(difference * model.Response(frequency, parameters));
    mean_square += per_bin * left / std::norm(difference);
  }
  return std::sqrt(mean_square);
}

}  // namespace hydroscope
