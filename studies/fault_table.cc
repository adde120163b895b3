#include "studies/fault_table.h"

#include <algorithm>

#include "live/verify_live.h"

namespace hydroscope {
namespace {

using Json = nlohmann::json;

constexpr double kStaleAllowed = 0.2 + 0.1;  // s: two periods of the slow channels, and the time to ask
constexpr double kBackAllowed = 4.0;         // s: twice the longest pause between attempts

/// All channels of that signal are stale, or none is.
bool Stale(const Json& status, const std::string& signal, bool wanted) {
  bool any = false;
  for (const auto& channel : status.at("channels"))
    if (channel.at("name").get<std::string>().ends_with("/" + signal)) {
      any = true;
      if (channel.at("stale").get<bool>() != wanted) return false;
    }
  return any;
}

}  // namespace

std::int64_t SumOverAxes(const Json& status, const char* counter) {
  std::int64_t sum = 0;
  for (const auto& axis : status.at("axes")) sum += axis.at("counters").at(counter).get<std::int64_t>();
  return sum;
}

Result<ReplayCount> CountReplays(const std::string& database) {
  const auto verified = TRY(VerifyLive(database));
  ReplayCount count;
  for (const VerifiedRun& run : verified) {
    count.same += run.outcome == VerifiedRun::Outcome::kSame;
    count.different += run.outcome == VerifiedRun::Outcome::kDiffers;
    count.strokes += run.strokes;
  }
  return count;
}

Result<bool> ReplaysAreTheSame(const std::string& database, int exit_code) {
  const auto replays = TRY(CountReplays(database));
  fmt::print("runs whose replay is the same to the last bit: {} of {}; exit code {}\n", replays.same,
             replays.same + replays.different, exit_code);
  return replays.ok();
}

FaultTable::FaultTable(LiveRig& rig) : rig_(rig) {
  fmt::print("{:<46} {:>12} {:>12}   {}\n", "fault", "stale after", "back after", "");
}

void FaultTable::Cut(const std::string& what, const std::string& signal, double seconds,
                     const std::function<void()>& begin, const std::function<void()>& end) {
  rig_.WaitFor([&](const Json& s) { return Stale(s, signal, false); }, kPatience);
  begin();
  const auto stale = rig_.WaitFor([&](const Json& s) { return Stale(s, signal, true); }, kPatience);
  Sleep(std::max(0.0, seconds - stale.value_or(0)));
  end();
  const auto back = rig_.WaitFor([&](const Json& s) { return Stale(s, signal, false); }, kPatience);
  const bool ok = stale && *stale <= kStaleAllowed && back && *back <= kBackAllowed && rig_.service().Alive();
  Row(what, stale, back, ok, "");
}

void FaultTable::Row(const std::string& what, std::optional<double> stale, std::optional<double> back,
                     bool ok, const std::string& note) {
  const auto shown = [](std::optional<double> s) {
    return s ? fmt::format("{:.2f} s", *s) : std::string("-");
  };
  fmt::print("{:<46} {:>12} {:>12}   {}{}{}\n", what, shown(stale), shown(back), ok ? "reached" : "MISSED",
             note.empty() ? "" : ": ", note);
  std::fflush(stdout);
  missed_ += !ok;
}

}  // namespace hydroscope
