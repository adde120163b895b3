#pragma once

#include <vector>

#include "diagnosis/states/remainder.h"

namespace hydroscope {

/// What columns predict of the error of a fit on pieces of the log left out: products of columns (parameters, then functions) over
/// groups of neighbouring pieces, and per piece those with the error.
class LeftOutColumns {
 public:
  LeftOutColumns(const StateFit& fit, std::size_t episodes, int functions);

  /// The columns of an episode (TangentColumns): parameters, functions, the error.
  void Add(const StateFit& fit, std::size_t episode, const RowMatrix& columns);
  /// With some of the columns alone.
  LeftOutColumns Some(const std::vector<Eigen::Index>& kept) const;
  /// Share of the error's energy that the functions predict on groups left out.
  double Share() const;
  /// StateRemainder's shares and p-value. `options`: its flips and seed.
  StateRemainder Remainder(const StateFit& fit, const StateRemainderOptions& options) const;

  Eigen::Index pieces() const { return energy_.size(); }
  int parameters() const { return parameters_; }

 private:
  friend class LeaveOut;
  LeftOutColumns() = default;

  std::vector<Eigen::MatrixXd> groups_;
  std::vector<Eigen::Index> group_end_;  ///< per group: one past its last piece
  Eigen::MatrixXd gradient_;             ///< column x piece
  Eigen::VectorXd energy_;               ///< of the error, per piece
  int parameters_ = 0, functions_ = 0;
};

}  // namespace hydroscope
