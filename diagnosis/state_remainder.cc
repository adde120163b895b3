#include "diagnosis/state_remainder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "core/limits.h"

namespace hydroscope {
namespace {

/// Functions of the states and inputs of a model, each variable over its spread in the run.
class FunctionBank {
 public:
  FunctionBank(const StateFit& fit, std::span<const Episode> episodes, const StateRemainderOptions& options) {
    const StateModel& model = *fit.model;
    states_ = model.states();
    const auto inputs = model.inputs.size();
    for (int v = 0; v < states_ + static_cast<int>(inputs); ++v) {
      std::vector<double> values;
      for (std::size_t e = 0; e < episodes.size(); ++e)
        for (int row = 0; row < episodes[e].rows(); ++row)
          values.push_back(
              v < states_ ? fit.runs[e].states(row, v)
                          : episodes[e].signal(row, model.inputs[static_cast<std::size_t>(v - states_)]));
      AddVariable(std::move(values));
    }
    std::mt19937 random(options.seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
    for (int k = 0; k < options.fourier; ++k) {
      for (std::size_t v = 0; v < middle_.size(); ++v) frequency_.push_back(normal(random));
      phase_.push_back(phase(random));
    }
    const int variables = static_cast<int>(middle_.size());
    pairs_ = variables <= kMostPaired;
    count_ =
        1 + variables * kOfOne + (pairs_ ? variables * (variables - 1) : 0) + static_cast<int>(phase_.size());
  }
  int count() const { return count_; }

  void Values(const double* state, const double* input, double* out) const {
    std::array<double, 2 * kMaxStates + 64> v{};
    const std::size_t n = std::min(middle_.size(), v.size());
    for (std::size_t i = 0; i < n; ++i) {
      const double x = static_cast<int>(i) < states_ ? state[i] : input[static_cast<int>(i) - states_];
      v[i] = std::clamp((x - middle_[i]) / spread_[i], -kFar, kFar);
    }
    *out++ = 1;
    for (std::size_t i = 0; i < n; ++i) {
      *out++ = v[i];
      *out++ = v[i] * v[i];
      *out++ = v[i] * v[i] * v[i];
      *out++ = std::tanh(kSteep * (v[i] - zero_[i]));
      for (const double knot : knots_[i]) *out++ = std::max(v[i] - knot, 0.0);
    }
    for (std::size_t i = 0; pairs_ && i < n; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        *out++ = v[i] * v[j];
        *out++ = v[i] * std::abs(v[j]);
      }
    const double* frequency = frequency_.data();
    for (const double phase : phase_) {
      double angle = phase;
      for (std::size_t i = 0; i < n; ++i) angle += *frequency++ * v[i];
      *out++ = std::cos(angle);
    }
  }

 private:
  static constexpr int kKnots = 6, kOfOne = 4 + kKnots;
  static constexpr double kFar = 10;    ///< a run that leaves what was seen counts no further
  static constexpr double kSteep = 10;  ///< of the smooth sign

  void AddVariable(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) {
      return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
    };
    const double middle = at(0.5);
    const double spread =
        std::max({at(0.95) - at(0.05), 1e-3 * (values.back() - values.front()), 1e-300}) / 2;
    middle_.push_back(middle);
    spread_.push_back(spread);
    zero_.push_back(values.front() < 0 && values.back() > 0 ? -middle / spread : 0);
    std::vector<double> knots;
    for (int k = 0; k < kKnots; ++k) knots.push_back((at((k + 0.5) / kKnots) - middle) / spread);
    knots.back() = (at(0.97) - middle) / spread;
    knots_.push_back(std::move(knots));
  }

  static constexpr int kMostPaired = 5;  ///< variables; of more, products would be too many to tell apart

  int states_ = 0, count_ = 0;
  bool pairs_ = true;
  std::vector<double> middle_, spread_, zero_, frequency_, phase_;
  std::vector<std::vector<double>> knots_;
};

/// Sums of products of one piece: parameters, functions, error.
struct PieceSums {
  Eigen::MatrixXd products;
  double sign = 1;
};

/// Columns: parameters, then functions per equation (kinematic ones left out), then the error.
struct RemainderColumns {
  std::vector<PieceSums> pieces;
  int parameters = 0, functions = 0;
  std::vector<int> equation;  ///< per function: state, or states + output
};

RemainderColumns ColumnsOf(const StateFit& fit, std::span<const Episode> episodes, const FunctionBank& bank) {
  const StateModel& model = *fit.model;
  const int states = model.states(), outputs = model.output.rows, parameters = model.parameter_count();
  RemainderColumns out;
  out.parameters = parameters;
  std::vector<int> kept;  // columns of StateRun::slopes behind parameters and initial states
  for (int e = 0; e < states + outputs; ++e) {
    if (e < states && model.rate_of[static_cast<std::size_t>(e)] >= 0) continue;
    for (int k = 0; k < bank.count(); ++k) {
      kept.push_back(e * bank.count() + k);
      out.equation.push_back(e);
    }
  }
  out.functions = static_cast<int>(kept.size());
  AddedTerms added{bank.count(), [&](const double* x, const double* u, double* v) { bank.Values(x, u, v); }};
  StateSimulator simulator(fit.model);
  simulator.SetParameters(fit.parameters);
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    std::vector<int> free;
    for (int i = 0; i < states; ++i)
      if (model.estimated[static_cast<std::size_t>(i)]) free.push_back(i);
    RowMatrix start = RowMatrix::Zero(states, parameters + static_cast<int>(free.size())), by_parameter;
    simulator.Initial(episodes[e], fit.initial[e], &by_parameter);
    start.leftCols(parameters) = by_parameter;
    for (std::size_t k = 0; k < free.size(); ++k) start(free[k], parameters + static_cast<int>(k)) = 1;
    StateRun run;
    simulator.Run(episodes[e], 0, episodes[e].rows() - 1, fit.initial[e], &start, run, &added);
    const Eigen::Index own = start.cols(), rows = run.slopes.rows();
    RowMatrix columns(rows, parameters + out.functions + 1);
    columns.leftCols(parameters) = run.slopes.leftCols(parameters);
    for (int k = 0; k < out.functions; ++k)
      columns.col(parameters + k) = run.slopes.col(own + kept[static_cast<std::size_t>(k)]);
    for (int row = 0; row < episodes[e].rows(); ++row)
      for (int j = 0; j < outputs; ++j)
        columns(row * outputs + j, columns.cols() - 1) = fit.residuals[e](row, j);
    RowMatrix local = run.slopes.middleCols(parameters, own - parameters);
    for (Eigen::Index r = 0; r < rows; ++r) {
      const auto j = static_cast<Eigen::Index>(r % outputs);
      const bool good = columns.row(r).allFinite();
      const double weight = good ? 1 / fit.noise[j] : 0.0;
      if (!good) columns.row(r).setZero();
      columns.row(r) *= weight;
      local.row(r) *= weight;
    }
    if (local.cols() > 0) {
      const Eigen::HouseholderQR<Eigen::MatrixXd> qr(local);
      const Eigen::MatrixXd basis = qr.householderQ() * Eigen::MatrixXd::Identity(rows, local.cols());
      columns -= basis * (basis.transpose() * columns);
    }
    for (const StatePiece& piece : fit.pieces) {
      if (piece.episode != static_cast<int>(e)) continue;
      const auto part = columns.middleRows(piece.first * outputs, (piece.last - piece.first) * outputs);
      PieceSums sums;
      sums.products = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
      sums.products.selfadjointView<Eigen::Lower>().rankUpdate(part.transpose());
      sums.products.triangularView<Eigen::StrictlyUpper>() = sums.products.transpose();
      out.pieces.push_back(std::move(sums));
    }
  }
  return out;
}

/// Ridge regression of the error on the functions, parameters unpenalised, with groups of pieces left out in turn. One
/// factorisation serves every flip of signs.
class LeaveOut {
 public:
  LeaveOut(const RemainderColumns& columns, double penalty) : columns_(columns) {
    constexpr std::size_t kFolds = 8;
    const Eigen::Index size = columns.parameters + columns.functions;
    Eigen::MatrixXd total = Eigen::MatrixXd::Zero(size, size);
    for (const PieceSums& piece : columns.pieces) total += piece.products.topLeftCorner(size, size);
    scale_ = total.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const std::size_t folds = std::min(kFolds, columns.pieces.size());
    for (std::size_t f = 0; f < folds; ++f) {
      Fold fold;
      Eigen::MatrixXd rest = total;
      for (std::size_t p = f * columns.pieces.size() / folds; p < (f + 1) * columns.pieces.size() / folds;
           ++p) {
        fold.pieces.push_back(p);
        rest -= columns.pieces[p].products.topLeftCorner(size, size);
      }
      rest = scale_.asDiagonal() * rest * scale_.asDiagonal();
      for (Eigen::Index i = 0; i < size; ++i) rest(i, i) += i < columns.parameters ? 1e-9 : penalty;
      fold.all.compute(rest);
      fold.own.compute(rest.topLeftCorner(columns.parameters, columns.parameters));
      folds_.push_back(std::move(fold));
    }
  }

  /// Error energies left out: with the parameters alone, and with the functions.
  std::pair<double, double> Energies(const std::vector<double>& signs) const {
    const Eigen::Index size = columns_.parameters + columns_.functions, error = size;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
    for (std::size_t p = 0; p < columns_.pieces.size(); ++p)
      gradient += signs[p] * columns_.pieces[p].products.col(error).head(size);
    double own = 0, all = 0;
    for (const Fold& fold : folds_) {
      Eigen::VectorXd rest = gradient;
      for (const std::size_t p : fold.pieces)
        rest -= signs[p] * columns_.pieces[p].products.col(error).head(size);
      rest = scale_.cwiseProduct(rest);
      Eigen::VectorXd with = scale_.cwiseProduct(fold.all.solve(rest));
      Eigen::VectorXd alone = Eigen::VectorXd::Zero(size);
      if (columns_.parameters > 0)
        alone.head(columns_.parameters) =
            scale_.head(columns_.parameters).cwiseProduct(fold.own.solve(rest.head(columns_.parameters)));
      for (const std::size_t p : fold.pieces) {
        const Eigen::MatrixXd& sums = columns_.pieces[p].products;
        const auto left = [&](const Eigen::VectorXd& w) {
          return sums(error, error) - 2 * signs[p] * w.dot(sums.col(error).head(size)) +
                 w.dot(sums.topLeftCorner(size, size) * w);
        };
        own += left(alone);
        all += left(with);
      }
    }
    return {own, all};
  }

 private:
  struct Fold {
    std::vector<std::size_t> pieces;
    Eigen::LDLT<Eigen::MatrixXd> all, own;
  };
  const RemainderColumns& columns_;
  Eigen::VectorXd scale_;
  std::vector<Fold> folds_;
};

/// Largest share over all penalties.
double ShareOf(const std::vector<LeaveOut>& ridges, const std::vector<double>& signs) {
  double best = 0;
  for (const LeaveOut& ridge : ridges) {
    const auto [own, all] = ridge.Energies(signs);
    if (own > 0) best = std::max(best, 1 - all / own);
  }
  return best;
}

std::vector<LeaveOut> RidgesOf(const RemainderColumns& columns) {
  std::vector<LeaveOut> ridges;
  for (const double penalty : {1e-6, 1e-4, 1e-2, 1.0}) ridges.emplace_back(columns, penalty);
  return ridges;
}

/// The equation whose functions alone predict most.
std::string MostIn(const StateFit& fit, const RemainderColumns& columns) {
  const StateModel& model = *fit.model;
  std::string about;
  double most = 0;
  for (int e = 0; e < model.states() + model.output.rows; ++e) {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < columns.parameters; ++i) kept.push_back(i);
    for (std::size_t k = 0; k < columns.equation.size(); ++k)
      if (columns.equation[k] == e) kept.push_back(columns.parameters + static_cast<Eigen::Index>(k));
    if (kept.size() == static_cast<std::size_t>(columns.parameters)) continue;
    RemainderColumns some;
    some.parameters = columns.parameters;
    some.functions = static_cast<int>(kept.size()) - columns.parameters;
    kept.push_back(columns.parameters + columns.functions);
    for (const PieceSums& piece : columns.pieces) some.pieces.push_back({piece.products(kept, kept), 1});
    const double share = ShareOf(RidgesOf(some), std::vector<double>(some.pieces.size(), 1.0));
    if (share <= most) continue;
    most = share;
    about = e < model.states()
                ? model.machine.states.states[static_cast<std::size_t>(e)].name
                : model.machine.states.outputs[static_cast<std::size_t>(e - model.states())].signal;
  }
  return about;
}

}  // namespace

StateRemainder RemainderOf(const StateFit& fit, std::span<const Episode> episodes,
                           const StateRemainderOptions& options) {
  const FunctionBank bank(fit, episodes, options);
  const RemainderColumns columns = ColumnsOf(fit, episodes, bank);
  StateRemainder out;
  out.functions = columns.functions;
  if (columns.pieces.size() < 2) return out;
  const std::vector<LeaveOut> ridges = RidgesOf(columns);
  std::vector<double> signs(columns.pieces.size(), 1.0);
  out.share = ShareOf(ridges, signs);
  std::mt19937 random(options.seed);
  std::vector<double> null;
  for (int k = 0; k < options.flips; ++k) {
    for (double& sign : signs) sign = random() % 2 == 0 ? 1.0 : -1.0;
    null.push_back(ShareOf(ridges, signs));
  }
  std::sort(null.begin(), null.end());
  const auto beyond = std::count_if(null.begin(), null.end(), [&](double n) { return n >= out.share; });
  out.p_value = (1.0 + static_cast<double>(beyond)) / (1.0 + static_cast<double>(null.size()));
  out.null_share = null[null.size() * 19 / 20];
  out.structured = out.p_value <= options.max_p && out.share >= options.min_share;
  if (out.structured) out.about = MostIn(fit, columns);
  return out;
}

}  // namespace hydroscope
