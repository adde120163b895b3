#include "storage/raw_chunk.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

constexpr std::size_t kRowsPerChunk = 1000;

Status CheckTime(const std::vector<double>& time) {
  for (std::size_t row = 0; row < time.size(); ++row)
    if (!std::isfinite(time[row]) || (row > 0 && !(time[row] > time[row - 1])))
      return BadInput("raw samples: time does not increase at row {} ({} s)", row, time[row]);
  return {};
}

/// Flags of rows [from, from + rows) as a blob; empty if all are good.
std::vector<std::uint8_t> PackFlags(const std::vector<std::vector<Quality>>& flags, std::size_t from,
                                    std::size_t rows, ColumnPacker& packer) {
  std::vector<std::span<const Quality>> columns;
  bool any = false;
  for (const auto& column : flags) {
    columns.push_back(std::span(column).subspan(from, rows));
    any = any || std::ranges::any_of(columns.back(), [](Quality q) { return q != 0; });
  }
  return any ? packer.Pack(columns) : std::vector<std::uint8_t>();
}

}  // namespace

Result<std::vector<RawChunk>> PackRaw(const std::vector<double>& time,
                                      const std::vector<std::vector<double>>& values,
                                      const std::vector<std::vector<Quality>>& flags, double after,
                                      ColumnPacker& packer) {
  TRY(CheckTime(time));
  std::vector<RawChunk> chunks;
  const auto first_new = static_cast<std::size_t>(std::ranges::upper_bound(time, after) - time.begin());
  for (std::size_t from = first_new; from < time.size(); from += kRowsPerChunk) {
    const std::size_t rows = std::min(kRowsPerChunk, time.size() - from);
    std::vector<std::span<const double>> columns = {std::span(time).subspan(from, rows)};
    for (const auto& column : values) columns.push_back(std::span(column).subspan(from, rows));
    chunks.push_back({.first = time[from],
                      .last = time[from + rows - 1],
                      .rows = static_cast<std::int64_t>(rows),
                      .signals = values.size(),
                      .samples = packer.Pack(columns),
                      .flags = PackFlags(flags, from, rows, packer)});
  }
  return chunks;
}

}  // namespace hydroscope
