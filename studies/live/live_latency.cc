#include <signal.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "host/output.h"
#include "host/real_clock.h"
#include "live/process_use.h"
#include "models/live_spec.h"
#include "models/machine.h"
#include "monitor/press_monitor.h"
#include "storage/database.h"
#include "studies/fault_table.h"
#include "studies/live/live_benchmarks.h"
#include "studies/simulated_history.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

constexpr int kAxesOfOnePress = 64;
constexpr double kHistorySeconds = 300;  // of the simulated log whose strokes fill the history
constexpr double kSettle = 5.0;          // s before anything is measured

void Print(const char* what, const std::string& value, const std::string& required, bool reached) {
  fmt::print("{:<52} {:>14}   {:<18} {}\n", what, value, required,
             required.empty() ? ""
             : reached        ? "reached"
                              : "MISSED");
}

/// s, p99 of stroke sent to estimate stored.
double LatencyAllowed(int axes) { return axes <= kAxesOfOnePress ? 0.020 : 0.100; }

Status FillDatabase(const LiveRig& rig, const Machine& machine, const LiveLatencyOptions& o) {
  PressOptions press;
  press.seconds = kHistorySeconds;
  const auto log = TRY(StrokesOf(SimulatePress(press), MachineFor(press)));
  auto database = TRY(Database::Open(rig.database()));
  std::ifstream file(rig.File("service.toml"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  ProgressBar progress("filling the database", "strokes");
  for (int a = 0; a < o.axes; ++a) {
    const std::int64_t before = a * o.history;
    TRY(StoreOverAndOver(
        database, AxisMachineName(machine, a), text, log, o.history, o.grams, [&](std::int64_t strokes) {
          progress.Update(static_cast<double>(before + strokes) / static_cast<double>(o.axes * o.history),
                          before + strokes);
        }));
  }
  return {};
}

/// The past of a press that has worked for long, judged by its drift watch; a database that lies in the folder already is
/// taken as it is.
Status PrepareHistory(const LiveRig& rig, const LiveLatencyOptions& o) {
  const auto machine = TRY(LoadMachine(rig.File("service.toml")));
  if (!std::filesystem::exists(rig.database())) TRY(FillDatabase(rig, machine, o));
  const auto watch =
      PressMonitor::Create(rig.File("service.toml"), machine.name, MachinesOfAxes(machine), rig.database());
  return watch ? (*watch)->CatchUp(WallSeconds()) : tl::unexpected(watch.error());
}

/// What the service did while it was measured.
struct ServedTime {
  nlohmann::json first, last;  ///< its status at begin and end
  ProcessUse before, after;
  double seconds = 0;

  std::int64_t Rose(const char* counter) const {
    return SumOverAxes(last, counter) - SumOverAxes(first, counter);
  }
};

Result<ServedTime> Serve(LiveRig& rig, const LiveLatencyOptions& o) {
  rig.StartPress();
  rig.StartService();
  const auto running = [](const nlohmann::json& s) {
    return !s.at("axes").empty() && SumOverAxes(s, "rows") > 0;
  };
  if (!rig.WaitFor(running, 20))
    return InternalError("the service received nothing from the simulated press within 20 s{}",
                         rig.LastWords());
  Sleep(kSettle);
  ServedTime served;
  const auto first = rig.Ask();
  const double begin = Now();
  served.before = UseOf(std::to_string(rig.service().pid()));
  ProgressBar progress("serving", "s");
  while (Now() - begin < o.seconds) {
    Sleep(0.5);
    progress.Update((Now() - begin) / o.seconds, static_cast<std::int64_t>(Now() - begin));
  }
  served.seconds = Now() - begin;
  served.after = UseOf(std::to_string(rig.service().pid()));
  const auto last = rig.Ask();
  if (!first || !last) return InternalError("the service does not answer");
  served.first = *first;
  served.last = *last;
  return served;
}

/// How late the press was at worst by its own clock, as it says when it ends: "... at worst 3.1 ms late".
std::string LatenessOf(LiveRig& rig) {
  rig.press().End(SIGTERM);
  std::ifstream log(rig.File("press.log"));
  const std::string text{std::istreambuf_iterator<char>(log), {}};
  const std::string before = "at worst ";
  const std::size_t begin = text.rfind(before), end = text.find(" late", begin);
  return end == text.npos ? "not told" : text.substr(begin + before.size(), end - begin - before.size());
}

}  // namespace

int RunLiveLatency(const LiveLatencyOptions& o) {
  LiveRig rig({.axes = o.axes, .rate = o.rate, .modbus_ring = o.ring, .seed = o.seed, .folder = o.folder});
  if (o.history > 0)
    if (const Status ready = PrepareHistory(rig, o); !ready) return ReportError(ready.error());
  const auto served = Serve(rig, o);
  if (!served) return ReportError(served.error());
  const int nice = rig.nice();
  const int ended = rig.service().End(SIGTERM);
  const std::string lateness = LatenessOf(rig);
  const auto replays = CountReplays(rig.database());
  if (!replays) return ReportError(replays.error());

  const double measured = served->seconds;
  const auto& writer = served->last.at("writer");
  const double p99 = writer.at("latency_p99_s").get<double>();
  const double allowed = LatencyAllowed(o.axes);
  const double share = (served->after.cpu - served->before.cpu) / measured;
  const auto rows = static_cast<double>(served->Rose("rows"));
  const std::int64_t lost = served->Rose("missing_rows") + served->Rose("skipped_rows");
  const std::int64_t dropped = served->last.at("inbox").at("dropped_values").get<std::int64_t>() +
                               writer.at("dropped_rows").get<std::int64_t>() +
                               writer.at("dropped_strokes").get<std::int64_t>();
  const bool four = o.axes <= 4 && o.rate <= 1000;  // what the share is required of
  const std::string with_grams =
      o.grams < o.history ? fmt::format(" (the newest {} with Grams)", o.grams) : "";
  fmt::print(
      "{} axes at {:g} Hz, {}, {:.0f} s, {} older strokes of each{}, service and press at niceness {}\n",
      o.axes, o.rate, o.ring ? "Modbus burst ring" : "DDS", measured, o.history, with_grams, nice);
  Print("strokes stored", fmt::format("{}", writer.at("strokes").get<std::int64_t>()), "", true);
  Print("stroke sent to estimate stored, p50",
        fmt::format("{:.1f} ms", writer.at("latency_p50_s").get<double>() * 1e3), "", true);
  Print("stroke sent to estimate stored, p99", fmt::format("{:.1f} ms", p99 * 1e3),
        fmt::format("at most {:.0f} ms", allowed * 1e3), p99 <= allowed);
  Print("stroke sent to estimate stored, worst",
        fmt::format("{:.1f} ms", writer.at("latency_max_s").get<double>() * 1e3), "", true);
  Print("... of these the press itself late, worst", lateness, "", true);
  Print("pipeline to estimate stored, p99",
        fmt::format("{:.1f} ms", writer.at("commit_p99_s").get<double>() * 1e3), "", true);
  Print("share of one core", fmt::format("{:.1f} %", share * 100), four ? "at most 15 %" : "", share <= 0.15);
  Print("memory", fmt::format("{} MB", served->after.memory >> 20), "", true);
  Print("rows per axis and second", fmt::format("{:.1f}", rows / o.axes / measured),
        fmt::format("{:g} within 2 %", o.rate), std::abs(rows / o.axes / measured / o.rate - 1) < 0.02);
  Print("rows missing", fmt::format("{}", lost), "none", lost == 0);
  Print("dropped in queues", fmt::format("{}", dropped), "none", dropped == 0);
  Print("runs whose replay is the same to the last bit",
        fmt::format("{} of {}", replays->same, replays->same + replays->different), "all", replays->ok());
  Print("exit code after SIGTERM", fmt::format("{}", ended), "0", ended == 0);
  const bool reached = p99 <= allowed && (!four || share <= 0.15) && lost == 0 && dropped == 0 &&
                       replays->ok() && ended == 0 && std::abs(rows / o.axes / measured / o.rate - 1) < 0.02;
  return reached ? 0 : 1;
}

}  // namespace hydroscope
