#include "setup/log_shape.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "setup/log_columns.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

/// What is wrong with a log of this text, "" if nothing is.
std::string FaultOf(const std::string& text) {
  const auto path = std::filesystem::path(testing::TempDir()) / "log_shape_test.csv";
  std::ofstream(path, std::ios::binary) << text;
  const auto head = ReadLogColumns(path);
  std::filesystem::remove(path);
  return head ? "" : head.error().text;
}

/// Forty rows of this form, with the number of the row.
std::string Rows(const std::string& header, const std::function<std::string(int)>& row) {
  std::string text = header + "\n";
  for (int k = 0; k < 40; ++k) text += row(k) + "\n";
  return text;
}

TEST(LogShape, NumbersInGroupsOfDigitsAreNamed) {
  for (const char* number : {"2.935.570,5", "1.200,5", "12'345'678", "-1.234.567"})
    EXPECT_THAT(FaultOf(Rows("t;p;z", [&](int k) { return fmt::format("0,{:02};{};{}", k, number, k); })),
                HasSubstr(fmt::format("column 'p': the numbers group their digits (\"{}\")", number)));
}

TEST(LogShape, WordsThatAreNoSuchNumbersAreLeftAlone) {
  for (const char* word : {"RUN", "1.2.3", "192.168.10.200", "12:30", "v1.200,5"})
    EXPECT_EQ(FaultOf(Rows("t;p;z", [&](int k) { return fmt::format("0,{:02};{};{}", k, word, k); })), "")
        << word;
}

TEST(LogShape, OneValueInARowBesideTheNameOfItsSignalIsNamed) {
  const std::string wanted = "column 'signal' names its signal (\"p_A\", \"z\", ...)";
  EXPECT_THAT(
      FaultOf(Rows("t,signal,value",
                   [](int k) { return fmt::format("{},{},{}", k / 2, k % 2 ? "z" : "p_A", 0.5 * k); })),
      HasSubstr(wanted));
  EXPECT_THAT(
      FaultOf(Rows("signal,t,value",
                   [](int k) { return fmt::format("{},{},{}", k < 20 ? "p_A" : "z", k % 20, 0.5 * k); })),
      HasSubstr(wanted));
}

TEST(LogShape, AStateOfTheMachineBesideItsSignalsIsNone) {
  EXPECT_EQ(
      FaultOf(Rows("t,state,p_A",
                   [](int k) { return fmt::format("{},{},{}", k, k % 10 < 5 ? "up" : "down", 0.5 * k); })),
      "");
}

TEST(LogShape, RowsFromTheNewestToTheOldestAreNamed) {
  EXPECT_THAT(FaultOf(Rows("t,p_A", [](int k) { return fmt::format("{},{}", 40 - k, k); })),
              HasSubstr("column 't': the time falls from row to row"));
}

}  // namespace
}  // namespace hydroscope
