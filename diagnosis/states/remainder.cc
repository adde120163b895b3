#include "diagnosis/states/remainder.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "diagnosis/states/function_bank.h"
#include "diagnosis/states/tangent.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

/// Products of columns (parameters, then functions per equation but kinematic ones) over groups of neighbouring pieces of the
/// log, and per piece those with the error.
struct RemainderColumns {
  std::vector<Eigen::MatrixXd> groups;
  std::vector<Eigen::Index> group_end;  ///< per group: one past its last piece
  Eigen::MatrixXd gradient;             ///< column x piece
  Eigen::VectorXd energy;               ///< of the error, per piece
  int parameters = 0, functions = 0;
  std::vector<int> equation;  ///< per function: state, or states + output

  Eigen::Index pieces() const { return energy.size(); }
};

/// One past the last piece of each group. Where there are as many episodes they stay whole: how an episode begins would predict
/// its own pieces.
std::vector<Eigen::Index> GroupEnds(const std::vector<StatePiece>& pieces, std::size_t episodes,
                                    Eigen::Index groups) {
  const auto count = static_cast<Eigen::Index>(pieces.size());
  const bool whole = episodes >= static_cast<std::size_t>(groups);
  std::vector<Eigen::Index> ends;
  for (Eigen::Index g = 0; g < groups; ++g) {
    auto end = static_cast<std::size_t>((g + 1) * count / groups);
    while (whole && end < pieces.size() && pieces[end].episode == pieces[end - 1].episode) ++end;
    ends.push_back(static_cast<Eigen::Index>(end));
  }
  return ends;
}

RemainderColumns ColumnsOf(const StateFit& fit, std::span<const Episode> episodes, const FunctionBank& bank) {
  constexpr Eigen::Index kGroups = 8;
  RemainderColumns out;
  const AddedTerms added = bank.Terms(out.equation);
  out.parameters = fit.model->parameter_count();
  out.functions = added.columns;
  const Eigen::Index size = out.parameters + out.functions, outputs = fit.model->output.rows,
                     count = static_cast<Eigen::Index>(fit.pieces.size()), groups = std::min(kGroups, count);
  out.gradient.resize(size, count);
  out.energy.resize(count);
  out.groups.assign(static_cast<std::size_t>(groups), Eigen::MatrixXd::Zero(size, size));
  out.group_end = GroupEnds(fit.pieces, episodes.size(), groups);
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    const RowMatrix columns = TangentColumns(fit, episodes[e], e, added, {&fit.residuals[e]});
    for (Eigen::Index p = 0, g = 0; p < count; ++p) {
      while (p >= out.group_end[static_cast<std::size_t>(g)]) ++g;
      const StatePiece& piece = fit.pieces[static_cast<std::size_t>(p)];
      if (piece.episode != static_cast<int>(e)) continue;
      const auto rows = columns.middleRows(piece.first * outputs, (piece.last - piece.first) * outputs);
      const auto functions = rows.leftCols(size);
      out.groups[static_cast<std::size_t>(g)].selfadjointView<Eigen::Lower>().rankUpdate(
          functions.transpose());
      out.gradient.col(p) = functions.transpose() * rows.col(size);
      out.energy[p] = rows.col(size).squaredNorm();
    }
  }
  for (Eigen::MatrixXd& group : out.groups) group.triangularView<Eigen::StrictlyUpper>() = group.transpose();
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
    const Eigen::Index size = columns.parameters + columns.functions;
    Eigen::MatrixXd total = Eigen::MatrixXd::Zero(size, size);
    for (const Eigen::MatrixXd& group : columns.groups) total += group;
    scale_ = total.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    total_ = scale_.asDiagonal() * total * scale_.asDiagonal();
    gradient_ = scale_.asDiagonal() * columns.gradient;
  }

  std::vector<LeftOutForms> Forms(std::initializer_list<double> penalties) const {
    const Eigen::Index pieces = columns_.pieces(), own = columns_.parameters, functions = columns_.functions;
    const LeftOutForms none{Eigen::MatrixXd::Zero(pieces, pieces), Eigen::MatrixXd::Zero(pieces, pieces)};
    std::vector<LeftOutForms> out(penalties.size(), none);
    Eigen::Index first = 0;
    for (std::size_t g = 0; g < columns_.groups.size(); ++g) {
      const Group group{first, columns_.group_end[g],
                        scale_.asDiagonal() * columns_.groups[g] * scale_.asDiagonal()};
      first = group.end;
      Eigen::MatrixXd rest = total_ - group.products, gradient = gradient_;
      gradient.middleCols(group.first, group.end - group.first).setZero();
      rest.diagonal().head(own).array() += 1e-9;
      Eigen::MatrixXd alone = Eigen::MatrixXd::Zero(own + functions, pieces);
      if (own > 0)
        alone.topRows(own) = PositiveFactor(rest.topLeftCorner(own, own)).SolveColumns(gradient.topRows(own));
      const Eigen::MatrixXd form = FormOf(group, alone);
      double before = 0;
      for (std::size_t k = 0; k < out.size(); ++k) {
        const double penalty = penalties.begin()[k];
        rest.diagonal().tail(functions).array() += penalty - before;
        before = penalty;
        out[k].own += form;
        out[k].all += FormOf(group, PositiveFactor(rest).SolveColumns(gradient));
      }
    }
    return out;
  }

 private:
  struct Group {
    Eigen::Index first, end;  ///< pieces
    Eigen::MatrixXd products;
  };
  Eigen::MatrixXd FormOf(const Group& group, const Eigen::MatrixXd& weights) const {
    const Eigen::Index count = group.end - group.first;
    Eigen::MatrixXd form = weights.transpose() * (group.products * weights);
    const Eigen::MatrixXd cross = weights.transpose() * gradient_.middleCols(group.first, count);
    form.middleCols(group.first, count) -= cross;
    form.middleRows(group.first, count) -= cross.transpose();
    for (Eigen::Index p = group.first; p < group.end; ++p) form(p, p) += columns_.energy[p];
    return form;
  }

  const RemainderColumns& columns_;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd total_, gradient_;
};

std::vector<LeftOutForms> FormsOf(const RemainderColumns& columns) {
  return LeaveOut(columns).Forms({1e-6, 1e-4, 1e-2, 1.0});
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
    for (const Eigen::MatrixXd& group : columns.groups) some.groups.push_back(group(kept, kept));
    some.group_end = columns.group_end;
    some.gradient = columns.gradient(kept, Eigen::all);
    some.energy = columns.energy;
    const double share = ShareOf(FormsOf(some), Eigen::VectorXd::Ones(some.pieces()));
    if (share <= most) continue;
    most = share;
    about = EquationName(model, e);
  }
  return about;
}

/// Energy of the error on the pieces of a fit left out in turn, of that of its error.
double LeftOutOf(const StateFit& fit) {
  double error = 0;
  for (const StatePiece& piece : fit.pieces) error += piece.energy;
  return std::max(1.0, fit.HeldOutEnergy() / std::max(error, 1e-300));
}

}  // namespace

StateRemainder RemainderOf(const StateFit& fit, std::span<const Episode> episodes,
                           const StateRemainderOptions& options) {
  const FunctionBank bank(fit, episodes, options.fourier, options.seed);
  const RemainderColumns columns = ColumnsOf(fit, episodes, bank);
  StateRemainder out;
  out.functions = columns.functions;
  if (columns.pieces() < 2) return out;
  const std::vector<LeftOutForms> forms = FormsOf(columns);
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(columns.pieces());
  out.share = ShareOf(forms, signs);
  const double error = columns.energy.sum();
  if (!(error > 0)) return out;
  double energy = error;
  for (const LeftOutForms& form : forms) energy = std::min(energy, form.Energy(signs));
  out.energy = energy / error;
  out.least_share = std::clamp(1 - out.energy / LeftOutOf(fit), 0.0, out.share);
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
  out.structured = out.p_value <= options.max_p && out.least_share >= options.min_share;
  out.doubtful = !out.structured && out.p_value <= options.doubt_p && out.least_share >= options.doubt_share;
  if (out.structured || out.doubtful) out.about = MostIn(fit, columns);
  return out;
}

}  // namespace hydroscope
