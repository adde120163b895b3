#include "estimation/column_products.h"

#include <algorithm>
#include <cstring>

#include "core/parallel/wide.h"

namespace hydroscope {
namespace {

/// Adds packed * packed' on and below the diagonal of kColumns columns from `j` on, two vectors of kLanes rows
/// at a time, so that few sums wait for the one before. Every element is summed in the order of the equations, whatever the width of the vectors.
template <int kLanes, int kColumns>
[[gnu::always_inline]] inline void AddColumns(const double* packed, int rows, int count, int j,
                                              double* lower) {
  typedef double Vector __attribute__((vector_size(8 * kLanes)));
  for (int i = j / (2 * kLanes) * 2 * kLanes; i < rows; i += 2 * kLanes) {
    Vector upper[kColumns] = {}, under[kColumns] = {};
    for (int k = 0; k < count; ++k) {
      const double* x = packed + k * rows;
      Vector up, down;
      std::memcpy(&up, x + i, sizeof up);
      std::memcpy(&down, x + i + kLanes, sizeof down);
      for (int c = 0; c < kColumns; ++c) {
        upper[c] += up * x[j + c];
        under[c] += down * x[j + c];
      }
    }
    for (int c = 0; c < kColumns; ++c) {
      double* place = lower + (j + c) * rows + i;
      Vector up, down;
      std::memcpy(&up, place, sizeof up);
      std::memcpy(&down, place + kLanes, sizeof down);
      up += upper[c];
      down += under[c];
      std::memcpy(place, &up, sizeof up);
      std::memcpy(place + kLanes, &down, sizeof down);
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
#endif

/// The widest vectors this processor has.
AddProductsFunction WidestAddProducts() {
#ifdef HYDROSCOPE_HAS_WIDE
  if (__builtin_cpu_supports("avx2")) return AddProducts256;
#endif
  return AddProducts128;
}

}  // namespace

int PaddedColumns(int columns) { return (columns + 7) / 8 * 8; }

void AddColumnProducts(const double* packed, int count, Eigen::MatrixXd& lower) {
  static const AddProductsFunction add_products = WidestAddProducts();
  add_products(packed, static_cast<int>(lower.rows()), count, static_cast<int>(lower.cols()), lower.data());
}

void AddColumnProducts(const Eigen::MatrixXd& own, const Eigen::MatrixXd& known, int count,
                       Eigen::MatrixXd& packed, Eigen::MatrixXd& lower) {
  if (packed.rows() != lower.rows() || packed.cols() < count) packed.resize(lower.rows(), count);
  for (int k = 0; k < count; ++k) {
    double* place = std::copy_n(own.col(k).data(), own.rows(), packed.col(k).data());
    if (known.rows() > 0) place = std::copy_n(known.col(k).data(), known.rows(), place);
    std::fill(place, packed.col(k).data() + packed.rows(), 0.0);
  }
  AddColumnProducts(packed.data(), count, lower);
}

Eigen::MatrixXd ColumnProducts(const Eigen::Ref<const RowMatrix, 0, Eigen::OuterStride<>>& rows) {
  constexpr Eigen::Index kTogether = 64;  // rows that stay in the cache
  const auto columns = static_cast<int>(rows.cols());
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(PaddedColumns(columns), columns);
  RowMatrix packed = RowMatrix::Zero(kTogether, lower.rows());
  for (Eigen::Index first = 0; first < rows.rows(); first += kTogether) {
    const Eigen::Index count = std::min(kTogether, rows.rows() - first);
    packed.topLeftCorner(count, columns) = rows.middleRows(first, count);
    AddColumnProducts(packed.data(), static_cast<int>(count), lower);
  }
  return lower.topRows(columns).selfadjointView<Eigen::Lower>();
}

}  // namespace hydroscope
