#include "workbench/history/kept_noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <mutex>
#include <span>
#include <utility>

#include "pipeline/log_trust.h"
#include "pipeline/raw_log.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kStrokesOfKeptRows = 40;  ///< newest ones that tell what noise is like
constexpr std::size_t kRemembered = 64;          ///< results: more than presses have axes

/// What came out for which strokes, the newest first.
class Memory {
 public:
  std::optional<std::optional<NoiseScales>> Find(const std::string& key) const {
    const std::scoped_lock lock(mutex_);
    const auto found = std::ranges::find(results_, key, [](const auto& result) { return result.first; });
    if (found == results_.end()) return {};
    return found->second;
  }
  void Keep(std::string key, const std::optional<NoiseScales>& noise) {
    const std::scoped_lock lock(mutex_);
    ++worked_out_;
    results_.emplace_front(std::move(key), noise);
    if (results_.size() > kRemembered) results_.pop_back();
  }
  std::int64_t worked_out() const {
    const std::scoped_lock lock(mutex_);
    return worked_out_;
  }

 private:
  mutable std::mutex mutex_;
  std::deque<std::pair<std::string, std::optional<NoiseScales>>> results_;
  std::int64_t worked_out_ = 0;
};

Memory& TheMemory() {
  static Memory memory;
  return memory;
}

/// Database, strokes with what was found of them, and machine file.
std::string KeyOf(const std::string& path, const RunInfo& run, std::span<const StrokeSummary> strokes,
                  const Machine& machine) {
  std::string key = fmt::format("{}\n{} {}\n", path, run.id, run.fingerprint);
  for (const StrokeSummary& s : strokes)
    key += fmt::format("{} {} {} {} {}\n", s.index, s.begin, s.end, s.rms_error, s.noise_floor);
  return key + FormatMachine(machine);
}

std::optional<NoiseScales> WorkOut(const std::string& path, const RunInfo& run,
                                   std::span<const StrokeSummary> strokes, const Machine& machine) {
  auto rows = OpenRawRun(path, run.id, strokes.front().begin, strokes.back().end, machine);
  if (!rows) return {};
  const auto kept = FirstStrokesOf(**rows, machine);
  if (!kept) return {};
  return NoiseScalesOf(*kept, JudgeStrokes(*kept));
}

}  // namespace

std::optional<NoiseScales> NoiseOf(const RunSummary& summary) {
  if (!summary.noise_scale) return {};
  NoiseScales out{*summary.noise_scale, summary.evidence_scale.value_or(1), summary.floor_scale};
  if (out.noise == 1) out.floor = 1;
  return out;
}

std::optional<NoiseScales> NoiseOfKeptRows(const Database& database, const std::string& path,
                                           const RunInfo& run, std::int64_t machine_id,
                                           const Machine& machine) {
  const auto strokes = database.SummariesOf(
      machine_id, run.first_sequence + std::max<std::int64_t>(0, run.strokes - kStrokesOfKeptRows),
      run.first_sequence + run.strokes, kStrokesOfKeptRows);
  if (!strokes || strokes->empty() || InEpisodes(KindOf(machine))) return {};
  std::string key = KeyOf(path, run, *strokes, machine);
  if (const auto known = TheMemory().Find(key)) return *known;
  const std::optional<NoiseScales> noise = WorkOut(path, run, *strokes, machine);
  TheMemory().Keep(std::move(key), noise);
  return noise;
}

std::int64_t NoiseOfKeptRowsWorkedOut() { return TheMemory().worked_out(); }

}  // namespace hydroscope
