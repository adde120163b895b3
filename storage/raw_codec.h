#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/quality.h"
#include "core/result.h"

namespace hydroscope {

/// Columns of equal length as compressed bytes: each column's values (little endian) are regrouped so that
/// the first bytes of all values come first, then the second bytes, ... (neighbouring samples share sign,
/// exponent and leading digits), all columns one after the other, then zlib at level 1. Every bit comes back,
/// NaN included.
std::vector<std::uint8_t> PackColumns(const std::vector<std::span<const double>>& columns);
/// The same for quality flags.
std::vector<std::uint8_t> PackColumns(const std::vector<std::span<const Quality>>& columns);

/// `columns` x `rows` values back; the error tells what is wrong with the bytes.
Result<std::vector<std::vector<double>>> UnpackColumns(std::span<const std::uint8_t> bytes,
                                                       std::size_t columns, std::size_t rows);
Result<std::vector<std::vector<Quality>>> UnpackFlags(std::span<const std::uint8_t> bytes,
                                                      std::size_t columns, std::size_t rows);

}  // namespace hydroscope
