#include "live/check_live.h"

#include <gtest/gtest.h>

#include <sstream>

#include "core/shown_width.h"

namespace hydroscope {
namespace {

TEST(CheckLive, RowsOfChannelsFitALine) {
  LiveCheck check;
  CheckedChannel pressure;
  pressure.name = "cushion_12/p_A";
  pressure.unit = "Pa";
  pressure.rate = 1003;
  pressure.age = 0.054;
  pressure.min = -1.23456e5;
  pressure.max = 219.87654e5;
  pressure.noise_std = 2.19e5;
  pressure.flagged = 123456;
  CheckedChannel state = pressure;
  state.name = "cushion_12/strokes";
  state.unit = "1";
  check.channels = {pressure, state};
  const std::string text = LiveCheckText(check);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(ShownWidth(line), 80U) << line;
  EXPECT_NE(text.find("cushion_12/p_A      1003     54     -1.235      219.9     2.19 bar    123456"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find(" -      123456"), std::string::npos) << "a number has no unit\n" << text;
}

}  // namespace
}  // namespace hydroscope
