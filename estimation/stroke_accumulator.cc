#include "estimation/stroke_accumulator.h"

namespace hydroscope {
namespace {

SymmetricMatrix Pack(const Eigen::MatrixXd& lower) {
  SymmetricMatrix packed(static_cast<int>(lower.rows()));
  for (int j = 0; j < lower.rows(); ++j)
    for (int i = 0; i <= j; ++i) packed(i, j) = lower(j, i);
  return packed;
}

void AddOuter(const Eigen::MatrixXd& equations, int count, Eigen::MatrixXd& lower) {
  lower.selfadjointView<Eigen::Lower>().rankUpdate(equations.leftCols(count));
}

/// Only the base columns have an integrated part, the first of 57 rows or so.
void AddIntegratedNoise(const SpanEquations& span, Eigen::MatrixXd& lower) {
  const int rows = span.integrated_rows;
  lower.topLeftCorner(rows, rows)
      .selfadjointView<Eigen::Lower>()
      .rankUpdate(span.noise.middleCols(span.blocks, span.blocks).topRows(rows));
}

}  // namespace

StrokeAccumulator::StrokeAccumulator(int columns)
    : integral_(Eigen::MatrixXd::Zero(columns, columns)), noise_(integral_), flow_(integral_) {}

void StrokeAccumulator::Add(const SpanEquations& span) {
  const int windows = static_cast<int>(span.flow_time.size());
  AddOuter(span.integral, span.equations, integral_);
  AddOuter(span.noise, span.blocks, noise_);
  AddIntegratedNoise(span, noise_);
  AddOuter(span.flow, windows, flow_);
  blocks_ += span.blocks;
  spans_ += span.blocks - span.equations;
  windows_ += windows;
}

StrokeGram StrokeAccumulator::Take() {
  StrokeGram gram{blocks_, spans_, windows_, Pack(integral_), Pack(noise_), Pack(flow_)};
  integral_.setZero();
  noise_.setZero();
  flow_.setZero();
  blocks_ = spans_ = windows_ = 0;
  return gram;
}

}  // namespace hydroscope
