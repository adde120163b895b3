#include "cli/machines/press_log.h"

#include <functional>
#include <nlohmann/json.hpp>

#include "cli/machines/press_settings.h"
#include "host/output.h"
#include "host/text_sink.h"
#include "simulator/die_cushion/log_format.h"

namespace hydroscope {
namespace {

constexpr double kExampleSeconds = 90;
constexpr std::int64_t kRowsAtOnce = 1000;

/// `written` hears how many rows there are so far.
Status WriteRows(PressGenerator& press, const std::string& path,
                 const std::function<void(std::int64_t)>& written) {
  auto sink = TRY(TextSink::Open(path));
  std::string text(kPressLogHeader);
  std::int64_t rows = 0;
  for (PressRow row; press.Next(row);) {
    AppendPressLine(row, text);
    if (++rows % kRowsAtOnce != 0) continue;
    if (!sink.Write(text)) break;
    text.clear();
    written(rows);
  }
  sink.Write(text);
  return sink.Close();
}

/// A simulated press with a hidden effect, "" = none.
Status WriteExample(const std::string& effect, double size, const std::string& path) {
  PressOptions options;
  options.seconds = kExampleSeconds;
  options.seed = 4;
  if (!effect.empty()) options.effects = {{effect, size, {}}};
  PressGenerator press(options);
  return WriteRows(press, path, [](std::int64_t) {});
}

}  // namespace

Status WritePressLog(const PressOptions& options, const std::string& path, const std::string& truth_path) {
  PressGenerator press(options);
  {
    ProgressBar progress("simulating", "rows");
    const auto share = [&](std::int64_t rows) {
      return static_cast<double>(rows) / static_cast<double>(press.total_rows());
    };
    TRY(WriteRows(press, path, [&](std::int64_t rows) { progress.Update(share(rows), rows); }));
  }
  if (truth_path.empty()) return {};
  return WriteJson(truth_path, TruthJson(press.truth()));
}

std::vector<ExampleLog> ExamplePressLogs() {
  const auto example = [](const char* id, const char* effect, double size) {
    return ExampleLog{id,
                      [=](const std::string& path) { return WriteExample(effect, size, path); },
                      {{"A_A", PressMachine{}.A_A}}};
  };
  return {example("press_a", "internal_leakage", 4e-12), example("press_b", "relief_valve", 3e-11),
          example("press_healthy", "", 0)};
}

}  // namespace hydroscope
