#include "estimation/stroke_accumulator.h"

#include <algorithm>

#include "estimation/column_products.h"

namespace hydroscope {
namespace {

/// Products of `known` columns among each other, and with those behind them.
SymmetricMatrix Pack(const SymmetricMatrix& known, const Eigen::MatrixXd& lower) {
  const int before = known.dimension(), own = static_cast<int>(lower.cols());
  SymmetricMatrix packed(before + own);
  std::copy(known.packed().begin(), known.packed().end(), packed.packed().begin());
  for (int j = 0; j < own; ++j) {
    for (int i = 0; i < before; ++i) packed(i, before + j) = lower(own + i, j);
    for (int i = 0; i <= j; ++i) packed(before + i, before + j) = lower(j, i);
  }
  return packed;
}

}  // namespace

StrokeAccumulator::StrokeAccumulator(int known, int columns)
    : integral_(Eigen::MatrixXd::Zero(PaddedColumns(known + columns), columns)),
      noise_(integral_),
      flow_(integral_) {}

void StrokeAccumulator::Add(const SpanEquations& known, const SpanEquations& span) {
  AddColumnProducts(span.integral, known.integral, span.equations, packed_, integral_);
  AddColumnProducts(span.noise, known.noise, span.blocks, packed_, noise_);
  AddColumnProducts(span.walk, known.walk, static_cast<int>(span.walk.cols()), packed_, noise_);
  const int windows = static_cast<int>(span.flow_time.size());
  AddColumnProducts(span.flow, known.flow, windows, packed_, flow_);
  blocks_ += span.blocks;
  spans_ += span.blocks - span.equations;
  windows_ += windows;
}

StrokeGram StrokeAccumulator::Take(const StrokeGram& known) {
  StrokeGram gram{blocks_,
                  spans_,
                  windows_,
                  Pack(known.integral, integral_),
                  Pack(known.noise, noise_),
                  Pack(known.flow, flow_),
                  known.log};
  integral_.setZero();
  noise_.setZero();
  flow_.setZero();
  blocks_ = spans_ = windows_ = 0;
  return gram;
}

}  // namespace hydroscope
