// replay_bench LOG MACHINE [REPEATS]: seconds of CPU time a replay spends in its stages, best of REPEATS
// (default 5). Each stage is the one before and something more. Prints "stage seconds rows" per line.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <iostream>
#include <vector>

#include "acquisition/quality_monitor.h"
#include "pipeline/pipeline.h"
#include "replay/log_reader.h"
#include "storage/database.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsPerBlock = 1024;
constexpr std::size_t kStrokesPerBatch = 256;

using RowSink = std::function<Status(SampleBlock&)>;

std::string DatabaseFor(const std::string& log) {
  return std::filesystem::path(log).replace_extension(".bench.db").string();
}

/// CPU seconds of this process: what other programs take on the same core does not count.
double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Result<std::int64_t> ReadAll(LogReader& reader, const RowSink& take) {
  SampleBlock block;
  for (;;) {
    const auto rows = TRY(reader.Read(block, kRowsPerBlock));
    if (rows == 0) return reader.counters().rows;
    TRY(take(block));
  }
}

Result<std::int64_t> Read(const std::string& log, const Machine& machine) {
  auto reader = TRY(OpenLog(log, machine));
  return ReadAll(*reader, [](SampleBlock&) { return Status{}; });
}

Result<std::int64_t> ReadAndInspect(const std::string& log, const Machine& machine) {
  auto reader = TRY(OpenLog(log, machine));
  QualityMonitor monitor(machine, reader->SamplePeriod());
  return ReadAll(*reader, [&](SampleBlock& block) {
    monitor.Inspect(block);
    return Status{};
  });
}

/// The whole replay but the report; strokes go to `store` in batches.
Result<std::int64_t> Replay(const std::string& log, const Machine& machine,
                            const std::function<Status(Pipeline&, std::vector<StrokeRecord>&)>& store) {
  auto reader = TRY(OpenLog(log, machine));
  std::vector<StrokeRecord> waiting;
  auto pipeline = TRY(Pipeline::Create(machine, reader->SamplePeriod(),
                                       [&](StrokeRecord&& record) { waiting.push_back(std::move(record)); }));
  QualityMonitor monitor(machine, reader->SamplePeriod());
  const auto rows = ReadAll(*reader, [&](SampleBlock& block) -> Status {
    monitor.Inspect(block);
    pipeline->Process(block);
    if (waiting.size() < kStrokesPerBatch) return {};
    return store(*pipeline, waiting);
  });
  if (!rows) return rows;
  SampleBlock rest;
  monitor.Flush(rest);
  pipeline->Process(rest);
  pipeline->Finish();
  TRY(store(*pipeline, waiting));
  return rows;
}

Result<std::int64_t> Identify(const std::string& log, const Machine& machine) {
  return Replay(log, machine, [](Pipeline&, std::vector<StrokeRecord>& strokes) {
    strokes.clear();
    return Status{};
  });
}

Result<std::int64_t> IdentifyAndStore(const std::string& log, const Machine& machine) {
  auto database = TRY(Database::Open(DatabaseFor(log)));
  std::int64_t run = -1;
  const auto store = [&](Pipeline& pipeline, std::vector<StrokeRecord>& strokes) -> Status {
    if (run < 0) {
      const auto id = TRY(database.MachineId(machine.name));
      const auto version =
          TRY(database.PutModelVersion(id, {1, FormatMachine(machine), pipeline.model().ColumnNames(), 0,
                                            pipeline.model().ConditionNames()}));
      const auto info = TRY(database.BeginRun(id, version, log, "bench"));
      run = info.id;
    }
    const Status stored = database.StoreStrokes(run, strokes);
    strokes.clear();
    return stored;
  };
  return Replay(log, machine, store);
}

struct Stage {
  const char* name;
  Result<std::int64_t> (*run)(const std::string& log, const Machine& machine);
};

int Run(const std::string& log, const std::string& machine_file, int repeats, const std::string& only) {
  const auto machine = LoadMachine(machine_file);
  if (!machine) {
    std::cerr << machine.error().text << "\n";
    return 3;
  }
  for (const Stage& stage : {Stage{"read", Read}, Stage{"read+quality", ReadAndInspect},
                             Stage{"read+quality+identify", Identify}, Stage{"replay", IdentifyAndStore}}) {
    if (!only.empty() && only != stage.name) continue;
    double best = 1e300;
    std::int64_t rows = 0;
    for (int k = 0; k < repeats; ++k) {
      for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(DatabaseFor(log) + suffix);
      const double start = CpuSeconds();
      const auto done = stage.run(log, *machine);
      if (!done) {
        std::cerr << done.error().text << "\n";
        return 3;
      }
      best = std::min(best, CpuSeconds() - start);
      rows = *done;
    }
    std::cout << fmt::format("{} {:.4f} {}\n", stage.name, best, rows);
  }
  return 0;
}

}  // namespace
}  // namespace hydroscope

int main(int argc, char** argv) {
  if (argc < 3 || argc > 5) {
    std::cerr << "usage: replay_bench LOG MACHINE [REPEATS [STAGE]]\n";
    return 2;
  }
  return hydroscope::Run(argv[1], argv[2], argc > 3 ? std::atoi(argv[3]) : 5, argc > 4 ? argv[4] : "");
}
