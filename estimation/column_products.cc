#include "estimation/column_products.h"

#include <algorithm>
#include <cstring>

#include "core/wide.h"

namespace hydroscope {
namespace {

constexpr std::ptrdiff_t kLanes = 8, kTall = 4,
                         kRows = 64;  ///< of a tile, and of rows that stay in the cache
using ProductLanes [[gnu::vector_size(kLanes * sizeof(double))]] = double;

/// sums += rows' rows from the diagonal on; rows of `size` numbers, a multiple of kLanes.
HYDROSCOPE_WIDE void AddProductsOfRows(const double* rows, std::ptrdiff_t count, std::ptrdiff_t size,
                                       double* sums) {
  for (std::ptrdiff_t i = 0; i < size; i += kTall)
    for (std::ptrdiff_t j = i / kLanes * kLanes; j < size; j += kLanes) {
      ProductLanes tile[kTall], row;
      for (std::ptrdiff_t k = 0; k < kTall; ++k) std::memcpy(&tile[k], sums + (i + k) * size + j, sizeof row);
      for (std::ptrdiff_t r = 0; r < count; ++r) {
        std::memcpy(&row, rows + r * size + j, sizeof row);
        for (std::ptrdiff_t k = 0; k < kTall; ++k) tile[k] += rows[r * size + i + k] * row;
      }
      for (std::ptrdiff_t k = 0; k < kTall; ++k) std::memcpy(sums + (i + k) * size + j, &tile[k], sizeof row);
    }
}

}  // namespace

Eigen::MatrixXd ColumnProducts(const Eigen::Ref<const RowMatrix, 0, Eigen::OuterStride<>>& rows) {
  const std::ptrdiff_t columns = rows.cols(), size = (columns + kLanes - 1) / kLanes * kLanes;
  RowMatrix sums = RowMatrix::Zero(size, size), some = RowMatrix::Zero(kRows, size);
  for (std::ptrdiff_t first = 0; first < rows.rows(); first += kRows) {
    const std::ptrdiff_t count = std::min(kRows, rows.rows() - first);
    some.topLeftCorner(count, columns) = rows.middleRows(first, count);
    AddProductsOfRows(some.data(), count, size, sums.data());
  }
  return sums.topLeftCorner(columns, columns).selfadjointView<Eigen::Upper>();
}

}  // namespace hydroscope
