#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "diagnosis/drift/cumulative_sum.h"
#include "diagnosis/drift/reference.h"

namespace hydroscope::drift {

/// What is remembered of a judged stroke for a while.
struct JudgedStroke {
  std::int64_t sequence = 0;
  int operating_class = -1;
  Eigen::VectorXd score;  ///< in units of noise variance
  Eigen::MatrixXd information;
  Eigen::VectorXd offset_doubt;  ///< SI, std of the class's offsets, each quantity alone
  /// SI, of the class's quantities, outside the temperatures it was learned at.
  Eigen::VectorXd outside_doubt;
};

/// When something changed, as stroke numbers: the change happened after stroke `last_before`.
struct ChangeTime {
  std::int64_t last_before = -1;
  std::int64_t low = -1, high = -1;  ///< 95 % interval of last_before
};

/// A quantity that moved.
struct Moved {
  int quantity = 0;
  double size = 0;  ///< SI
  double std = 0;   ///< SI, sampling and reference
};

/// Which quantities explain what the strokes after a change deviate by.
struct ChangeExplanation {
  std::vector<Moved> moved;  ///< strongest first
  Moved alone;               ///< the first, if nothing else had moved
  std::vector<int> rivals;   ///< quantities that alone explain about as much as the first
  double evidence = 0;       ///< log-likelihood gained by the first
  bool decided = false;      ///< no rival
};

/// Generalised likelihood ratio over the change time (Lorden 1971; Basseville and Nikiforov 1993, ch. 2.4)
/// for a step of unknown size in quantity `quantity`; interval: where the log-likelihood lies within 1.92 of
/// its maximum.
ChangeTime FindChangeTime(const std::deque<JudgedStroke>& strokes, int quantity);

/// Explains the strokes after `last_before` by as few quantities as possible: the one that gains most
/// log-likelihood beyond what an error of the reference would explain, then others as long as each gains a
/// tenth of the first and at least 12 and is worth finding by itself, with the sizes of all of them fitted
/// together. The reference errs in two ways: in each operating class, the same for all its strokes, and in
/// the temperature curves (`curve_doubt`, SI, each quantity alone), the same for all strokes.
ChangeExplanation ExplainChange(const std::deque<JudgedStroke>& strokes, std::int64_t last_before,
                                const std::vector<DriftSize>& sizes, const Eigen::VectorXd& curve_doubt);

/// Sizes of `moved` quantities fitted together to the sums of scores and information; std in SI without doubt.
std::vector<Moved> FitTogether(const Eigen::VectorXd& score, const Eigen::MatrixXd& information,
                               const std::vector<int>& moved);

}  // namespace hydroscope::drift
