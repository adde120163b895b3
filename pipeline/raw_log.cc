#include "pipeline/raw_log.h"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <limits>
#include <map>

#include "core/finite_number.h"
#include "core/told_error.h"
#include "pipeline/axis_log.h"
#include "replay/resampled_reader.h"
#include "storage/database_file.h"

namespace hydroscope {
namespace {

constexpr double kSecondsAtOnce = 20.0;  ///< s read from the database at once
constexpr double kForever = 1e300;

/// One run after the other, piece by piece.
class RawReader : public LogReader {
 public:
  RawReader(Database database, std::vector<RawExtent> runs, double from, double to, const Machine& machine)
      : database_(std::move(database)), runs_(std::move(runs)), from_(from), to_(to) {
    period_ = machine.live ? machine.live->grid_period : machine.log.sample_period.value_or(0);
    for (const SignalSpec& signal : machine.signals) names_.push_back(signal.name);
    if (!runs_.empty()) at_ = std::max(from_, runs_.front().first);
  }

  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) override {
    TRY(Load());
    const std::size_t rows = std::min(max_rows, window_.time.size() - next_);
    block.Resize(names_.size(), rows);
    const auto begin = static_cast<std::ptrdiff_t>(next_), n = static_cast<std::ptrdiff_t>(rows);
    std::copy_n(window_.time.begin() + begin, n, block.time.begin());
    for (std::size_t s = 0; s < names_.size(); ++s) {
      const auto found = std::ranges::find(window_.signals, names_[s]);
      if (found == window_.signals.end()) {
        std::ranges::fill(block.signal[s], std::numeric_limits<double>::quiet_NaN());
        std::ranges::fill(block.quality[s], quality::kMissing);
        continue;
      }
      const auto column = static_cast<std::size_t>(found - window_.signals.begin());
      std::copy_n(window_.values[column].begin() + begin, n, block.signal[s].begin());
      std::copy_n(window_.flags[column].begin() + begin, n, block.quality[s].begin());
    }
    if (rows > 0 && run_begins_ && counters_.rows > 0)
      for (auto& flags : block.quality) flags[0] |= quality::kGap;
    if (rows > 0) run_begins_ = false;
    next_ += rows;
    counters_.rows += static_cast<std::int64_t>(rows);
    return rows;
  }

  double Progress() const override {
    double passed = 0, all = 0;  // s
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      const double begin = std::max(from_, runs_[r].first),
                   end = std::max(begin, std::min(to_, runs_[r].last));
      all += end - begin;
      if (r < run_) passed += end - begin;
      if (r == run_ && next_ > 0) passed += std::clamp(window_.time[next_ - 1] - begin, 0.0, end - begin);
    }
    return all > 0 ? passed / all : 1.0;
  }
  double SamplePeriod() const override { return period_; }
  const LogCounters& counters() const override { return counters_; }

 private:
  /// Fetches the next piece if the present one is used up.
  Status Load() {
    while (next_ == window_.time.size() && run_ < runs_.size()) {
      const RawExtent& run = runs_[run_];
      if (at_ > run.last || at_ >= to_) {
        if (++run_ < runs_.size()) at_ = std::max(from_, runs_[run_].first);
        run_begins_ = true;
        continue;
      }
      const double end = std::min(to_, at_ + kSecondsAtOnce);
      window_ = TRY(database_.LoadRaw(run.run, at_, end));
      next_ = 0;
      at_ = window_.time.empty() ? TRY(database_.NextRaw(run.run, end)) : end;  // rows may be kept days apart
    }
    return {};
  }

  Database database_;
  std::vector<RawExtent> runs_;
  double from_, to_, at_ = 0, period_ = 0;
  std::vector<std::string> names_;
  RawWindow window_;
  std::size_t next_ = 0, run_ = 0;
  bool run_begins_ = true;
  LogCounters counters_;
};

/// "5:60" -> 5, 60; both may be left out. "=5:60": times of the rows.
bool ParseRange(std::string text, RawName& name) {
  name.by_time = text.starts_with('=');
  if (name.by_time) text.erase(0, 1);
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return false;
  const auto number = [](const std::string& part, std::optional<double>& value) {
    value = FiniteNumber(part);
    return value || part.empty();
  };
  return number(text.substr(0, colon), name.from) && number(text.substr(colon + 1), name.to);
}

bool EndsWithName(const std::string& machine, const std::string& axis) {
  return machine == axis || machine.ends_with("/" + axis);
}

/// The machine of the database that the name means.
Result<std::int64_t> FindAxis(Database& database, const RawName& name) {
  const auto machines = TRY(database.MachineNames());
  std::vector<std::string> fitting;
  for (const std::string& machine : machines)
    if (name.axis.empty() || EndsWithName(machine, name.axis)) fitting.push_back(machine);
  if (fitting.size() == 1) return database.MachineId(fitting.front());
  std::string all;
  for (const std::string& machine : machines) all += (all.empty() ? "" : ", ") + machine;
  return BadInput("{}: '{}' names {} of its machines; expected one of: {} (as {}#{})", name.database,
                  name.axis, fitting.empty() ? "none" : "several", all, name.database,
                  machines.empty() ? "axis" : machines.front());
}

Result<std::vector<RawExtent>> FindRuns(Database& database, const RawName& name) {
  const auto axis = TRY(FindAxis(database, name));
  auto extents = TRY(database.RawExtents(axis));
  std::string kept;
  for (const RawExtent& extent : extents) kept += fmt::format("{}{}", kept.empty() ? "" : ", ", extent.run);
  if (name.run != 0) std::erase_if(extents, [&](const RawExtent& extent) { return extent.run != name.run; });
  if (extents.empty())
    return BadInput("{}#{}: no raw rows are kept{}; runs with raw rows: {}", name.database, name.axis,
                    name.run != 0 ? fmt::format(" of run {}", name.run) : "", kept.empty() ? "none" : kept);
  return extents;
}

/// Before anybody else than SQLite opens the file (storage/database_file.h).
Status JudgeNoDatabase(const std::string& log) {
  if (!IsDatabaseFile(log)) return {};
  return BadInput(Tell(
      "log '{0}' is a trend database; write {0}#NAME for the rows kept of a machine in it, {0}# if it holds one alone",
      "Log '{0}' ist eine Datenbank des Verlaufs; {0}#NAME für die aufbewahrten Zeilen einer Maschine darin schreiben, {0}#, "
      "wenn sie nur eine enthält",
      log));
}

}  // namespace

std::optional<RawName> ParseRawName(const std::string& log) {
  const std::size_t hash = log.rfind('#');
  std::error_code ignored;
  if (hash == std::string::npos || hash == 0 || std::filesystem::exists(log, ignored)) return std::nullopt;
  if (ParseAxisLog(log)) return std::nullopt;
  RawName name;
  name.database = log.substr(0, hash);
  std::string rest = log.substr(hash + 1);
  if (const std::size_t at = rest.rfind('@');
      at != std::string::npos && ParseRange(rest.substr(at + 1), name))
    rest.resize(at);
  const std::size_t slash = rest.rfind('/');
  const std::string last = slash == std::string::npos ? rest : rest.substr(slash + 1);
  std::int64_t run = 0;
  const auto [end, error] = std::from_chars(last.data(), last.data() + last.size(), run);
  if (error == std::errc() && end == last.data() + last.size() && !last.empty()) {
    name.run = run;
    rest.resize(slash == std::string::npos ? 0 : slash);
  }
  name.axis = rest;
  return name;
}

Result<std::unique_ptr<LogReader>> OpenRaw(const RawName& name, const Machine& machine) {
  auto database = TRY(Database::OpenReadOnly(name.database));
  const auto runs = TRY(FindRuns(database, name));
  if (!machine.live && !machine.log.sample_period)
    return BadInput(
        "{}: the machine file has no [live] grid_period; take the one the service "
        "ran with, or give [log] sample_period",
        name.database);
  const double first = name.by_time ? 0 : runs.front().first;
  return std::unique_ptr<LogReader>(
      std::make_unique<RawReader>(std::move(database), runs, name.from ? first + *name.from : -kForever,
                                  name.to ? first + *name.to : kForever, machine));
}

Result<std::unique_ptr<LogReader>> OpenRawRun(const std::string& path, std::int64_t run, double from,
                                              double to, const Machine& machine) {
  auto database = TRY(Database::OpenReadOnly(path));
  RawExtent extent;
  extent.run = run;
  extent.first = from;
  extent.last = to;
  return std::unique_ptr<LogReader>(std::make_unique<RawReader>(
      std::move(database), std::vector<RawExtent>{extent}, -kForever, kForever, machine));
}

Result<std::unique_ptr<LogReader>> OpenRecording(const std::string& log, const Machine& machine) {
  if (const auto name = ParseRawName(log)) return OpenRaw(*name, machine);
  if (const auto named = ParseAxisLog(log)) {
    const auto axis = TRY(AxisNamed(machine, named->axis));
    return OpenLog(named->path, MachineOfAxis(machine, axis));
  }
  TRY(JudgeNoDatabase(log));
  if (HasNamedAxes(machine) && LogHoldsAllAxes(machine))
    return BadInput("{}: this log holds all axes; say which one is meant: {}#{}", log, log,
                    machine.live->axes.front());
  return OpenLog(log, machine);
}

Result<std::unique_ptr<LogReader>> OpenRecording(const std::string& log, const Machine& machine,
                                                 double period, std::string& note) {
  auto reader = OpenRecording(log, machine);
  if (!reader) return reader;
  const LogCounters counters = (*reader)->counters();
  reader = AtPeriod(std::move(*reader), period, note);
  for (const std::string& text : {counters.time_base.english, counters.twins.english})
    if (!text.empty()) note = note.empty() ? text : text + "; " + note;
  return reader;
}

Result<LogFingerprint> FingerprintRecording(const std::string& log) {
  const auto name = ParseRawName(log);
  if (!name) {
    TRY(JudgeNoDatabase(log));
    return FingerprintLog(PathOfLog(log));
  }
  auto database = TRY(Database::OpenReadOnly(name->database));
  const auto runs = TRY(FindRuns(database, *name));
  LogFingerprint print;
  const auto crc = [](std::uint32_t seed, double value) {
    return static_cast<std::uint32_t>(crc32(seed, reinterpret_cast<const Bytef*>(&value), sizeof(value)));
  };
  for (const RawExtent& run : runs) {
    print.size += static_cast<std::uint64_t>(run.bytes);
    print.head = crc(print.head, run.first);
    print.tail = crc(print.tail, run.last);
  }
  print.middle = crc(crc(0, name->from.value_or(0)), name->to.value_or(0));
  return print;
}

Status JudgeDistinct(const std::vector<std::string>& logs) {
  std::map<std::string, std::string> known;  // by what is in it, and the axis
  for (const std::string& log : logs) {
    const auto print = FingerprintRecording(log);
    if (!print) continue;  // who reads it says why
    const auto axis = ParseAxisLog(log);
    const auto [same, first_time] = known.try_emplace(print->Text() + "#" + (axis ? axis->axis : ""), log);
    if (!first_time)
      return BadInput(
          Tell("{}: the same recording as {}; its rows would count twice, give it once",
               "{}: dieselbe Aufzeichnung wie {}; ihre Zeilen würden doppelt zählen, sie nur einmal angeben",
               log, same->second));
  }
  return {};
}

}  // namespace hydroscope
