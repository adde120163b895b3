#include "live/check_live.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "core/shown_width.h"
#include "live/live_service_fixture.h"

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

TEST(CheckLive, ASpoolThatMovesBeyondItsEndsHasAWrongScale) {
  using namespace live_service_test;
  std::string text = kMachine;
  const std::string spool = R"(y_v = { dds = "{axis}/y_v", unit = "1")";
  text.replace(text.find(spool), spool.size(), spool + ", scale = 5");
  const Machine machine = *ParseMachine(text, "press.toml");
  PlayedClock clock;
  const auto sources = [&clock](const Machine&, const Clock&) {
    std::vector<std::unique_ptr<Source>> list;
    list.push_back(std::make_unique<PlayedSource>(clock, 1, 0, 5000, 0));
    return list;
  };
  const auto check = CheckLive(machine, 9, sources, [&clock] { return clock(); });
  ASSERT_TRUE(check) << check.error().text;
  for (const CheckedChannel& channel : check->channels) {
    const bool told = std::ranges::any_of(channel.hints, [](const std::string& hint) {
      return hint.find("% of where it ends") != std::string::npos;
    });
    EXPECT_EQ(told, channel.name.ends_with("/y_v")) << channel.name;
  }
}

}  // namespace
}  // namespace hydroscope
