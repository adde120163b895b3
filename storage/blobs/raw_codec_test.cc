#include "storage/blobs/raw_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <random>

#include "core/constants.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

constexpr std::size_t kRows = 1000;

/// Size of the column packed, after a look whether every bit comes back.
std::size_t PackedSize(const std::vector<double>& column) {
  const auto packed = PackColumns(std::vector<std::span<const double>>{column});
  const auto back = UnpackColumns(packed, 1, column.size());
  EXPECT_TRUE(back) << back.error().text;
  if (!back) return packed.size();
  for (std::size_t i = 0; i < column.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>((*back)[0][i]), std::bit_cast<std::uint64_t>(column[i])) << i;
  return packed.size();
}

template <typename Make>
std::vector<double> Column(Make make) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> column;
  for (std::size_t i = 0; i < kRows; ++i) column.push_back(make(i, normal(random)));
  return column;
}

TEST(RawCodec, AConvertersReadingsTakeNoMoreThanTheirNoise) {
  constexpr double kStep = 400e5 / 65536;
  const auto readings = Column([](std::size_t i, double noise) {
    return std::round((2e7 + 1e4 * static_cast<double>(i) + 10 * kStep * noise) / kStep) * kStep;
  });
  // Differences of noise of 10 steps: log2(10 * sqrt(2 * 2 * pi * e)) = 5.9 bits a row.
  EXPECT_LT(PackedSize(readings), kRows * 7.5 / 8);
}

TEST(RawCodec, ReadingsConvertedToSiUnitsPackAsWell) {
  const auto readings = Column(
      [](std::size_t, double noise) { return std::round(20000 + 10 * noise) * (400.0 / 65536) * 1e5; });
  EXPECT_LT(PackedSize(readings), kRows * 9.0 / 8);
}

TEST(RawCodec, TimeTakesNextToNothing) {
  double time = 1.7e9;
  EXPECT_LT(PackedSize(Column([&](std::size_t, double) { return time += 1e-3; })), kRows / 3);
}

TEST(RawCodec, AnyPatternOfBitsComesBack) {
  PackedSize(Column([](std::size_t, double noise) { return noise; }));
  std::mt19937_64 random(5);
  PackedSize(Column([&](std::size_t, double) { return std::bit_cast<double>(std::uint64_t(random())); }));
  const double odd[] = {0.0,    -0.0,    kInfinity, -kInfinity, std::nan("7"), -std::nan("9"),
                        5e-324, -5e-324, 1e308,     -1e308,     1.0,           -1.0};
  PackedSize(Column([&](std::size_t i, double) { return odd[i % std::size(odd)]; }));
  PackedSize(
      Column([&](std::size_t i, double) { return i % 3 == 0 ? -0.0 : 0.25 * static_cast<double>(i % 7); }));
  PackedSize(Column([&](std::size_t i, double) { return i % 100 == 7 ? std::nan("") : 0.5; }));
  PackedSize({});
  PackedSize({3.25});
}

TEST(RawCodec, FlagsComeBack) {
  std::vector<Quality> flags(kRows);
  for (std::size_t i = 0; i < kRows; i += 7) flags[i] = static_cast<Quality>(65535 - i);
  const auto packed = PackColumns(std::vector<std::span<const Quality>>{flags, flags});
  const auto back = UnpackFlags(packed, 2, kRows);
  ASSERT_TRUE(back) << back.error().text;
  EXPECT_EQ((*back)[0], flags);
  EXPECT_EQ((*back)[1], flags);
}

TEST(RawCodec, WhatVersionOnePackedIsStillRead) {
  const auto column = Column([](std::size_t, double noise) { return noise; });
  std::vector<std::uint8_t> shuffled(8 * kRows);
  for (std::size_t i = 0; i < kRows; ++i)
    for (std::size_t byte = 0; byte < 8; ++byte)
      shuffled[byte * kRows + i] =
          static_cast<std::uint8_t>(std::bit_cast<std::uint64_t>(column[i]) >> (8 * byte));
  std::vector<std::uint8_t> packed(compressBound(shuffled.size()));
  uLongf size = packed.size();
  ASSERT_EQ(compress2(packed.data(), &size, shuffled.data(), shuffled.size(), 1), Z_OK);
  packed.resize(size);
  const auto back = UnpackColumns(packed, 1, kRows);
  ASSERT_TRUE(back) << back.error().text;
  EXPECT_EQ((*back)[0], column);
}

TEST(RawCodec, FewRowsComeBackToo) {
  std::mt19937_64 random(8);
  for (const std::size_t rows : {1u, 36u, 100u, 101u}) {
    std::vector<double> noise(rows), steps(rows);
    for (std::size_t i = 0; i < rows; ++i) {
      noise[i] = std::bit_cast<double>(random() >> 2);
      steps[i] = 0.25 * static_cast<double>(i * i % 9);
    }
    const auto packed = PackColumns(std::vector<std::span<const double>>{noise, steps});
    const auto back = UnpackColumns(packed, 2, rows);
    ASSERT_TRUE(back) << back.error().text;
    EXPECT_EQ((*back)[0], noise);
    EXPECT_EQ((*back)[1], steps);
    EXPECT_LT(packed.size(), rows * 10 + 80) << "what is not deflated is packed all the same";
  }
}

TEST(RawCodec, FewRowsOfManyColumnsComeBack) {
  constexpr std::size_t kFew = 100, kColumns = 200;  // more bytes than one stored block holds
  std::mt19937_64 random(9);
  std::vector<std::vector<double>> columns(kColumns, std::vector<double>(kFew));
  for (auto& column : columns)
    for (double& value : column) value = std::bit_cast<double>(random() >> 2);
  const auto packed = PackColumns(std::vector<std::span<const double>>(columns.begin(), columns.end()));
  EXPECT_GT(packed.size(), 0x10000u);
  const auto back = UnpackColumns(packed, kColumns, kFew);
  ASSERT_TRUE(back) << back.error().text;
  EXPECT_EQ(*back, columns);
}

TEST(RawCodec, DamagedBytesAreRefusedWhateverTheyAre) {
  const auto column = Column([](std::size_t i, double) { return 0.5 * static_cast<double>(i % 9); });
  const auto packed = PackColumns(std::vector<std::span<const double>>{column, column});
  for (std::size_t cut = 0; cut < packed.size(); ++cut) {
    const auto back = UnpackColumns(std::span(packed).first(cut), 2, kRows);
    ASSERT_FALSE(back) << cut;
    EXPECT_THAT(back.error().text, HasSubstr("2 columns of 1000 rows"));
  }
  EXPECT_FALSE(UnpackColumns(packed, 3, kRows));
  EXPECT_FALSE(UnpackColumns(packed, 1, kRows));
  EXPECT_FALSE(UnpackColumns(packed, 2, kRows + 1));
  EXPECT_FALSE(UnpackColumns(packed, 2, std::size_t{1} << 40)) << "as much memory as a damaged number claims";
  EXPECT_FALSE(UnpackColumns(packed, 2, static_cast<std::size_t>(-1)));
}

}  // namespace
}  // namespace hydroscope
