#include "estimation/column_products.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(ColumnProducts, AreThoseOfAnyNumberOfRowsAndColumns) {
  for (const int columns : {0, 1, 3, 8, 13, 40})
    for (const int rows : {1, 63, 64, 200}) {
      const RowMatrix all = RowMatrix::Random(rows, columns + 2);
      const auto some = all.middleCols(1, columns);
      const Eigen::MatrixXd products = ColumnProducts(some), exact = some.transpose() * some;
      ASSERT_EQ(products.rows(), columns);
      ASSERT_EQ(products.cols(), columns);
      EXPECT_LE((products - exact).norm(), 1e-14 * (1 + exact.norm())) << rows << " x " << columns;
      EXPECT_TRUE(products == products.transpose());
    }
}

}  // namespace
}  // namespace hydroscope
