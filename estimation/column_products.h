#pragma once

#include "estimation/episode.h"

namespace hydroscope {

/// `columns`, and as many more as whole vectors take.
int PaddedColumns(int columns);

/// Adds the products of each pair of columns, on and below the diagonal of `lower`, on vectors as wide as the processor has.
/// `packed`: `count` rows of lower.rows() = PaddedColumns(lower.cols()) numbers, those beyond the columns zero.
void AddColumnProducts(const double* packed, int count, Eigen::MatrixXd& lower);

/// The same of `count` columns of `own`, and their products with those of `known`, whose rows stand behind the own ones in `lower`.
/// `packed` is kept from one call to the next.
void AddColumnProducts(const Eigen::MatrixXd& own, const Eigen::MatrixXd& known, int count,
                       Eigen::MatrixXd& packed, Eigen::MatrixXd& lower);

/// rows' rows.
Eigen::MatrixXd ColumnProducts(const Eigen::Ref<const RowMatrix, 0, Eigen::OuterStride<>>& rows);

}  // namespace hydroscope
