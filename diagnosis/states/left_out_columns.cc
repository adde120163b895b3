#include "diagnosis/states/left_out_columns.h"

#include <algorithm>
#include <random>

#include "estimation/column_products.h"
#include "estimation/decompositions.h"

namespace hydroscope {
namespace {

constexpr Eigen::Index kGroups = 8;

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

/// Energies of the error left out as quadratic forms of the signs of the pieces: with parameters alone, and with functions.
struct LeftOutForms {
  Eigen::MatrixXd own, all;

  double Energy(const Eigen::VectorXd& signs) const { return signs.dot(all * signs); }
  double Share(const Eigen::VectorXd& signs) const {
    const double alone = signs.dot(own * signs);
    return alone > 0 ? 1 - Energy(signs) / alone : 0.0;
  }
};

}  // namespace

/// Ridge regression of the error on the functions, parameters unpenalised, with groups of pieces left out in turn. With G the
/// products of columns and error (one column per piece), A_f the regression's matrix without group f and M_f, G_f the group's
/// own, signs s give w = A_f^-1 (G - G_f) s and the energy e_f - 2 w' G_f s + w' M_f w, which is quadratic in s.
class LeaveOut {
 public:
  explicit LeaveOut(const LeftOutColumns& columns) : columns_(columns) {
    const Eigen::Index size = columns.parameters_ + columns.functions_;
    Eigen::MatrixXd total = Eigen::MatrixXd::Zero(size, size);
    for (const Eigen::MatrixXd& group : columns.groups_) total += group;
    scale_ = total.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    total_ = scale_.asDiagonal() * total * scale_.asDiagonal();
    gradient_ = scale_.asDiagonal() * columns.gradient_;
  }

  std::vector<LeftOutForms> Forms(std::initializer_list<double> penalties) const {
    const Eigen::Index pieces = columns_.pieces(), own = columns_.parameters_,
                       functions = columns_.functions_;
    const LeftOutForms none{Eigen::MatrixXd::Zero(pieces, pieces), Eigen::MatrixXd::Zero(pieces, pieces)};
    std::vector<LeftOutForms> out(penalties.size(), none);
    Eigen::Index first = 0;
    for (std::size_t g = 0; g < columns_.groups_.size(); ++g) {
      const Group group{first, columns_.group_end_[g],
                        scale_.asDiagonal() * columns_.groups_[g] * scale_.asDiagonal()};
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
    for (Eigen::Index p = group.first; p < group.end; ++p) form(p, p) += columns_.energy_[p];
    return form;
  }

  const LeftOutColumns& columns_;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd total_, gradient_;
};

namespace {

std::vector<LeftOutForms> FormsOf(const LeftOutColumns& columns) {
  return LeaveOut(columns).Forms({1e-6, 1e-4, 1e-2, 1.0});
}

/// Largest share over all penalties.
double ShareOf(const std::vector<LeftOutForms>& forms, const Eigen::VectorXd& signs) {
  double best = 0;
  for (const LeftOutForms& form : forms) best = std::max(best, form.Share(signs));
  return best;
}

/// Energy of the error on the pieces of a fit left out in turn, of that of its error.
double LeftOutOf(const StateFit& fit) {
  double error = 0;
  for (const StatePiece& piece : fit.pieces) error += piece.energy;
  return std::max(1.0, fit.HeldOutEnergy() / std::max(error, 1e-300));
}

}  // namespace

LeftOutColumns::LeftOutColumns(const StateFit& fit, std::size_t episodes, int functions)
    : parameters_(fit.model->parameter_count()), functions_(functions) {
  const auto count = static_cast<Eigen::Index>(fit.pieces.size());
  const Eigen::Index size = parameters_ + functions_, groups = std::min(kGroups, count);
  gradient_.resize(size, count);
  energy_.resize(count);
  groups_.assign(static_cast<std::size_t>(groups), Eigen::MatrixXd::Zero(size, size));
  group_end_ = GroupEnds(fit.pieces, episodes, groups);
}

void LeftOutColumns::Add(const StateFit& fit, std::size_t episode, const RowMatrix& columns) {
  const Eigen::Index size = parameters_ + functions_, outputs = fit.model->output.rows;
  for (Eigen::Index p = 0, g = 0; p < pieces(); ++p) {
    while (p >= group_end_[static_cast<std::size_t>(g)]) ++g;
    const StatePiece& piece = fit.pieces[static_cast<std::size_t>(p)];
    if (piece.episode != static_cast<int>(episode)) continue;
    const auto rows = columns.middleRows(piece.first * outputs, (piece.last - piece.first) * outputs);
    const auto functions = rows.leftCols(size);
    groups_[static_cast<std::size_t>(g)] += ColumnProducts(functions);
    gradient_.col(p) = functions.transpose() * rows.col(size);
    energy_[p] = rows.col(size).squaredNorm();
  }
}

LeftOutColumns LeftOutColumns::Some(const std::vector<Eigen::Index>& kept) const {
  LeftOutColumns some;
  some.parameters_ = parameters_;
  some.functions_ = static_cast<int>(kept.size()) - parameters_;
  for (const Eigen::MatrixXd& group : groups_) some.groups_.push_back(group(kept, kept));
  some.group_end_ = group_end_;
  some.gradient_ = gradient_(kept, Eigen::all);
  some.energy_ = energy_;
  return some;
}

double LeftOutColumns::Share() const { return ShareOf(FormsOf(*this), Eigen::VectorXd::Ones(pieces())); }

StateRemainder LeftOutColumns::Remainder(const StateFit& fit, const StateRemainderOptions& options) const {
  StateRemainder out;
  out.functions = functions_;
  if (pieces() < 2) return out;
  const std::vector<LeftOutForms> forms = FormsOf(*this);
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(pieces());
  out.share = ShareOf(forms, signs);
  const double error = energy_.sum();
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
  return out;
}

}  // namespace hydroscope
