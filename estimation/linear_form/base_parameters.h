#pragma once

#include <Eigen/Dense>
#include <vector>

namespace hydroscope {

/// Which columns of a linear regression can be told apart, and what the others add to those.
struct BaseParameterSet {
  std::vector<int> kept;    ///< columns that are independent of those kept before them
  std::vector<int> unseen;  ///< columns that are zero: nothing in the record depends on them
  /// kept x columns: column j = sum over kept k of combination(k, j) * column kept[k], so the parameter of kept[k] is found
  /// with combination(k, j) times that of j added to it.
  Eigen::MatrixXd combination;
  int rank = 0;          ///< by QR with column pivoting
  double condition = 0;  ///< of the kept columns, each scaled to length 1
};

/// Rank revealing QR (Golub and Van Loan 2013, 5.4) of the scaled regressor, then Gautier's numerical grouping (1991): columns
/// are gone through in their order, and one that the kept ones give but for `tolerance` of its length is grouped with them.
BaseParameterSet FindBaseParameters(const Eigen::MatrixXd& regressor, double tolerance = 1e-6);

}  // namespace hydroscope
