#pragma once

#include "estimation/episode.h"

namespace hydroscope {

/// rows' rows: of each pair of columns once, several products side by side. Eigen's own, compiled for any x86-64, takes four times
/// as long.
Eigen::MatrixXd ColumnProducts(const Eigen::Ref<const RowMatrix, 0, Eigen::OuterStride<>>& rows);

}  // namespace hydroscope
