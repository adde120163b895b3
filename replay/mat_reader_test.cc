#include "replay/mat_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "replay/log_head.h"

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

struct Format {
  const char* name;
  mat_ft version;
  matio_compression compression;
};

/// The same behaviour whatever the version of the file.
class MatReaderTest : public ::testing::TestWithParam<Format> {
 protected:
  MatReaderTest()
      : path_(std::filesystem::temp_directory_path() /
              fmt::format("hydroscope_{}_{}.mat", GetParam().name, ::getpid())) {
    file_ = Mat_CreateVer(path_.c_str(), nullptr, GetParam().version);
    SignalSpec p;
    p.name = p.column = "p";
    p.unit = "bar";
    machine_.signals = {p};
  }
  ~MatReaderTest() override {
    if (file_ != nullptr) Mat_Close(file_);
    std::filesystem::remove(path_);
  }

  static matvar_t* Matrix(const char* name, std::vector<double> values, std::size_t rows) {
    std::size_t dims[2] = {rows, values.size() / rows};
    return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0);
  }
  void Write(matvar_t* variable) {
    ASSERT_EQ(Mat_VarWrite(file_, variable, GetParam().compression), 0);
    Mat_VarFree(variable);
  }
  void Vector(const char* name, std::vector<double> values) {
    const std::size_t rows = values.size();
    Write(Matrix(name, std::move(values), rows));
  }
  Result<std::unique_ptr<LogReader>> Open() {
    Mat_Close(std::exchange(file_, nullptr));
    return OpenLog(path_, machine_);
  }

  std::filesystem::path path_;
  mat_t* file_ = nullptr;
  Machine machine_;
};

TEST_P(MatReaderTest, ReadsVectors) {
  Vector("t", {0, 1, 2});
  Vector("p", {1, std::nan(""), 3});
  auto reader = Open();
  ASSERT_TRUE(reader) << reader.error().text;
  SampleBlock block;
  EXPECT_EQ(*(*reader)->Read(block, 10), 3u);
  EXPECT_THAT(block.time, ElementsAre(0, 1, 2));
  EXPECT_EQ(block.signal[0][2], 3e5);
  EXPECT_THAT(block.quality[0], ElementsAre(0, quality::kMissing, 0));
  EXPECT_EQ(*(*reader)->Read(block, 10), 0u);
  EXPECT_EQ((*reader)->SamplePeriod(), 1);
}

TEST_P(MatReaderTest, ReadsLongVectorsInSlices) {
  std::vector<double> t, p;
  for (int i = 0; i < 50000; ++i) {
    t.push_back(i * 0.001);
    p.push_back(i);
  }
  Vector("t", t);
  Vector("p", p);
  auto reader = Open();
  ASSERT_TRUE(reader);
  SampleBlock block;
  std::int64_t rows = 0;
  while (const auto got = *(*reader)->Read(block, 777))
    for (std::size_t i = 0; i < got; ++i, ++rows)
      ASSERT_EQ(block.signal[0][i], static_cast<double>(rows) * 1e5);
  EXPECT_EQ(rows, 50000);
  EXPECT_EQ((*reader)->counters().flagged[4], 0);
}

TEST_P(MatReaderTest, ReadsFieldsOfAStruct) {
  if (GetParam().version == MAT_FT_MAT4) GTEST_SKIP() << "version 4 has no structs";
  const char* fields[] = {"t", "p"};
  std::size_t dims[2] = {1, 1};
  matvar_t* log = Mat_VarCreateStruct("log", 2, dims, fields, 2);
  Mat_VarSetStructFieldByName(log, "t", 0, Matrix("t", {0, 1, 2}, 3));
  Mat_VarSetStructFieldByName(log, "p", 0, Matrix("p", {1, 2, 3}, 3));
  Write(log);
  auto reader = Open();
  ASSERT_TRUE(reader) << reader.error().text;
  SampleBlock block;
  ASSERT_EQ(*(*reader)->Read(block, 10), 3u);
  EXPECT_EQ(block.signal[0][1], 2e5);
}

TEST_P(MatReaderTest, ReadsColumnsOfAMatrixByNumber) {
  Write(Matrix("data", {0, 1, 2, 10, 20, 30}, 3));
  machine_.log.time_column = "1";
  machine_.signals[0].column = "data(2)";
  auto reader = Open();
  ASSERT_TRUE(reader) << reader.error().text;
  SampleBlock block;
  ASSERT_EQ(*(*reader)->Read(block, 10), 3u);
  EXPECT_EQ(block.signal[0][2], 30e5);
}

TEST_P(MatReaderTest, ReadsRowsOfAWideMatrix) {
  Write(Matrix("data", {0, 10, 1, 20, 2, 30}, 2));
  machine_.log.time_column = "1";
  machine_.signals[0].column = "2";
  auto reader = Open();
  ASSERT_TRUE(reader) << reader.error().text;
  SampleBlock block;
  ASSERT_EQ(*(*reader)->Read(block, 10), 3u);
  EXPECT_THAT(block.time, ElementsAre(0, 1, 2));
  EXPECT_EQ(block.signal[0][2], 30e5);
}

TEST_P(MatReaderTest, RefusesColumnsOfDifferentLength) {
  Vector("t", {0, 1, 2});
  Vector("p", {1, 2});
  const auto reader = Open();
  ASSERT_FALSE(reader);
  EXPECT_THAT(reader.error().text, HasSubstr("'p' has 2 values, 't' has 3"));
}

TEST_P(MatReaderTest, RefusesAMissingColumn) {
  Vector("t", {0, 1, 2});
  Vector("p_A", {1, 2, 3});
  const auto reader = Open();
  ASSERT_FALSE(reader);
  EXPECT_THAT(reader.error().text, HasSubstr("no column 'p' for signal 'p'"));
}

TEST_P(MatReaderTest, ShowsItsHead) {
  Vector("t", {0, 1, 2});
  Vector("p", {1, 2, 3});
  Mat_Close(std::exchange(file_, nullptr));
  const auto head = ReadLogHead(path_, 2);
  ASSERT_TRUE(head);
  EXPECT_THAT(head->layout.names, UnorderedElementsAre("t", "p"));
  EXPECT_THAT(head->columns[*head->layout.Find("p")], ElementsAre(1, 2));
}

INSTANTIATE_TEST_SUITE_P(Versions, MatReaderTest,
                         ::testing::Values(Format{"v4", MAT_FT_MAT4, MAT_COMPRESSION_NONE},
                                           Format{"v5", MAT_FT_MAT5, MAT_COMPRESSION_NONE},
                                           Format{"v7", MAT_FT_MAT5, MAT_COMPRESSION_ZLIB},
                                           Format{"v73", MAT_FT_MAT73, MAT_COMPRESSION_ZLIB}),
                         [](const auto& info) { return info.param.name; });

TEST(MatFile, WhatUnpacksToManyTimesTheFileIsRefused) {
  const auto path =
      std::filesystem::temp_directory_path() / fmt::format("hydroscope_{}_bomb.mat", ::getpid());
  std::vector<double> zeros(10'000'000);
  std::size_t dims[2] = {zeros.size(), 1}, one[2] = {1, 1};
  for (const bool in_struct : {false, true}) {
    mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
    matvar_t* variable = Mat_VarCreate(in_struct ? "p" : "bomb", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims,
                                       zeros.data(), MAT_F_DONT_COPY_DATA);
    if (in_struct) {
      const char* field = "p";
      matvar_t* holds = Mat_VarCreateStruct("bomb", 2, one, &field, 1);
      Mat_VarSetStructFieldByName(holds, "p", 0, variable);
      variable = holds;
    }
    EXPECT_EQ(Mat_VarWrite(file, variable, MAT_COMPRESSION_ZLIB), 0);
    Mat_VarFree(variable);
    Mat_Close(file);
    EXPECT_LT(std::filesystem::file_size(path), 200'000u);
    const auto head = ReadLogHead(path.string());
    ASSERT_FALSE(head) << in_struct;
    EXPECT_THAT(head.error().text, HasSubstr("variable 'bomb' of the MAT file unpacks to 80 MB"));
    std::filesystem::remove(path);
  }
}

TEST(MatFile, DamagedFileIsRefused) {
  const auto path =
      std::filesystem::temp_directory_path() / fmt::format("hydroscope_damaged_{}.mat", ::getpid());
  FILE* file = std::fopen(path.c_str(), "wb");
  std::fputs("MATLAB 5.0 MAT-file, cut off", file);
  std::fclose(file);
  const auto reader = OpenLog(path, Machine{});
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().kind, ErrorKind::kBadInput);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace hydroscope
