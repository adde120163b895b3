#include "estimation/stroke_accumulator.h"

#include <cstring>

#include "core/wide.h"

namespace hydroscope {
namespace {

SymmetricMatrix Pack(const Eigen::MatrixXd& lower) {
  SymmetricMatrix packed(static_cast<int>(lower.cols()));
  for (int j = 0; j < lower.cols(); ++j)
    for (int i = 0; i <= j; ++i) packed(i, j) = lower(j, i);
  return packed;
}

/// Adds packed * packed' on and below the diagonal of kColumns columns from `j` on, one vector of kLanes rows
/// at a time. Every element is summed in the order of the equations, whatever the width of the vectors.
template <int kLanes, int kColumns>
[[gnu::always_inline]] inline void AddColumns(const double* packed, int rows, int count, int j,
                                              double* lower) {
  typedef double Vector __attribute__((vector_size(8 * kLanes)));
  for (int i = j / kLanes * kLanes; i < rows; i += kLanes) {
    Vector sum[kColumns] = {};
    for (int k = 0; k < count; ++k) {
      const double* x = packed + k * rows;
      Vector tall;
      std::memcpy(&tall, x + i, sizeof tall);
      for (int c = 0; c < kColumns; ++c) sum[c] += tall * x[j + c];
    }
    for (int c = 0; c < kColumns; ++c) {
      double* place = lower + (j + c) * rows + i;
      Vector total;
      std::memcpy(&total, place, sizeof total);
      total += sum[c];
      std::memcpy(place, &total, sizeof total);
    }
  }
}

template <int kLanes>
[[gnu::always_inline]] inline void AddProducts(const double* packed, int rows, int count, int columns,
                                               double* lower) {
  int j = 0;
  for (; j + 4 <= columns; j += 4) AddColumns<kLanes, 4>(packed, rows, count, j, lower);
  for (; j < columns; ++j) AddColumns<kLanes, 1>(packed, rows, count, j, lower);
}

using AddProductsFunction = void (*)(const double*, int, int, int, double*);
void AddProducts128(const double* packed, int rows, int count, int columns, double* lower) {
  AddProducts<2>(packed, rows, count, columns, lower);
}
#ifdef HYDROSCOPE_HAS_WIDE
[[gnu::target("avx2")]] void AddProducts256(const double* packed, int rows, int count, int columns,
                                            double* lower) {
  AddProducts<4>(packed, rows, count, columns, lower);
}
[[gnu::target("avx512f")]] void AddProducts512(const double* packed, int rows, int count, int columns,
                                               double* lower) {
  AddProducts<8>(packed, rows, count, columns, lower);
}
#endif

/// The widest vectors this processor has.
AddProductsFunction WidestAddProducts() {
#ifdef HYDROSCOPE_HAS_WIDE
  if (__builtin_cpu_supports("avx512f")) return AddProducts512;
  if (__builtin_cpu_supports("avx2")) return AddProducts256;
#endif
  return AddProducts128;
}

/// `lower` has one column per column of the model and, for whole vectors, Padded() rows; so has `packed`,
/// whose padding stays zero.
void AddOuter(const Eigen::MatrixXd& equations, int count, Eigen::MatrixXd& packed, Eigen::MatrixXd& lower) {
  static const AddProductsFunction add_products = WidestAddProducts();
  if (packed.cols() < count) packed.setZero(lower.rows(), count);
  packed.topLeftCorner(lower.cols(), count) = equations.leftCols(count);
  add_products(packed.data(), static_cast<int>(lower.rows()), count, static_cast<int>(lower.cols()),
               lower.data());
}

int Padded(int columns) { return (columns + 7) / 8 * 8; }

}  // namespace

StrokeAccumulator::StrokeAccumulator(int columns)
    : integral_(Eigen::MatrixXd::Zero(Padded(columns), columns)), noise_(integral_), flow_(integral_) {}

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
