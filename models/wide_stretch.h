#pragma once

#include "core/parallel/wide.h"
#include "models/expressions/elementary.h"
#include "models/stretch.h"

/// The functions of models/stretch.h for arguments that are costly and free of branches (exponentials,
/// logarithms, roots, quotients): on the widest vectors the processor has (HYDROSCOPE_WIDE_TEMPLATE).
namespace hydroscope::wide {

template <typename Rate>
HYDROSCOPE_WIDE_TEMPLATE void IntegrateOverTime(const Stretch& stretch, Rate rate,
                                                std::span<double> increments) {
  hydroscope::IntegrateOverTime(stretch, rate, increments);
}

template <typename Level>
HYDROSCOPE_WIDE_TEMPLATE void Differences(const Stretch& stretch, Level level, std::span<double> increments) {
  hydroscope::Differences(stretch, level, increments);
}

template <typename Weight, typename Level>
HYDROSCOPE_WIDE_TEMPLATE void IntegrateOver(const Stretch& stretch, Weight weight, Level level,
                                            std::span<double> increments) {
  hydroscope::IntegrateOver(stretch, weight, level, increments);
}

}  // namespace hydroscope::wide
