#include "live/event_log.h"

#include <gmock/gmock.h>

#include "live/log.h"

namespace hydroscope {
namespace {

using testing::ElementsAre;

/// Lines about `event` in the log, oldest first, without its name.
std::vector<std::string> LinesOf(const std::string& event) {
  std::vector<std::string> lines;
  for (const LogLine& line : NewestLogLines())
    if (line.text.starts_with(event + " ")) lines.push_back(line.text.substr(event.size() + 1));
  return lines;
}

TEST(EventLog, TellsOnceAMinuteWhoIsTurnedAway) {
  EventLog log(testing::TempDir() + "/no_journal.db");
  LiveStatus status;
  status.feeds.push_back({.name = "modbus", .connected = true, .state = {}});
  status.sources.push_back({.name = "dds", .connected = true, .state = {"odd"}, .last_received = {}});
  const auto look = [&](double seconds, std::int64_t refused, std::int64_t malformed) {
    status.taken = static_cast<std::int64_t>(seconds * 1e9);
    status.feeds[0].refused = refused;
    status.feeds[0].refusal = fmt::format("10.0.0.{} is not allowed", refused);
    status.sources[0].malformed = malformed;
    log.Look(status);
  };
  look(10, 0, 0);
  look(11, 1, 0);
  for (int second = 12; second < 70; ++second) look(second, second, 7);
  look(72, 300, 7);
  EXPECT_THAT(LinesOf("client_refused"),
              ElementsAre("feed=modbus count=1 why=\"10.0.0.1 is not allowed\"",
                          "feed=modbus count=299 why=\"10.0.0.300 is not allowed\""));
  EXPECT_THAT(LinesOf("malformed_messages"), ElementsAre("source=dds count=7 why=odd"));
}

TEST(EventLog, TellsOfDoubtfulEstimatesOnceAsTheyBegin) {
  EventLog log(testing::TempDir() + "/no_journal.db");
  LiveStatus status;
  status.axes.push_back({.name = "left"});
  const auto look = [&](std::vector<Told> warnings) {
    status.axes[0].warnings = std::move(warnings);
    log.Look(status);
  };
  look({});
  look({{"K is 7 bar", ""}});
  look({{"K is 8 bar", ""}});
  look({});
  look({{"K is 9 bar", ""}});
  EXPECT_THAT(LinesOf("doubtful_estimates"),
              ElementsAre("axis=left why=\"K is 7 bar\"", "axis=left why=\"K is 9 bar\""));
}

}  // namespace
}  // namespace hydroscope
