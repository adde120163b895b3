#include "replay/csv_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "replay/memory_source_fixture.h"

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

SignalSpec Signal(const std::string& name, const std::string& unit = "1") {
  SignalSpec spec;
  spec.name = spec.column = name;
  spec.unit = unit;
  return spec;
}

/// A log in memory, a machine, and what reading it gave.
class CsvReaderTest : public ::testing::Test {
 protected:
  CsvReaderTest() { machine_.signals = {Signal("p", "Pa"), Signal("z", "m")}; }

  void Read(const std::string& text, std::size_t rows_at_once = 1024) {
    ReadFrom(std::make_unique<MemorySource>(text), rows_at_once);
  }

  void ReadFrom(std::unique_ptr<ByteSource> source, std::size_t rows_at_once) {
    time_.clear();
    values_.assign(machine_.signals.size(), {});
    flags_.assign(machine_.signals.size(), {});
    error_.clear();
    auto reader = CsvReader::Open(std::move(source), machine_, "log.csv");
    if (!reader) {
      error_ = reader.error().text;
      return;
    }
    SampleBlock block;
    for (;;) {
      const auto rows = (*reader)->Read(block, rows_at_once);
      if (!rows) error_ = rows.error().text;
      if (!rows || *rows == 0) break;
      time_.insert(time_.end(), block.time.begin(), block.time.end());
      for (std::size_t s = 0; s < values_.size(); ++s) {
        values_[s].insert(values_[s].end(), block.signal[s].begin(), block.signal[s].end());
        flags_[s].insert(flags_[s].end(), block.quality[s].begin(), block.quality[s].end());
      }
    }
    counters_ = (*reader)->counters();
    period_ = (*reader)->SamplePeriod();
  }

  /// Rows 1, 2, ... with times a sample period of 1 s apart.
  static std::string Rows(int from, int to) {
    std::string text;
    for (int i = from; i <= to; ++i) text += fmt::format("{},{},{}\n", i, 10 * i, 100 * i);
    return text;
  }
  std::int64_t Flagged(Quality flag) const {
    return counters_.flagged[static_cast<std::size_t>(FlagBit(flag))];
  }

  Machine machine_;
  std::vector<double> time_;
  std::vector<std::vector<double>> values_;
  std::vector<std::vector<Quality>> flags_;
  LogCounters counters_;
  std::string error_;
  double period_ = 0;
};

TEST_F(CsvReaderTest, ReadsPlainRows) {
  Read("t,p,z\n1,10,100\n2,-2.5,1e2\n3,30,300\n");
  EXPECT_THAT(time_, ElementsAre(1, 2, 3));
  EXPECT_THAT(values_[0], ElementsAre(10, -2.5, 30));
  EXPECT_THAT(values_[1], ElementsAre(100, 100, 300));
  EXPECT_EQ(period_, 1.0);
  EXPECT_EQ(counters_.rows, 3);
}

TEST_F(CsvReaderTest, ConvertsScaleOffsetAndUnit) {
  machine_.signals = {Signal("p", "bar"), Signal("z", "degC")};
  machine_.signals[0].scale = 25;
  machine_.signals[0].offset = -10;
  Read("t,p,z\n1,2,20\n2,2,20\n");
  EXPECT_DOUBLE_EQ(values_[0][0], 40e5);
  EXPECT_DOUBLE_EQ(values_[1][0], 293.15);
}

TEST_F(CsvReaderTest, ReadsGermanExport) {
  machine_.log.time_unit = "ms";
  machine_.signals = {Signal("p", "bar"), Signal("z", "mm")};
  Read("\xEF\xBB\xBFt;p;z\r\nms;bar;mm\r\n1,0;1,5;100\r\n2,0;1,5;-0,25\r\n");
  EXPECT_THAT(time_, ElementsAre(0.001, 0.002));
  EXPECT_DOUBLE_EQ(values_[0][1], 1.5e5);
  EXPECT_DOUBLE_EQ(values_[1][1], -0.25e-3);
}

TEST_F(CsvReaderTest, ReadsColumnsByNumber) {
  machine_.log.time_column = "1";
  machine_.signals[0].column = "3";
  machine_.signals[1].column = "2";
  Read("1\t7\t8\r\n2\t7\t9\r\n");
  EXPECT_THAT(values_[0], ElementsAre(8, 9));
  EXPECT_THAT(values_[1], ElementsAre(7, 7));
}

TEST_F(CsvReaderTest, ReadsBlankSeparatedColumns) {
  Read("  t    p   z\n  1   10  100\n  2\t -20  1.0e+02  \n  3   30  300\n");
  EXPECT_THAT(values_[0], ElementsAre(10, -20, 30));
  EXPECT_THAT(values_[1], ElementsAre(100, 100, 300));
  EXPECT_EQ(counters_.rejected_rows, 0);
}

TEST_F(CsvReaderTest, ReadsQuotedNumbersAndTextBesides) {
  Read("t,note,p,z\n1,\"a, b\",\"10\",100\n2,x,20,200\n");
  EXPECT_THAT(values_[0], ElementsAre(10, 20));
}

TEST_F(CsvReaderTest, ReadsDatesAsTime) {
  Read("t,p,z\n06/29/2022 04:05:36.674 PM,1,2\n06/29/2022 04:05:36.675 PM,1,2\n");
  EXPECT_NEAR(time_[0], 1656518736.674, 3e-7);
  EXPECT_NEAR(period_, 0.001, 1e-6);
  EXPECT_EQ(flags_[0][1], quality::kGood);
}

TEST_F(CsvReaderTest, SaysHowTheMachineFileNamesTheTimeColumn) {
  Read("time,p,z\n1,2,3\n");
  EXPECT_THAT(error_, HasSubstr("time = \"...\" in [log]"));
}

TEST_F(CsvReaderTest, SpacesRowsWithoutTimeColumn) {
  machine_.log.time_column = "";
  machine_.log.sample_period = 0.5;
  Read("p,z\n1,2\n1,2\n1\n1,2\n1,2\n1,2\n1,2\n");
  EXPECT_THAT(time_, ElementsAre(0, 0.5, 1.5, 2, 2.5, 3));
  EXPECT_EQ(flags_[0][2], quality::kGap);
}

TEST_F(CsvReaderTest, FeedsTwoSignalsFromOneColumn) {
  machine_.signals[1].column = "p";
  machine_.signals[1].unit = "mm";
  Read("t,p\n1,10\n2,\n3,30\n");
  EXPECT_EQ(values_[0][0], 10);
  EXPECT_EQ(values_[1][0], 0.01);
  EXPECT_EQ(flags_[1][1], quality::kMissing);
}

TEST_F(CsvReaderTest, ColumnsOfOneNameAreToldWithTheOneThatIsRead) {
  Read("t,p,z,p,t\n1,10,1,70,1\n2,20,2,80,2\n");
  EXPECT_EQ(values_[0][0], 10);
  EXPECT_THAT(counters_.twins.english, HasSubstr("2 columns are called 'p' (2, 4): column 2 is read"));
  EXPECT_THAT(counters_.twins.english, HasSubstr("2 columns are called 't' (1, 5)"));
  EXPECT_EQ(counters_.findings.size(), 2u);
  machine_.signals[0].column = "4";
  machine_.log.time_column = "1";
  Read("t,p,z,p,t\n1,10,1,70,1\n2,20,2,80,2\n");
  EXPECT_EQ(values_[0][0], 70) << "a number tells them apart";
  EXPECT_TRUE(counters_.twins.empty());
}

TEST_F(CsvReaderTest, MissingColumnNamesTheNearest) {
  Read("t,pA,z\n1,2,3\n2,2,3\n");
  EXPECT_THAT(error_, HasSubstr("no column 'p' for signal 'p'"));
  EXPECT_THAT(error_, HasSubstr("'t', 'pA', 'z'"));
}

TEST_F(CsvReaderTest, MissingOptionalColumnIsMissingThroughout) {
  machine_.signals[1].required = false;
  Read("t,p\n1,2\n2,2\n");
  EXPECT_TRUE(std::isnan(values_[1][0]));
  EXPECT_EQ(flags_[1][0], quality::kMissing);
  EXPECT_EQ(flags_[0][0], quality::kGood);
  ASSERT_EQ(counters_.findings.size(), 1u);
}

TEST_F(CsvReaderTest, ContradictingUnitRowIsRefused) {
  Read("t,p,z\ns,bar,m\n1,2,3\n2,2,3\n");
  EXPECT_THAT(error_, HasSubstr("states the unit 'bar', the machine file has signals.p.unit = \"Pa\""));
}

TEST_F(CsvReaderTest, TextInNumberFieldIsFlaggedAndReported) {
  Read("t,p,z\n1,10,100\n2,fault,200\n3,30,300\n");
  EXPECT_TRUE(std::isnan(values_[0][1]));
  EXPECT_EQ(flags_[0][1], quality::kMissing);
  EXPECT_EQ(flags_[1][1], quality::kGood);
  ASSERT_EQ(counters_.findings.size(), 1u);
  EXPECT_EQ(counters_.findings[0].line, 3);
  EXPECT_EQ(counters_.findings[0].column, "p");
  EXPECT_EQ(counters_.findings[0].found, "fault");
  EXPECT_EQ(counters_.findings[0].expected, "number in Pa");
}

TEST_F(CsvReaderTest, EmptyNanAndInfinityAreMissingWithoutFinding) {
  Read("t,p,z\n1,,100\n2,NaN,inf\n3,30,300\n4,1e999,-\n");
  EXPECT_EQ(Flagged(quality::kMissing), 5);
  EXPECT_TRUE(counters_.findings.empty());
}

TEST_F(CsvReaderTest, NumbersTooLargeForADoubleAreMissing) {
  Read("t,p,z\n1,123456789e999,-1e999\n2,1.2345678901e999,3\n3,30,300\n");
  EXPECT_EQ(Flagged(quality::kMissing), 3);
}

TEST_F(CsvReaderTest, TornLastLineIsRejected) {
  Read("t,p,z\n" + Rows(1, 20) + "21,2");
  EXPECT_EQ(counters_.rows, 20);
  EXPECT_EQ(counters_.rejected_rows, 1);
  EXPECT_EQ(counters_.findings[0].line, 22);
  EXPECT_EQ(counters_.findings[0].expected, "3 fields");
}

TEST_F(CsvReaderTest, CompleteLastLineWithoutLineEndIsRead) {
  Read("t,p,z\n" + Rows(1, 20) + "21,210,2100");
  EXPECT_EQ(counters_.rows, 21);
}

/// Rows of 2 ms whose stamps jitter and are rounded are up to 3 ms apart.
TEST_F(CsvReaderTest, StampsInWholeMillisecondsMakeNoGapsAndHideNone) {
  std::string text = "t,p,z\n";
  for (int i = 0; i < 2000; ++i)
    if (i != 1000) text += fmt::format("{:.3f},{},{}\n", 0.002 * i + (i % 6 == 1 ? 0.001 : 0.0), i, 2 * i);
  Read(text);
  EXPECT_NEAR(period_, 0.002, 1e-5);
  EXPECT_EQ(Flagged(quality::kGap), 2) << "of the row that is missing";
  EXPECT_EQ(flags_[0][1000], quality::kGap);
}

TEST_F(CsvReaderTest, TwoLinesRunTogetherAreRejectedAndLeaveAGap) {
  Read("t,p,z\n" + Rows(1, 20) + "21,210,210022,220,2200\n" + Rows(23, 30));
  EXPECT_EQ(counters_.rejected_rows, 1);
  EXPECT_EQ(flags_[0][20], quality::kGap);
  EXPECT_EQ(flags_[1][20], quality::kGap);
  EXPECT_EQ(Flagged(quality::kGap), 2);
}

TEST_F(CsvReaderTest, SecondHeaderInTheMiddleIsRejected) {
  Read("t,p,z\n" + Rows(1, 20) + "t,p,z\n" + Rows(21, 30));
  EXPECT_EQ(counters_.rows, 30);
  EXPECT_EQ(counters_.rejected_rows, 1);
  EXPECT_EQ(counters_.findings[0].expected, "time as a number");
}

TEST_F(CsvReaderTest, ZerosLeftByAPowerCutAreRejected) {
  Read("t,p,z\n" + Rows(1, 20) + std::string(5000, '\0') + "\n" + Rows(23, 30));
  EXPECT_EQ(counters_.rows, 28);
  EXPECT_EQ(counters_.rejected_rows, 1);
}

TEST_F(CsvReaderTest, EmptyLinesAreNoRows) {
  Read("t,p,z\n" + Rows(1, 5) + "\n\r\n  \n" + Rows(6, 9) + "\n\n");
  EXPECT_EQ(counters_.rows, 9);
  EXPECT_EQ(counters_.rejected_rows, 0);
}

TEST_F(CsvReaderTest, SameTimeAgainIsADuplicate) {
  Read("t,p,z\n" + Rows(1, 5) + Rows(5, 9));
  EXPECT_EQ(flags_[0][5], quality::kDuplicate);
  EXPECT_EQ(Flagged(quality::kDuplicate), 2);
}

TEST_F(CsvReaderTest, EarlierTimeIsFlaggedUntilTimeHasCaughtUp) {
  machine_.log.sample_period = 0.1;
  Read("t,p,z\n0.1,1,1\n0.2,1,1\n0.3,1,1\n0.15,1,1\n0.25,1,1\n0.4,1,1\n");
  EXPECT_THAT(flags_[0], ElementsAre(0, 0, 0, quality::kTimeBackwards, quality::kTimeBackwards, 0));
}

TEST_F(CsvReaderTest, LongStepsAreClockJumps) {
  Read("t,p,z\n" + Rows(1, 5) + Rows(1000, 1002) + Rows(10, 12));
  EXPECT_EQ(flags_[0][5], quality::kGap | quality::kClockJump);
  EXPECT_EQ(flags_[0][8], quality::kTimeBackwards | quality::kClockJump);
  EXPECT_EQ(flags_[0][9], quality::kGood);
}

TEST_F(CsvReaderTest, TimeThatStandsStillIsRefused) {
  Read("t,p,z\n1,2,3\n1,2,3\n1,2,3\n");
  EXPECT_THAT(error_, HasSubstr("the time does not increase"));
}

TEST_F(CsvReaderTest, LineWithoutEndIsRefused) {
  Read("t,p,z\n" + Rows(1, 20) + std::string(LineBuffer::kLongestLine + 10, '7'));
  EXPECT_EQ(counters_.rows, 20);
  EXPECT_THAT(error_, HasSubstr("no line end within 16 MB"));
}

TEST_F(CsvReaderTest, ResultsDoNotDependOnBlockSize) {
  std::string text = "t,p,z\n";
  for (int i = 1; i <= 3000; ++i) {
    if (i % 97 == 0) text += fmt::format("{},{},fault\n", i, i);
    if (i % 101 == 0) text += fmt::format("{},5\n", i);
    if (i % 103 != 0) text += fmt::format("{},{:.{}f},\"{}\"\n", i, std::sin(i) * 1e3, i % 9, -i);
  }
  Read(text, 1024);
  const auto time = time_;
  const auto values = values_;
  const auto flags = flags_;
  const auto flagged = counters_.flagged;
  ASSERT_GT(time.size(), 2900u);
  for (const std::size_t rows : {1u, 7u, 100000u}) {
    Read(text, rows);
    EXPECT_EQ(time_, time);
    EXPECT_EQ(flags_, flags);
    EXPECT_EQ(counters_.flagged, flagged);
    for (std::size_t i = 0; i < time.size(); ++i)
      EXPECT_TRUE(values_[1][i] == values[1][i] || std::isnan(values[1][i]));
    EXPECT_EQ(values_[0], values[0]);
  }
}

class CsvFileTest : public CsvReaderTest {
 protected:
  CsvFileTest()
      : path_(std::filesystem::temp_directory_path() / fmt::format("hydroscope_csv_{}", ::getpid())) {}
  ~CsvFileTest() override { std::filesystem::remove(path_); }
  void WriteGzip(const std::string& text) {
    gzFile file = gzopen(path_.c_str(), "wb");
    gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
    gzclose(file);
  }
  std::filesystem::path path_;
};

TEST_F(CsvFileTest, ReadsGzip) {
  WriteGzip("t,p,z\n" + Rows(1, 50000));
  auto source = OpenFileSource(path_);
  ASSERT_TRUE(source);
  ReadFrom(std::move(*source), 1000);
  EXPECT_EQ(counters_.rows, 50000);
  EXPECT_EQ(values_[1][49999], 5e6);
}

/// ASCII in UTF-16 behind its byte order mark.
std::string Utf16(const std::string& text, bool little) {
  std::string wide = little ? "\xFF\xFE" : "\xFE\xFF";
  for (const char c : text) wide += little ? std::string{c, '\0'} : std::string{'\0', c};
  return wide;
}

TEST_F(CsvFileTest, ReadsUtf16AsSpreadsheetsWriteIt) {
  for (const bool little : {true, false}) {
    std::ofstream(path_, std::ios::binary) << Utf16("t,p,z\n" + Rows(1, 50000), little);
    auto source = OpenFileSource(path_);
    ASSERT_TRUE(source);
    ReadFrom(std::move(*source), 1000);
    EXPECT_EQ(counters_.rows, 50000);
    EXPECT_EQ(values_[1][49999], 5e6);
  }
  WriteGzip(Utf16("t,p,z\n" + Rows(1, 2000), true));
  auto packed = OpenFileSource(path_);
  ASSERT_TRUE(packed);
  ReadFrom(std::move(*packed), 1000);
  EXPECT_EQ(counters_.rows, 2000);
}

TEST_F(CsvFileTest, CutOffGzipGivesRowsThenAnError) {
  WriteGzip("t,p,z\n" + Rows(1, 200000));
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 2);
  auto source = OpenFileSource(path_);
  ASSERT_TRUE(source);
  ReadFrom(std::move(*source), 1000);
  EXPECT_GT(counters_.rows, 1000);
  EXPECT_THAT(error_, HasSubstr("damaged or cut off"));
}

TEST_F(CsvFileTest, AbsentFileIsRefused) {
  const auto source = OpenFileSource("/nonexistent/log.csv");
  ASSERT_FALSE(source);
  EXPECT_THAT(source.error().text, HasSubstr("No such file"));
}

TEST_F(CsvFileTest, MemoryDoesNotGrowWithTheFile) {
  std::string rows;
  for (int i = 0; i < 10000; ++i) rows += "0.123456,20879391,0.2001063\n";
  {
    std::ofstream file(path_);
    file << "t,p,z\n0,1,1\n1,1,1\n";
    while (file.tellp() < 200'000'000) file << rows;
  }
  const auto peak = [] {
    rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;  // kB
  };
  const long before = peak();
  machine_.log.sample_period = 1;
  auto reader = CsvReader::Open(std::move(*OpenFileSource(path_)), machine_, "log.csv");
  SampleBlock block;
  std::size_t total = 0;
  while (const auto got = *(*reader)->Read(block, 1024)) total += got;
  EXPECT_GT(total, 7'000'000u);
  EXPECT_LT(peak() - before, 50 * 1024);
}

}  // namespace
}  // namespace hydroscope
