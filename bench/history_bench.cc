// history_bench DB [STROKES [AXES]]: how long `explain --db` takes on a large database. Fills DB, if it is
// not there yet, with STROKES strokes (default 100 000) of each of AXES machines (default 4) through the
// storage itself: some 200 fully simulated strokes of each, over and over; the second machine has a leak past
// the piston seal. Then reads and explains each machine and all of them as a fleet, as the command does, from
// a freshly opened file. Prints wall and CPU seconds, and what was found.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "host/output.h"
#include "storage/database.h"
#include "studies/simulated_history.h"
#include "studies/simulated_strokes.h"
#include "workbench/explain/explain_history.h"

namespace hydroscope {
namespace {

constexpr double kSeconds = 1200;  // of simulated log per machine
constexpr std::size_t kLeaky = 1;

Status FillMachine(Database& database, std::size_t axis, std::int64_t strokes, ProgressBar& progress) {
  PressOptions press = RandomMachine(500);  // cushions of one press: the same geometry
  press.seed = 501 + axis;
  press.seconds = kSeconds;
  press.oil_start = 303;
  press.oil_end = 323;
  if (axis == kLeaky) press.effects = {{"internal_leakage", 4e-12, {}}};
  Machine machine = MachineFor(press);
  machine.name = fmt::format("cushion {}", axis + 1);
  auto log = TRY(StrokesOf(SimulatePress(press), machine));
  return StoreOverAndOver(
      database, machine.name, FormatMachine(machine), log, strokes, strokes, [&](std::int64_t stored) {
        progress.Update(
            (static_cast<double>(axis) + static_cast<double>(stored) / static_cast<double>(strokes)) / 4,
            stored);
      });
}

struct Explained {
  double wall = 0, cpu = 0;
  std::int64_t strokes = 0;
  std::string text;
};

Result<Explained> ExplainMachines(const std::string& path, const std::vector<std::string>& names) {
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  auto database = TRY(Database::OpenReadOnly(path));
  const auto parts = TRY(ChosenMachines(database, path, names));
  const auto machine = TRY(StoredMachine(database, path, parts.front()));
  const auto history = TRY(LoadHistory(database, path, parts, machine));
  const auto result = TRY(ExplainHistory(history));
  return Explained{
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
      static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC, history.strokes(),
      fmt::format("{} {}", VerdictName(result.explanation.verdict), fmt::join(result.explanation.set, ", "))};
}

Status Run(const std::string& path, std::int64_t strokes, std::size_t axes) {
  if (!std::filesystem::exists(path)) {
    auto database = TRY(Database::Open(path));
    ProgressBar progress("filling", "strokes");
    for (std::size_t a = 0; a < axes; ++a) TRY(FillMachine(database, a, strokes, progress));
  }
  fmt::print("{} of {:.1f} GB\n", path, static_cast<double>(std::filesystem::file_size(path)) * 1e-9);
  const auto print = [](const std::string& what, const Explained& e) {
    fmt::print("{:<12} {:>8} strokes  {:.3f} s wall  {:.3f} s CPU  {}\n", what, e.strokes, e.wall, e.cpu,
               e.text);
  };
  for (std::size_t a = 0; a < axes; ++a) {
    const std::string name = fmt::format("cushion {}", a + 1);
    const auto one = TRY(ExplainMachines(path, {name}));
    print(name, one);
  }
  const auto fleet = TRY(ExplainMachines(path, {}));
  print("fleet", fleet);
  return {};
}

}  // namespace
}  // namespace hydroscope

int main(int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') {
    std::fprintf(stderr, "usage: history_bench DB [STROKES [AXES]]\n");
    return 2;
  }
  const auto done = hydroscope::Run(argv[1], argc > 2 ? std::atoll(argv[2]) : 100'000,
                                    argc > 3 ? static_cast<std::size_t>(std::atoll(argv[3])) : 4);
  if (!done) std::fprintf(stderr, "%s\n", done.error().text.c_str());
  return done ? 0 : 1;
}
