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
    : known_(known),
      integral_(Eigen::MatrixXd::Zero(PaddedColumns(known + columns), columns)),
      noise_(integral_),
      flow_(integral_) {}

/// `lower` has, for whole vectors, PaddedColumns() rows; so has `packed_`, whose padding stays zero.
void StrokeAccumulator::AddOuter(const Eigen::MatrixXd& known, const Eigen::MatrixXd& own, int count,
                                 Eigen::MatrixXd& lower) {
  if (packed_.cols() < count) packed_.setZero(lower.rows(), count);
  for (int k = 0; k < count; ++k) {  // several times quicker than blocks of Eigen, which begin unaligned
    std::copy_n(own.col(k).data(), lower.cols(), packed_.col(k).data());
    if (known_ > 0) std::copy_n(known.col(k).data(), known_, packed_.col(k).data() + lower.cols());
  }
  AddColumnProducts(packed_.data(), count, lower);
}

void StrokeAccumulator::Add(const SpanEquations& known, const SpanEquations& span) {
  AddOuter(known.integral, span.integral, span.equations, integral_);
  AddOuter(known.noise, span.noise, span.blocks, noise_);
  AddOuter(known.walk, span.walk, static_cast<int>(span.walk.cols()), noise_);
  const int windows = static_cast<int>(span.flow_time.size());
  AddOuter(known.flow, span.flow, windows, flow_);
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
