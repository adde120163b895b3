#include "diagnosis/states/remainder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "core/limits.h"
#include "diagnosis/states/tangent.h"

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

/// Columns: parameters, then functions per equation (kinematic ones left out), then the error. Per piece of the log the sums
/// of their products.
struct RemainderColumns {
  std::vector<Eigen::MatrixXd> pieces;
  int parameters = 0, functions = 0;
  std::vector<int> equation;  ///< per function: state, or states + output
};

/// Every function in every equation but those that only say that a state is the rate of another.
AddedTerms TermsOf(const StateModel& model, const FunctionBank& bank, std::vector<int>& equation) {
  AddedTerms added;
  added.values = bank.count();
  added.evaluate = [&bank](const double* x, const double* u, double* v) { bank.Values(x, u, v); };
  for (int e = 0; e < model.states() + model.output.rows; ++e) {
    const bool of_state = e < model.states();
    if (of_state && model.rate_of[static_cast<std::size_t>(e)] >= 0) continue;
    for (int k = 0; k < bank.count(); ++k) {
      (of_state ? added.to_states : added.to_outputs)
          .push_back({k, of_state ? e : e - model.states(), added.columns++});
      equation.push_back(e);
    }
    if (of_state) added.moving = added.columns;
  }
  return added;
}

RemainderColumns ColumnsOf(const StateFit& fit, std::span<const Episode> episodes, const FunctionBank& bank) {
  const StateModel& model = *fit.model;
  const int outputs = model.output.rows;
  RemainderColumns out;
  out.parameters = model.parameter_count();
  const AddedTerms added = TermsOf(model, bank, out.equation);
  out.functions = added.columns;
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    const RowMatrix columns = TangentColumns(fit, episodes[e], e, added);
    for (const StatePiece& piece : fit.pieces) {
      if (piece.episode != static_cast<int>(e)) continue;
      const auto part = columns.middleRows(piece.first * outputs, (piece.last - piece.first) * outputs);
      Eigen::MatrixXd products = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
      products.selfadjointView<Eigen::Lower>().rankUpdate(part.transpose());
      products.triangularView<Eigen::StrictlyUpper>() = products.transpose();
      out.pieces.push_back(std::move(products));
    }
  }
  return out;
}

/// Energies of the error left out as quadratic forms of the signs of the pieces: with parameters alone, and with functions.
struct LeftOutForms {
  Eigen::MatrixXd own, all;

  double Share(const Eigen::VectorXd& signs) const {
    const double alone = signs.dot(own * signs);
    return alone > 0 ? 1 - signs.dot(all * signs) / alone : 0.0;
  }
};

/// Ridge regression of the error on the functions, parameters unpenalised, with groups of pieces left out in turn. With G the
/// products of columns and error (one column per piece), A_f the regression's matrix without group f and M_f, G_f the group's
/// own, signs s give w = A_f^-1 (G - G_f) s and the energy e_f - 2 w' G_f s + w' M_f w, which is quadratic in s.
class LeaveOut {
 public:
  explicit LeaveOut(const RemainderColumns& columns) : columns_(columns) {
    constexpr std::size_t kFolds = 8;
    const Eigen::Index size = columns.parameters + columns.functions;
    const auto count = columns.pieces.size();
    total_ = Eigen::MatrixXd::Zero(size, size);
    gradient_.resize(size, static_cast<Eigen::Index>(count));
    for (std::size_t p = 0; p < count; ++p) {
      total_ += columns.pieces[p].topLeftCorner(size, size);
      gradient_.col(static_cast<Eigen::Index>(p)) = columns.pieces[p].col(size).head(size);
    }
    scale_ = total_.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    total_ = scale_.asDiagonal() * total_ * scale_.asDiagonal();
    gradient_ = scale_.asDiagonal() * gradient_;
    const std::size_t folds = std::min(kFolds, count);
    for (std::size_t f = 0; f < folds; ++f) {
      Fold fold{static_cast<Eigen::Index>(f * count / folds),
                static_cast<Eigen::Index>((f + 1) * count / folds), Eigen::MatrixXd::Zero(size, size)};
      for (Eigen::Index p = fold.first; p < fold.end; ++p)
        fold.products += columns.pieces[static_cast<std::size_t>(p)].topLeftCorner(size, size);
      fold.products = scale_.asDiagonal() * fold.products * scale_.asDiagonal();
      folds_.push_back(std::move(fold));
    }
  }

  LeftOutForms Forms(double penalty) const {
    const Eigen::Index count = gradient_.cols(), size = gradient_.rows(), own = columns_.parameters;
    LeftOutForms out{Eigen::MatrixXd::Zero(count, count), Eigen::MatrixXd::Zero(count, count)};
    for (const Fold& fold : folds_) {
      Eigen::MatrixXd rest = total_ - fold.products, held = Eigen::MatrixXd::Zero(size, count),
                      gradient = gradient_;
      rest.diagonal().head(own).array() += 1e-9;
      rest.diagonal().tail(size - own).array() += penalty;
      held.middleCols(fold.first, fold.end - fold.first) =
          gradient_.middleCols(fold.first, fold.end - fold.first);
      gradient.middleCols(fold.first, fold.end - fold.first).setZero();
      AddForm(fold, held, rest.llt().solve(gradient), out.all);
      Eigen::MatrixXd alone = Eigen::MatrixXd::Zero(size, count);
      if (own > 0) alone.topRows(own) = rest.topLeftCorner(own, own).llt().solve(gradient.topRows(own));
      AddForm(fold, held, alone, out.own);
    }
    return out;
  }

 private:
  struct Fold {
    Eigen::Index first, end;  ///< pieces
    Eigen::MatrixXd products;
  };
  void AddForm(const Fold& fold, const Eigen::MatrixXd& held, const Eigen::MatrixXd& weights,
               Eigen::MatrixXd& form) const {
    const Eigen::Index error = columns_.parameters + columns_.functions;
    const Eigen::MatrixXd cross = weights.transpose() * held;
    form += weights.transpose() * (fold.products * weights) - cross - cross.transpose();
    for (Eigen::Index p = fold.first; p < fold.end; ++p)
      form(p, p) += columns_.pieces[static_cast<std::size_t>(p)](error, error);
  }

  const RemainderColumns& columns_;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd total_, gradient_;
  std::vector<Fold> folds_;
};

std::vector<LeftOutForms> FormsOf(const RemainderColumns& columns) {
  const LeaveOut leave_out(columns);
  std::vector<LeftOutForms> forms;
  for (const double penalty : {1e-6, 1e-4, 1e-2, 1.0}) forms.push_back(leave_out.Forms(penalty));
  return forms;
}

/// Largest share over all penalties.
double ShareOf(const std::vector<LeftOutForms>& forms, const Eigen::VectorXd& signs) {
  double best = 0;
  for (const LeftOutForms& form : forms) best = std::max(best, form.Share(signs));
  return best;
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
    for (const Eigen::MatrixXd& piece : columns.pieces) some.pieces.push_back(piece(kept, kept));
    const double share =
        ShareOf(FormsOf(some), Eigen::VectorXd::Ones(static_cast<Eigen::Index>(some.pieces.size())));
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
  const std::vector<LeftOutForms> forms = FormsOf(columns);
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(columns.pieces.size()));
  out.share = ShareOf(forms, signs);
  std::mt19937 random(options.seed);
  std::vector<double> null;
  for (int k = 0; k < options.flips; ++k) {
    for (double& sign : signs) sign = random() % 2 == 0 ? 1.0 : -1.0;
    null.push_back(ShareOf(forms, signs));
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
