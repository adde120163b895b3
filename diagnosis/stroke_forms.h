#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "core/parallel/eight_lanes.h"
#include "core/records/symmetric_matrix.h"

namespace hydroscope {

/// A model's columns as weighted sums of columns of the Grams, the output last.
using SparseColumns = std::vector<std::vector<std::pair<int, double>>>;

/// A symmetric matrix per stroke, with the strokes side by side.
class StrokeForms {
 public:
  StrokeForms(int size, std::size_t strokes)
      : size_(size),
        blocks_((strokes + EightLanes::kCount - 1) / EightLanes::kCount),
        lanes_(SymmetricMatrix::Size(size) * blocks_) {}

  int size() const { return size_; }
  std::size_t blocks() const { return blocks_; }  ///< of eight strokes
  /// Element (i, j), i >= j, of the first block; the next element is blocks() behind it, that of (i, j + 1) or (i + 1, 0).
  EightLanes* At(int i, int j) { return lanes_.data() + Index(i, j); }
  const EightLanes* At(int i, int j) const { return lanes_.data() + Index(i, j); }
  double Of(std::size_t stroke, int i, int j) const {
    return At(i, j)[stroke / EightLanes::kCount][static_cast<int>(stroke % EightLanes::kCount)];
  }
  /// Over these strokes, in their order.
  Eigen::MatrixXd Sum(std::span<const std::size_t> strokes) const;

 private:
  std::size_t Index(int i, int j) const { return (SymmetricMatrix::Size(i) + j) * blocks_; }

  int size_;
  std::size_t blocks_;
  std::vector<EightLanes> lanes_;
};

/// Grams of strokes by their elements. They hold many more columns than a model does, so that its elements lie far apart: the
/// strokes' values of one are put together when it is first asked for.
class GramElements {
 public:
  /// Of the next stroke; it must outlive this.
  void Add(const SymmetricMatrix& gram) { strokes_.push_back(&gram); }
  /// W' G W of each stroke, W of sparse `columns`.
  StrokeForms Congruence(const SparseColumns& columns);

 private:
  const EightLanes* Gathered(int a, int b, std::size_t blocks);

  std::vector<const SymmetricMatrix*> strokes_;
  std::vector<int> place_;  ///< of an element in `gathered_`; -1: not there yet
  std::vector<EightLanes> gathered_;
  std::mutex gathering_;
};

/// Least squares without each stroke in turn.
struct LeftOutStrokes {
  Eigen::MatrixXd theta;            ///< parameters x strokes
  std::vector<bool> indispensable;  ///< per stroke: without it the regressors are not independent
  Eigen::VectorXd error;            ///< energy that `clean` leaves on the stroke left out
  Eigen::VectorXd flow_error;       ///< and `flow`
};
/// `clean`, `flow`: regressors, and the output last; `total`: the sum of `clean` over all of `strokes`, which are those left out;
/// `whole`: the fit to all of them, which stands for the fit without an indispensable one.
LeftOutStrokes LeaveOutEach(const StrokeForms& clean, const StrokeForms& flow, const Eigen::MatrixXd& total,
                            const Eigen::VectorXd& whole, std::span<const std::size_t> strokes);

}  // namespace hydroscope
