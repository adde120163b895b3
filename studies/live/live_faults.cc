#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "host/output.h"
#include "storage/mounted_disk.h"
#include "studies/fault_table.h"
#include "studies/live/live_benchmarks.h"
#include "studies/live/write_lock.h"

namespace hydroscope {
namespace {

using Json = nlohmann::json;

constexpr double kPatience = FaultTable::kPatience;

void StepClock(LiveRig& rig, FaultTable& campaign, const char* what, const char* line) {
  const auto before = rig.Ask();
  rig.press().Say(line);
  Sleep(3);
  const auto after = rig.Ask();
  const bool told =
      before && after && SumOverAxes(*after, "clock_jumps") > SumOverAxes(*before, "clock_jumps");
  const bool whole = before && after &&
                     SumOverAxes(*after, "missing_rows") == SumOverAxes(*before, "missing_rows") &&
                     SumOverAxes(*after, "late_rows") == SumOverAxes(*before, "late_rows");
  campaign.Row(what, {}, {}, told && whole,
               told ? whole ? "told; no row lost or twice" : "rows were lost" : "not told");
}

std::optional<double> WaitForWriting(LiveRig& rig) {
  return rig.WaitFor(
      [](const Json& s) {
        return s.at("writer").at("state") == "writing" && s.at("writer").at("waiting_items") < 3;
      },
      kPatience);
}

bool NothingDropped(const LiveRig& rig) {
  const auto status = rig.Ask();
  return status && status->at("writer").at("dropped_strokes") == 0 &&
         status->at("writer").at("dropped_rows") == 0;
}

void LockDatabase(LiveRig& rig, FaultTable& campaign) {
  std::optional<double> told;
  bool held = false;
  {
    const WriteLock lock(rig.database());
    held = lock.held();
    told = rig.WaitFor([](const Json& s) { return s.at("writer").at("state") == "locked"; }, kPatience);
    Sleep(3);
  }
  const auto back = WaitForWriting(rig);
  const bool kept = NothingDropped(rig);
  campaign.Row("database locked by another program", told, back,
               held && told && back && kept && rig.service().Alive(),
               kept ? "nothing dropped" : "something was dropped");
}

/// The disk fills up and is freed; `min_free` in MB.
void FillDisk(LiveRig& rig, FaultTable& campaign, const char* what, const std::string& min_free) {
  if (rig.service().Alive()) rig.service().End(SIGTERM);
  rig.StartService({"--min-free", min_free, "--raw-period", "0.2"});
  rig.WaitFor([](const Json& s) { return s.at("writer").at("rows").get<std::int64_t>() > 0; }, kPatience);
  const auto room = std::filesystem::space(rig.File("")).available;
  std::ofstream(rig.File("ballast"), std::ios::binary)
      << std::string(room - std::min<std::size_t>(room, 256 << 10), 'x');
  const auto told =
      rig.WaitFor([](const Json& s) { return s.at("writer").at("state") == "disk_full"; }, kPatience);
  Sleep(3);
  std::filesystem::remove(rig.File("ballast"));
  const auto back = WaitForWriting(rig);
  const bool kept = NothingDropped(rig);
  campaign.Row(what, told, back, told && back && kept && rig.service().Alive(),
               kept ? "nothing dropped" : "something was dropped");
}

/// Senders and links that fail, clocks of the press, the disk: how soon it is told and over, and that no row is lost.
int RunRowFaults(const LiveFaultOptions& o) {
  const std::string folder =
      (std::filesystem::temp_directory_path() / fmt::format("hydroscope-faults-{}", getpid())).string();
  const storage_test::MountedDisk disk(folder, "64m");
  LiveRig rig({.seed = o.seed, .folder = folder});
  if (const Status begun = rig.Begin({"--min-free", "8"}); !begun) return ReportError(begun.error());
  FaultTable campaign(rig);
  const auto say = [&](const char* line) { return [&rig, line] { rig.press().Say(line); }; };
  campaign.Cut("DDS silent for 5 s", "p_A", 5, say("dds mute"), say("dds on"));
  if (o.long_cuts) campaign.Cut("DDS silent for 60 s", "p_A", 60, say("dds mute"), say("dds on"));
  campaign.Cut(
      "press killed, new one after 2 s (DDS)", "p_A", 2, [&] { rig.KillPress(); }, [&] { rig.StartPress(); });
  campaign.Cut(
      "press killed, new one after 2 s (Modbus)", "T_oil", 2, [&] { rig.KillPress(); },
      [&] { rig.StartPress(); });
  campaign.Cut("Modbus server hangs for 3 s", "T_oil", 3, say("modbus hang"), say("modbus on"));
  campaign.Cut("Modbus server answers garbage for 3 s", "T_oil", 3, say("modbus garbage"), say("modbus on"));
  campaign.Cut("Modbus server answers 0.5 s late for 3 s", "T_oil", 3, say("modbus late=0.5"),
               say("modbus on"));
  Sleep(2);
  StepClock(rig, campaign, "clock of the press +1 h", "clock 3600");
  StepClock(rig, campaign, "clock of the press -1 h", "clock -3600");
  LockDatabase(rig, campaign);
  if (disk.ok()) {
    FillDisk(rig, campaign, "disk full, high-water mark 8 MB", "8");
    FillDisk(rig, campaign, "disk full, no mark", "0");
  } else {
    fmt::print("disk full: not tried, mounting a small disk needs the right to mount\n");
  }
  const int ended = rig.service().End(SIGTERM);
  const auto same = ReplaysAreTheSame(rig.database(), ended);
  if (!same) return ReportError(same.error());
  if (!disk.ok()) std::filesystem::remove_all(folder);
  return campaign.missed() == 0 && *same && ended == 0 ? 0 : 1;
}

}  // namespace

int RunLiveFaults(const LiveFaultOptions& o) {
  // Its press has ended before the next one takes the same ports.
  const int rows = o.brief ? 0 : RunRowFaults(o);
  const int seen = RunOperatorFaults(o);
  return std::max(rows, seen);
}

}  // namespace hydroscope
