#include "estimation/stroke_accumulator.h"

#include "estimation/column_products.h"

namespace hydroscope {
namespace {

SymmetricMatrix Pack(const Eigen::MatrixXd& lower) {
  SymmetricMatrix packed(static_cast<int>(lower.cols()));
  for (int j = 0; j < lower.cols(); ++j)
    for (int i = 0; i <= j; ++i) packed(i, j) = lower(j, i);
  return packed;
}

/// `lower` has one column per column of the model and, for whole vectors, PaddedColumns() rows; so has `packed`,
/// whose padding stays zero.
void AddOuter(const Eigen::MatrixXd& equations, int count, Eigen::MatrixXd& packed, Eigen::MatrixXd& lower) {
  if (packed.cols() < count) packed.setZero(lower.rows(), count);
  packed.topLeftCorner(lower.cols(), count) = equations.leftCols(count);
  AddColumnProducts(packed.data(), count, lower);
}

}  // namespace

StrokeAccumulator::StrokeAccumulator(int columns)
    : integral_(Eigen::MatrixXd::Zero(PaddedColumns(columns), columns)),
      noise_(integral_),
      flow_(integral_) {}

void StrokeAccumulator::Add(const SpanEquations& span) {
  const int windows = static_cast<int>(span.flow_time.size());
  AddOuter(span.integral, span.equations, packed_, integral_);
  AddOuter(span.noise, span.blocks, packed_, noise_);
  AddOuter(span.walk, static_cast<int>(span.walk.cols()), packed_, noise_);
  AddOuter(span.flow, windows, packed_, flow_);
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
