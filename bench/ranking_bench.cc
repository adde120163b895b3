// ranking_bench LOG MACHINE MATRIX [REPEATS]: CPU seconds of the ranking step of `explain`: every effect of
// the library tried on top of the base model, fitted, and judged on strokes left out. Writes the equations it
// works on to MATRIX, a row of doubles per equation (base columns, output, effects), for
// bench/sklearn_omp.py. Best of REPEATS (default 20). Prints "ranking SECONDS EQUATIONS COLUMNS BASE" and the
// effects in their order.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "acquisition/quality_monitor.h"
#include "diagnosis/effect_ranking.h"
#include "models/machine.h"
#include "pipeline/batch_fit.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsPerBlock = 1024;

/// All equations of the log in the integral form, a column each.
Result<std::int64_t> WriteEquations(const std::string& log, const Machine& machine, const std::string& path) {
  auto reader = TRY(OpenLog(log, machine));
  auto pipeline = TRY(Pipeline::Create(machine, reader->SamplePeriod(), [](StrokeRecord&&) {}));
  QualityMonitor monitor(machine, reader->SamplePeriod());
  std::ofstream file(path, std::ios::binary);
  std::int64_t equations = 0;
  pipeline->set_tap([&](const Stretch&, const SpanEquations& span) {
    file.write(reinterpret_cast<const char*>(span.integral.data()),
               static_cast<std::streamsize>(sizeof(double)) * span.integral.rows() * span.equations);
    equations += span.equations;
  });
  SampleBlock block;
  for (;;) {
    const auto rows = TRY(reader->Read(block, kRowsPerBlock));
    if (rows == 0) break;
    monitor.Inspect(block);
    pipeline->Process(block);
  }
  monitor.Flush(block);
  pipeline->Process(block);
  pipeline->Finish();
  if (!file.flush()) return BadInput("{}: cannot be written", path);
  return equations;
}

Status Run(const std::string& log, const std::string& machine_file, const std::string& matrix, int repeats) {
  const auto machine = TRY(LoadMachine(machine_file));
  const auto equations = TRY(WriteEquations(log, machine, matrix));
  const auto strokes = TRY(ReadStrokes(log, machine));
  const std::vector<StrokeGram> grams = strokes.Grams();
  const ExplainOptions options;
  double best = 1e9;
  std::vector<RankedEffect> ranking;
  for (int k = 0; k < repeats; ++k) {
    const std::clock_t begin = std::clock();
    const StrokeSet set(strokes.model, grams, strokes.window);
    const CandidateModel base{{}, set.Fit({})};
    ranking = EffectRanking(set, options, base.fit.noise_variance).Rank(base);
    best = std::min(best, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  fmt::print("ranking {:.6f} {} {} {}\n", best, equations, strokes.model->column_count(),
             strokes.model->base_count);
  for (std::size_t k = 0; k < std::min<std::size_t>(3, ranking.size()); ++k)
    fmt::print("effect {} {:.0f}\n", ranking[k].id, ranking[k].gain);
  return {};
}

}  // namespace
}  // namespace hydroscope

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: ranking_bench LOG MACHINE MATRIX [REPEATS]\n");
    return 2;
  }
  const auto done = hydroscope::Run(argv[1], argv[2], argv[3], argc > 4 ? std::atoi(argv[4]) : 20);
  if (!done) std::fprintf(stderr, "%s\n", done.error().text.c_str());
  return done ? 0 : 1;
}
