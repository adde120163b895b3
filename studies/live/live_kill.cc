#include <signal.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "host/output.h"
#include "storage/database.h"
#include "studies/fault_table.h"
#include "studies/live/live_benchmarks.h"

namespace hydroscope {
namespace {

constexpr double kStartAllowed = 2.0;  // s
constexpr double kRigPatience = 10.0;  // s
constexpr double kLongLife = 6.0;      // s more for every tenth life, so that strokes end in it

struct Acknowledged {
  std::int64_t run = 0, strokes = 0, rows = 0;
};

/// What the service said was stored, the newest word per axis and run.
std::map<std::pair<std::string, std::int64_t>, Acknowledged> ReadAcknowledged(const std::string& log) {
  std::map<std::pair<std::string, std::int64_t>, Acknowledged> newest;
  std::ifstream file(log);
  std::string line, stored, axis, word;
  while (std::getline(file, line) && !file.eof()) {  // a line without its end was not said
    std::istringstream in(line);
    Acknowledged a;
    if (in >> stored >> axis >> word >> a.run >> word >> a.strokes >> word >> a.rows && stored == "stored")
      newest[{axis, a.run}] = a;
  }
  return newest;
}

/// Faults of the database against what was acknowledged, one sentence each.
Result<std::vector<std::string>> Check(
    const std::string& path, const std::map<std::pair<std::string, std::int64_t>, Acknowledged>& said) {
  std::vector<std::string> faults;
  auto database = TRY(Database::OpenReadOnly(path));
  if (const Status sound = database.CheckIntegrity(); !sound) faults.push_back(sound.error().text);
  const auto names = TRY(database.MachineNames());
  for (const std::string& name : names) {
    const auto machine = database.MachineId(name);
    const auto runs = database.Runs(*machine);
    const auto extents = database.RawExtents(*machine);
    if (!runs || !extents) return tl::unexpected(!runs ? runs.error() : extents.error());
    double last_end = 0, raw_end = 0;
    for (const RunInfo& run : *runs) {
      const auto word = said.find({name, run.id});
      const auto strokes = TRY(database.Strokes(run.id));
      if (word != said.end() && run.strokes < word->second.strokes)
        faults.push_back(fmt::format("{} run {}: {} strokes acknowledged, {} stored", name, run.id,
                                     word->second.strokes, run.strokes));
      for (const StrokeSummary& stroke : strokes) {
        if (stroke.begin < last_end)
          faults.push_back(fmt::format("{} run {}: stroke {} twice", name, run.id, stroke.index));
        last_end = stroke.end;
      }
      const auto extent = std::ranges::find_if(*extents, [&](const RawExtent& e) { return e.run == run.id; });
      const std::int64_t rows = extent == extents->end() ? 0 : extent->rows;
      if (word != said.end() && rows < word->second.rows)
        faults.push_back(
            fmt::format("{} run {}: {} rows acknowledged, {} stored", name, run.id, word->second.rows, rows));
      if (extent == extents->end()) continue;
      if (extent->rows != extent->rows_taken)
        faults.push_back(fmt::format("{} run {}: rows and count differ", name, run.id));
      if (extent->first <= raw_end)
        faults.push_back(fmt::format("{} run {}: its rows lie before those of the run before", name, run.id));
      raw_end = extent->last;
    }
  }
  for (const auto& [key, word] : said) {
    const auto& [name, run_id] = key;
    const auto runs = database.Runs(*database.MachineId(name));
    if (runs && std::ranges::count(*runs, run_id, &RunInfo::id) == 0)
      faults.push_back(fmt::format("{}: run {} was acknowledged and is gone", name, run_id));
  }
  return faults;
}

/// How a start went, s after it.
struct Start {
  std::optional<double> answered, received, stored;

  std::string Describe(int kill) const {
    const auto shown = [](std::optional<double> s) { return s ? fmt::format("{:.2f} s", *s) : "never"; };
    return fmt::format("start {}: status answered after {}, samples came after {}, rows were stored after {}",
                       kill, shown(answered), shown(received), shown(stored));
  }
};

Start Restart(LiveRig& rig) {
  Start start;
  const double begin = Now();
  const auto reached =
      [&](const std::function<bool(const nlohmann::json&)>& condition) -> std::optional<double> {
    if (!rig.WaitFor(condition, kRigPatience)) return std::nullopt;
    return Now() - begin;
  };
  rig.StartService({"--acknowledge", "--raw-period", "0.2"});
  start.answered = reached([](const nlohmann::json&) { return true; });
  start.received = reached([](const nlohmann::json& s) {
    return std::any_of(s.at("sources").begin(), s.at("sources").end(), [](const nlohmann::json& source) {
      return source.at("name").get<std::string>().starts_with("dds") &&
             source.at("rows").get<std::int64_t>() > 0;
    });
  });
  start.stored =
      reached([](const nlohmann::json& s) { return s.at("writer").at("rows").get<std::int64_t>() > 0; });
  return start;
}

}  // namespace

int RunLiveKill(const LiveKillOptions& o) {
  LiveRig rig({.seed = o.seed, .transport = o.transport, .folder = {}});
  rig.StartPress();
  std::mt19937_64 random(o.seed);
  std::uniform_real_distribution<double> life(0.1, 3.0);
  std::vector<double> back;
  std::vector<std::string> slow;
  int silent = 0;
  ProgressBar progress("killing", "times");
  for (int k = 0; k <= o.times; ++k) {
    const Start start = Restart(rig);
    if (start.stored)
      back.push_back(*start.stored);
    else
      ++silent;
    if (!start.stored || *start.stored > kStartAllowed) slow.push_back(start.Describe(k));
    if (k == o.times) break;
    Sleep(life(random) + (k % 10 == 9 ? kLongLife : 0));
    rig.service().End(SIGKILL);
    progress.Update(static_cast<double>(k) / o.times, k);
  }
  Sleep(5);
  const int ended = rig.service().End(SIGTERM);
  const auto said = ReadAcknowledged(rig.File("serve.log"));
  const auto faults = Check(rig.database(), said);
  if (!faults) return ReportError(faults.error());
  const auto replays = CountReplays(rig.database());
  if (!replays) return ReportError(replays.error());
  std::ranges::sort(back);
  const double worst = back.empty() ? 99 : back.back();
  fmt::print("kill -9 of the service under load, {} times, 4 axes at 1 kHz, DDS transport {}\n", o.times,
             o.transport);
  fmt::print("{:<60} {:>10}\n", "runs acknowledged", said.size());
  fmt::print("{:<60} {:>10}\n", "strokes stored", replays->strokes);
  fmt::print("{:<60} {:>10}   required none\n", "acknowledged and missing, or there twice", faults->size());
  fmt::print("{:<60} {:>8.2f} s\n", "start to first rows stored, median",
             back.empty() ? 99 : back[back.size() / 2]);
  fmt::print("{:<60} {:>8.2f} s   required at most {:g} s\n", "start to first rows stored, worst", worst,
             kStartAllowed);
  fmt::print("{:<60} {:>10}   required none\n", "starts without data within 10 s", silent);
  fmt::print("{:<60} {:>10}   required none\n",
             fmt::format("starts that took more than {:g} s", kStartAllowed), slow.size());
  fmt::print("{:<60} {:>10}   required all of {}\n", "runs whose replay from the stored state is the same",
             replays->same, replays->same + replays->different);
  fmt::print("{:<60} {:>10}   required 0\n", "exit code after SIGTERM", ended);
  for (const std::vector<std::string>& lines : {slow, *faults})
    for (std::size_t i = 0; i < std::min<std::size_t>(lines.size(), 10); ++i) fmt::print("  {}\n", lines[i]);
  return faults->empty() && silent == 0 && replays->ok() && worst <= kStartAllowed && ended == 0 ? 0 : 1;
}

}  // namespace hydroscope
