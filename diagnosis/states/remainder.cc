#include "diagnosis/states/remainder.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "diagnosis/states/function_bank.h"
#include "diagnosis/states/tangent.h"

namespace hydroscope {
namespace {

/// Columns: parameters, then functions per equation (kinematic ones left out), then the error. Per piece of the log the sums
/// of their products.
struct RemainderColumns {
  std::vector<Eigen::MatrixXd> pieces;
  int parameters = 0, functions = 0;
  std::vector<int> equation;  ///< per function: state, or states + output
};

RemainderColumns ColumnsOf(const StateFit& fit, std::span<const Episode> episodes, const FunctionBank& bank) {
  RemainderColumns out;
  out.parameters = fit.model->parameter_count();
  const AddedTerms added = bank.Terms(out.equation);
  out.functions = added.columns;
  out.pieces = PieceProducts(fit, episodes, added, {&fit.residuals});
  return out;
}

/// Energies of the error left out as quadratic forms of the signs of the pieces: with parameters alone, and with functions.
struct LeftOutForms {
  Eigen::MatrixXd own, all;

  double Energy(const Eigen::VectorXd& signs) const { return signs.dot(all * signs); }
  double Share(const Eigen::VectorXd& signs) const {
    const double alone = signs.dot(own * signs);
    return alone > 0 ? 1 - Energy(signs) / alone : 0.0;
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
    about = EquationName(model, e);
  }
  return about;
}

}  // namespace

StateRemainder RemainderOf(const StateFit& fit, std::span<const Episode> episodes,
                           const StateRemainderOptions& options) {
  const FunctionBank bank(fit, episodes, options.fourier, options.seed);
  const RemainderColumns columns = ColumnsOf(fit, episodes, bank);
  StateRemainder out;
  out.functions = columns.functions;
  if (columns.pieces.size() < 2) return out;
  const std::vector<LeftOutForms> forms = FormsOf(columns);
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(columns.pieces.size()));
  out.share = ShareOf(forms, signs);
  for (const LeftOutForms& form : forms) out.energy = std::min(out.energy, form.Energy(signs));
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
