#include "workbench/history/stroke_history.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>

#include "core/contains.h"
#include "core/finite_number.h"
#include "core/shell_word.h"
#include "core/told_error.h"
#include "core/units.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "pipeline/geometry_tolerance.h"
#include "pipeline/log_faults/physical_sizes.h"
#include "pipeline/run_summary.h"
#include "replay/resampled_reader.h"
#include "workbench/history/kept_noise.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kUnits = 128;                ///< units aimed at where strokes are grouped
constexpr std::int64_t kSmall = 64, kLarge = 4096;  ///< groups whose sums the database keeps
constexpr std::int64_t kSample = 256;               ///< summaries read at most

/// Strokes per unit, a size whose sums are stored or quickly added.
std::int64_t UnitSize(std::int64_t strokes, std::int64_t most_single) {
  if (strokes <= most_single) return 1;
  if (strokes >= 16 * kLarge) return kLarge;
  return kSmall * ((strokes + kSmall * kUnits - 1) / (kSmall * kUnits));
}

/// Cuts a part at multiples of `size`; a beginning or end shorter than half of it joins its neighbour.
std::vector<HistoryPart> Cut(const HistoryPart& part, std::int64_t size) {
  std::vector<std::int64_t> cuts = {part.first};
  for (std::int64_t at = (part.first / size + 1) * size; at < part.last; at += size) cuts.push_back(at);
  if (cuts.size() > 2 && 2 * (cuts[1] - part.first) < size) cuts.erase(cuts.begin() + 1);
  if (cuts.size() > 2 && 2 * (part.last - cuts.back()) < size) cuts.pop_back();
  cuts.push_back(part.last);
  std::vector<HistoryPart> units;
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    units.push_back(part);
    units.back().first = cuts[k];
    units.back().last = cuts[k + 1];
  }
  return units;
}

Status ReadUnits(const Database& database, const HistoryPart& part, std::int64_t size,
                 StrokeHistory& history) {
  for (const HistoryPart& unit : Cut(part, size)) history.unit_parts.push_back(unit);
  if (size == 1) {
    auto grams = TRY(database.Grams(part.id, part.first, part.last));
    std::move(grams.begin(), grams.end(), std::back_inserter(history.units));
    return {};
  }
  for (std::size_t k = history.units.size(); k < history.unit_parts.size(); ++k) {
    auto sum = TRY(database.SumGrams(part.id, history.unit_parts[k].first, history.unit_parts[k].last));
    history.units.push_back(std::move(sum));
  }
  return {};
}

/// That strokes are those of another kind of machine than the machine file describes; "" if they are not known to be.
Told OfAnotherKind(const ModelVersion& stored, const HistoryPart& part, const StrokeHistory& history) {
  const auto machine = ParseMachine(stored.definition, part.machine);
  if (!machine || &KindOf(*machine) == &KindOf(history.machine)) return {};
  return Tell(
      "{}: {} of {} are those of a {}, and the machine file describes a {}: take the machine file that they were replayed with",
      "{}: {} von {} stammen von einer Maschine der Art „{}“, die Maschinendatei beschreibt eine der Art „{}“: die Maschinendatei "
      "nehmen, mit der sie eingespielt wurden",
      history.database, CountedWordsOf(*machine).many, part.machine, KindOf(*machine).title,
      KindOf(history.machine).title);
}

/// Sample period and Gram columns of the runs the part touches must be those of the history.
Status CheckRuns(const Database& database, const HistoryPart& part, double& period, StrokeHistory& history) {
  const CountedWords counted = CountedWordsOf(history.machine);
  const auto runs = TRY(database.Runs(part.id));
  std::optional<std::optional<NoiseScales>> live;
  for (const RunInfo& run : runs) {
    if (run.strokes == 0 || run.first_sequence >= part.last || run.first_sequence + run.strokes <= part.first)
      continue;
    const auto model = TRY(database.GetModelVersion(part.id, run.model_version));
    if (Told other = OfAnotherKind(model, part, history); !other.empty()) return BadInput(other);
    if (model.columns != history.model->ColumnNames())
      return BadInput(Tell(
          "{}: {} of run {} ({}) of {} were recorded with other sums of products than this machine and "
          "program have; replay their logs into a new database",
          "{}: {} aus Lauf {} ({}) von {} wurden mit anderen Produktsummen aufgezeichnet, als Maschine und Programm "
          "sie jetzt haben; die Logs in eine neue Datenbank einspielen",
          history.database, counted.many, run.id, run.source, part.machine));
    const RunSummary summary = ParseRunSummary(run.summary_json);
    for (const std::string& why : {summary.too_slow, summary.impossible})
      if (!why.empty()) history.no_verdict = fmt::format("run {} ({}): {}", run.id, run.source, why);
    const auto strokes = static_cast<double>(std::min(part.last, run.first_sequence + run.strokes) -
                                             std::max(part.first, run.first_sequence));
    const double share = strokes / static_cast<double>(history.strokes());
    std::optional<NoiseScales> noise = NoiseOf(summary);
    if (run.source == kLiveSource) {
      if (!live) live = NoiseOfKeptRows(database, history.database, runs.back(), part.id, history.machine);
      noise = *live;
    }
    history.CountNoise(noise, share);
    const double own = summary.sample_period;
    if (!(own > 0)) continue;
    if (period > 0 && std::abs(own - period) > kSamePeriod * period)
      return BadInput(Tell(
          "{}: run {} ({}) has a sample period of {:.4g} s, the runs before {:.4g} s; "
          "choose {} of one with --from and --to",
          "{0}: Lauf {1} ({2}) hat eine Abtastzeit von {3:.4g} s, die Läufe davor {4:.4g} s; mit --from und --to {5} "
          "von einer Abtastzeit wählen",
          history.database, run.id, run.source, own, period, counted.many));
    period = own;
  }
  return {};
}

/// Marks the units as of the run they begin in: strokes of one run may hang together.
Status LabelRuns(const Database& database, StrokeHistory& history) {
  for (const HistoryPart& part : history.parts) {
    const auto runs = TRY(database.Runs(part.id));
    for (std::size_t k = 0; k < history.units.size(); ++k) {
      const HistoryPart& unit = history.unit_parts[k];
      for (const RunInfo& run : runs)
        if (unit.id == part.id && unit.first >= run.first_sequence &&
            unit.first < run.first_sequence + run.strokes)
          history.units[k].log = static_cast<int>(run.id);
    }
  }
  return {};
}

/// Leaves out strokes that gave no equation.
Status CheckUnits(StrokeHistory& history) {
  for (std::size_t k = history.units.size(); k-- > 0;) {
    const int columns = history.units[k].integral.dimension();
    if (columns == history.model->column_count()) continue;
    if (columns != 0)
      return BadInput(
          Tell("{}: a stored sum has {} columns, the model {}; the file is damaged",
               "{}: eine gespeicherte Summe hat {} Spalten, das Modell {}; die Datei ist beschädigt",
               history.database, columns, history.model->column_count()));
    history.units.erase(history.units.begin() + k);
    history.unit_parts.erase(history.unit_parts.begin() + k);
  }
  return {};
}

/// Rms over strokes of the noise floor each was stored with.
double RmsOfFloors(const std::vector<StrokeSummary>& strokes) {
  double sum = 0, count = 0;
  for (const StrokeSummary& stroke : strokes) {
    if (!(stroke.noise_floor > 0)) continue;
    sum += stroke.noise_floor * stroke.noise_floor;
    count += 1;
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

/// "81.5s" or "81.5".
std::optional<double> Seconds(std::string_view text) {
  if (text.ends_with('s')) text.remove_suffix(1);
  return FiniteNumber(text);
}

/// "2025-03-01", "2025-03-01T06:30", "2025-03-01 06:30:05" as seconds since 1970, in the time zone of this computer.
std::optional<double> Date(const std::string& text) {
  for (const char* form :
       {"%Y-%m-%d", "%Y-%m-%dT%H:%M", "%Y-%m-%d %H:%M", "%Y-%m-%dT%H:%M:%S", "%Y-%m-%d %H:%M:%S"}) {
    std::tm date{};
    const char* const end = strptime(text.c_str(), form, &date);
    if (end == nullptr || *end != '\0') continue;
    const int day = date.tm_mday;
    date.tm_isdst = -1;  // summer time where it is
    const std::time_t time = mktime(&date);
    return date.tm_mday == day ? std::optional(static_cast<double>(time))
                               : std::nullopt;  // the 31st of February
  }
  return std::nullopt;
}

Result<std::int64_t> RunBegin(const Database& database, std::int64_t machine, const std::string& number) {
  const auto runs = TRY(database.Runs(machine));
  for (const RunInfo& run : runs)
    if (std::to_string(run.id) == number) return run.first_sequence;
  std::vector<std::int64_t> ids;
  for (const RunInfo& run : runs) ids.push_back(run.id);
  return BadInput(Tell("the machine has no run {}; its runs: {}",
                       "die Maschine hat keinen Lauf {}; ihre Läufe: {}", number, fmt::join(ids, ", ")));
}

}  // namespace

std::int64_t StrokeHistory::strokes() const {
  std::int64_t sum = 0;
  for (const HistoryPart& part : parts) sum += part.strokes();
  return sum;
}

double StrokeHistory::equations() const {
  double sum = 0;
  for (const StrokeGram& unit : units) sum += static_cast<double>(unit.blocks - unit.spans);
  return sum;
}

void StrokeHistory::CountNoise(const std::optional<NoiseScales>& noise, double share) {
  noise_known = noise_known && noise;
  if (!noise || !noise->floor)
    floor_scale.reset();
  else if (floor_scale)
    *floor_scale += share * (*noise->floor - 1);
  if (!noise) return;
  noise_scale += share * (noise->noise - 1);
  evidence_scale += share * (noise->evidence - 1);
}

double StrokeHistory::NoiseFloor(std::shared_ptr<const ModelStructure> fitted,
                                 const std::vector<EffectChoice>& choices, const ExtendedFit& solved) const {
  if (!floor_scale || (*floor_scale == 1 && noise_scale == 1)) return NoiseFloor(solved.noise_floor);
  const double white = noise_scale == 1
                           ? solved.noise_floor
                           : StrokeSet(std::move(fitted), units, window).Fit(choices).noise_floor;
  return NoiseFloor(std::sqrt(*floor_scale) * white);
}

double StrokeHistory::NoiseFloor(double of_sums) const {
  return white_noise > 0 ? std::min(of_sums, white_noise) : of_sums;
}

std::int64_t StrokeHistory::strokes_per_unit() const {
  std::int64_t most = 0;
  for (const HistoryPart& unit : unit_parts) most = std::max(most, unit.strokes());
  return most;
}

Result<std::vector<HistoryPart>> ChosenMachines(Database& database, const std::string& path,
                                                const std::vector<std::string>& names) {
  const auto known = TRY(database.MachineNames());
  if (known.empty())
    return BadInput(
        Tell("{} holds no machine yet; fill it with `hydroscope replay LOG --machine M.toml --db {}`",
             "{} enthält noch keine Maschine; füllen mit `hydroscope replay LOG --machine M.toml --db {}`",
             path, ShellWord(path)));
  std::vector<HistoryPart> parts;
  for (const std::string& name : names.empty() ? known : names) {
    if (!Contains(known, name)) {
      const std::string nearest = Nearest(name, known);
      return BadInput(
          Tell("{} has no machine \"{}\"; it holds: {}{}", "{} hat keine Maschine „{}“; darin: {}{}", path,
               name, fmt::join(known, ", "),
               nearest.empty() ? Told() : Tell(". Did you mean {}?", ". Ist {} gemeint?", nearest)));
    }
    const auto id = TRY(database.MachineId(name));
    const auto end = TRY(database.EndSequence(id));
    parts.push_back({name, id, 0, end});
  }
  return parts;
}

Result<std::int64_t> FindPlace(const Database& database, std::int64_t machine, const std::string& text) {
  if (text.starts_with("run:")) return RunBegin(database, machine, text.substr(4));
  if (!text.empty() && text.find_first_not_of("0123456789") == std::string::npos && text.size() < 18)
    return std::stoll(text);
  const auto time = Date(text) ? Date(text) : Seconds(text);
  if (!time)
    return UsageError(
        "\"{}\" is no place in the history; expected the number of a stroke or episode (1234), a log (run:3), a time "
        "of the "
        "logs (81.5s) or a date (2025-03-01T06:30)",
        text);
  return database.SequenceAt(machine, *time);
}

Status Narrow(const Database& database, const std::string& from, const std::string& to, HistoryPart& part) {
  for (const auto& [text, is_begin] : {std::pair(from, true), std::pair(to, false)}) {
    if (text.empty()) continue;
    const auto place = TRY(FindPlace(database, part.id, text));
    if (is_begin)
      part.first = std::max(part.first, place);
    else
      part.last = std::min(part.last, place);
  }
  part.first = std::min(part.first, part.last);
  return {};
}

Result<Machine> StoredMachine(const Database& database, const std::string& path, const HistoryPart& part) {
  auto model = TRY(database.PromotedModel(part.id));
  if (!model) {
    const auto runs = TRY(database.Runs(part.id));
    if (runs.empty())
      return BadInput(Tell("{}: nothing of machine {} is stored yet",
                           "{}: von Maschine {} ist noch nichts gespeichert", path, part.machine));
    model = TRY(database.GetModelVersion(part.id, runs.back().model_version));
  }
  return ParseMachine(model->definition,
                      fmt::format("{}: model version {} of {}", path, model->version, part.machine));
}

CountedWords CountedWordsIn(const std::string& path, const std::string& machine) {
  auto database = Database::OpenReadOnly(path);
  if (!database) return {};
  const auto parts = ChosenMachines(*database, path, {machine});
  if (!parts) return {};
  const auto stored = StoredMachine(*database, path, parts->front());
  return stored ? CountedWordsOf(*stored) : CountedWords{};
}

Result<StrokeHistory> LoadHistory(const Database& database, const std::string& path,
                                  const std::vector<HistoryPart>& parts, const Machine& machine,
                                  std::int64_t most_single) {
  StrokeHistory history;
  history.database = path;
  history.machine = machine;
  AssumeTolerances(history.machine);
  history.parts = parts;
  history.model = TRY(BuildModel(history.machine));
  // What was added to equations of states is among the parameters of the model, no column beside them.
  if (KindOf(machine).has_states) history.machine.added_effects.clear();
  if (history.strokes() == 0)
    return BadInput(
        Tell("{}: no {} in the chosen part of the history; `hydroscope trends --db {}` shows what it holds",
             "{}: keine {} im gewählten Teil der Geschichte; `hydroscope trends --db {}` zeigt, was da ist",
             path, CountedWordsOf(machine).many, ShellWord(path)));
  double period = machine.log.sample_period.value_or(0.0);
  for (const HistoryPart& part : parts) TRY(CheckRuns(database, part, period, history));
  if (!(period > 0) && machine.live) period = machine.live->grid_period;  // its first run goes on
  if (!(period > 0))
    return BadInput(Tell(
        "{}: no log was replayed to its end, so the sample period is not known; replay it again",
        "{}: kein Log wurde bis ans Ende eingespielt, die Abtastzeit ist also nicht bekannt; noch einmal einspielen",
        path));
  history.window = WindowSamples::From(machine.window, period);
  history.window.level_form = history.model->level_form;
  const std::int64_t size = UnitSize(history.strokes(), most_single);
  for (const HistoryPart& part : parts) {
    if (part.strokes() == 0) continue;
    TRY(ReadUnits(database, part, size, history));
    auto sample = TRY(
        database.SummariesOf(part.id, part.first, part.last,
                             std::max<std::int64_t>(1, kSample / static_cast<std::int64_t>(parts.size()))));
    history.sample.insert(history.sample.end(), sample.begin(), sample.end());
  }
  TRY(LabelRuns(database, history));
  TRY(CheckUnits(history));
  if (KindOf(machine).has_states) history.white_noise = RmsOfFloors(history.sample);
  TRY(JudgeStrokes(path, machine, history.sample));
  return history;
}

}  // namespace hydroscope
