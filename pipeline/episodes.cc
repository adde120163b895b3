#include "pipeline/episodes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/told_error.h"
#include "diagnosis/states/other_causes/reversed_signal.h"
#include "models/state_model.h"
#include "pipeline/batch_fit.h"
#include "pipeline/episode_cutter.h"
#include "pipeline/log_faults/hung_input.h"
#include "pipeline/log_faults/physical_sizes.h"
#include "pipeline/log_faults/sensor_ends.h"
#include "pipeline/raw_log.h"

namespace hydroscope {
namespace {

/// Share of the readings of each signal that stand out.
std::vector<double> SpikeShares(const SampleBlock& rows) {
  std::vector<double> shares;
  for (const auto& flags : rows.quality)
    shares.push_back(static_cast<double>(
                         std::ranges::count_if(flags, [](Quality q) { return (q & quality::kSpike) != 0; })) /
                     static_cast<double>(std::max<std::size_t>(1, flags.size())));
  return shares;
}

/// What FlagSensorEnds flags counts like what the monitor does.
std::vector<SensorEnd> LeaveOutSensorEnds(const Machine& machine, const std::vector<int>& outputs,
                                          SampleBlock& rows, EpisodeLog& out) {
  const auto counted = [&](std::size_t signal) {
    const auto& flags = rows.quality[signal];
    return std::ranges::count_if(flags, [](Quality q) { return (q & quality::kOutOfRange) != 0; });
  };
  std::vector<std::int64_t> before;
  for (std::size_t s = 0; s < machine.signals.size(); ++s) before.push_back(counted(s));
  std::vector<SensorEnd> ends = FlagSensorEnds(machine, outputs, rows);
  for (const SensorEnd& end : ends) {
    const auto s = static_cast<std::size_t>(end.signal);
    out.warnings.push_back(SensorEndText(end, machine));
    const std::int64_t more = counted(s) - before[s];
    before[s] += more;
    if (more == 0) continue;
    ChannelQuality& channel = out.pass.channels[s];
    for (std::size_t bit = 0; bit < channel.flagged.size(); ++bit)
      if (quality::kOutOfRange == 1u << bit) channel.flagged[bit] += more;
    out.pass.summary.flagged[channel.name]["out_of_range"] += more;
    const auto at = std::ranges::find(rows.signal[s], end.at);
    const double first = rows.time[at - rows.signal[s].begin()];
    channel.first_bad = std::isnan(channel.first_bad) ? first : std::min(channel.first_bad, first);
  }
  return ends;
}

/// All rows of one log with their flags.
Result<SampleBlock> ReadRows(const std::string& log, const Machine& machine, EpisodeLog& out) {
  auto reader = TRY(OpenRecording(log, machine));
  SampleBlock rows;
  rows.signal.resize(machine.signals.size());
  rows.quality.resize(machine.signals.size());
  LogPassHooks hooks;
  hooks.observe = [&](const SampleBlock& block) {
    if (static_cast<std::int64_t>(rows.time.size()) >= kMaxKeptSamples) return;
    rows.time.insert(rows.time.end(), block.time.begin(), block.time.end());
    for (std::size_t s = 0; s < rows.signal.size(); ++s) {
      rows.signal[s].insert(rows.signal[s].end(), block.signal[s].begin(), block.signal[s].end());
      rows.quality[s].insert(rows.quality[s].end(), block.quality[s].begin(), block.quality[s].end());
    }
  };
  auto pass = TRY(PassLog(*reader, machine, nullptr, "reading", hooks));
  if (!pass.summary.stopped.empty()) return BadInput("{}", pass.summary.stopped);
  out.period = reader->SamplePeriod();
  for (const Told& text : {reader->counters().time_base, reader->counters().twins})
    if (!text.empty()) out.warnings.push_back(Tell("{}: {}", "{}: {}", log, text));
  FlagFrozen(pass.frozen, rows);
  for (const auto& texts : {pass.outside_declared, FrozenTexts(pass.frozen, machine)})
    for (const Told& text : texts) out.warnings.push_back(Tell("{}: {}", "{}: {}", log, text));
  out.rows += static_cast<std::int64_t>(rows.time.size());
  out.pass = std::move(pass);
  return rows;
}

}  // namespace

double EpisodeLog::Seconds() const {
  return std::accumulate(episodes.begin(), episodes.end(), 0.0,
                         [](double sum, const Episode& e) { return sum + e.time.back() - e.time.front(); });
}

namespace {

/// Error where an output has no reading in a log: no episode begins without one.
Status JudgeAbsent(const std::string& log, const Machine& machine, const std::vector<int>& outputs,
                   const SampleBlock& rows) {
  for (const int s : outputs) {
    const auto at = static_cast<std::size_t>(s);
    if (std::ranges::any_of(rows.signal[at], [](double y) { return std::isfinite(y); })) continue;
    return BadInput(Tell(
        "{}: {} (column {}) has no reading in this log; leave it out of [signals] in the machine file, and the model "
        "does without it",
        "{}: {} (Spalte {}) hat in dieser Aufzeichnung keinen Messwert; in [signals] der Maschinendatei weglassen, dann "
        "kommt das Modell ohne aus",
        log, machine.signals[at].name, machine.signals[at].column));
  }
  return {};
}

/// Share of the rows of a log from which on an output that stood is told of.
constexpr double kToldStuck = 0.01;

/// Warns of outputs that stood while their rows are left out.
void TellStuck(const Machine& machine, const std::vector<int>& outputs, const SampleBlock& rows,
               EpisodeLog& out) {
  const auto stands = [](Quality q) { return (q & quality::kStuck) != 0; };
  for (const int s : outputs) {
    const SignalSpec& signal = machine.signals[static_cast<std::size_t>(s)];
    const std::vector<Quality>& flags = rows.quality[static_cast<std::size_t>(s)];
    const auto count = std::ranges::count_if(flags, stands);
    if (static_cast<double>(count) < kToldStuck * static_cast<double>(flags.size()) || count == 0 ||
        !EpisodeCutter::JudgesStuck(signal, out.period))
      continue;
    out.warnings.push_back(Tell(
        "{} (column {}) stands still in {} rows, first at {:.4g} s: its sensor, wire or logger hung, and that is left out",
        "{} (Spalte {}) steht in {} Zeilen still, zuerst bei {:.4g} s: Sensor, Leitung oder Logger hing, und diese "
        "Messwerte bleiben weg",
        signal.name, signal.column, count,
        rows.time[static_cast<std::size_t>(std::ranges::find_if(flags, stands) - flags.begin())]));
  }
}

/// Warns of inputs that hung, or never move.
std::vector<FrozenStretch> LeaveOutHungInputs(const Machine& machine, const StateModel& model,
                                              SampleBlock& rows, EpisodeLog& out) {
  std::vector<FrozenStretch> hung = HungInputs(machine, model.inputs, model.outputs, rows);
  std::vector<Told> texts = HungTexts(hung, machine);
  texts.push_back(NoInputMoves(machine, model.inputs, model.outputs, rows));
  LeaveOutHung(hung, rows);
  for (Told& text : texts)
    if (!text.empty()) out.warnings.push_back(std::move(text));
  return hung;
}

/// Readings that rows are left without.
struct WrongReadings {
  std::vector<SensorEnd> ends;
  std::vector<FrozenStretch> hung;
};

/// What every command leaves out of the rows of a log, and says.
WrongReadings LeaveOutWrong(const Machine& machine, const StateModel& model, SampleBlock& rows,
                            EpisodeLog& out) {
  WrongReadings wrong;
  wrong.ends = LeaveOutSensorEnds(machine, model.outputs, rows, out);
  TellStuck(machine, model.outputs, rows, out);
  wrong.hung = LeaveOutHungInputs(machine, model, rows, out);
  for (const SensorEnd& end : FlaggedInputEnds(model.machine, model.inputs, rows))
    out.warnings.push_back(InputEndText(end, machine));
  return wrong;
}

Result<EpisodeLog> ReadWithAnySigns(const std::vector<std::string>& logs, const Machine& machine) {
  const auto model = TRY(BuildStateModel(machine, machine.added_effects));
  TRY(EpisodeCutter::Check(model->machine));
  EpisodeLog out;
  out.machine = machine;
  for (const std::string& log : logs) {
    TRY(JudgeSizes(log, machine));
    auto rows = TRY(ReadRows(log, machine, out));
    TRY(JudgeAbsent(log, machine, model->outputs, rows));
    const std::size_t said = out.warnings.size();
    LeaveOutWrong(machine, *model, rows, out);
    for (std::size_t k = said; k < out.warnings.size(); ++k)
      out.warnings[k] = Tell("{}: {}", "{}: {}", log, out.warnings[k]);
    EpisodeCutter cutter(
        model->machine, {model->inputs, model->outputs},
        {.period = out.period, .log = static_cast<int>(&log - logs.data()), .whole = true},
        [&](Episode&& episode, const StrokeCounters&) { out.episodes.push_back(std::move(episode)); });
    cutter.ForgiveSpikes(SpikeShares(rows));
    cutter.Process(rows);
    cutter.Finish();
    out.used += cutter.totals().used;
    out.warnings.insert(out.warnings.end(), cutter.warnings().begin(), cutter.warnings().end());
  }
  if (out.episodes.empty())
    return BadInput(Tell(
        "{}: no episode of {} rows in which all inputs are good readings{}; 'hydroscope "
        "check' says what is wrong with the signals",
        "{}: keine Episode von {} Zeilen, in denen alle Eingänge gute Messwerte sind{}; 'hydroscope check' sagt, was "
        "an den Signalen nicht stimmt",
        logs.front(), EpisodeCutter::kLeastRows,
        machine.gate.bounds.empty() ? Told() : Told(" and [gate] holds", " und [gate] gilt")));
  return out;
}

/// Of the episodes of one log.
Status JudgeSignsOf(std::span<const Episode> episodes, const std::string& log, const Machine& machine) {
  const Told reversed = ReversedSignalIn(machine, episodes);
  return reversed.empty() ? Status() : BadInput(Tell("{}: {}", "{}: {}", log, reversed));
}

}  // namespace

Result<EpisodeLog> ReadEpisodes(const std::vector<std::string>& logs, const Machine& machine) {
  TRY(JudgeDistinct(logs));
  auto out = TRY(ReadWithAnySigns(logs, machine));
  const auto last = out.episodes.cend();
  for (auto first = out.episodes.cbegin(); first != last;) {
    const auto next = std::find_if(first, last, [&](const Episode& e) { return e.log != first->log; });
    TRY(JudgeSignsOf(std::span(first, next), logs[static_cast<std::size_t>(first->log)], machine));
    first = next;
  }
  return out;
}

LogPassHooks KnownOfEpisodes(const std::string& log, const Machine& machine) {
  LogPassHooks known;
  const auto model = BuildStateModel(machine, machine.added_effects);
  if (!model) return known;
  EpisodeLog out;
  auto rows = ReadRows(log, machine, out);
  if (!rows) return known;
  out.warnings.clear();  // the pass that follows says these itself
  const WrongReadings wrong = LeaveOutWrong(machine, **model, *rows, out);
  known.known_cut_offs = AsCutOffs(wrong.ends);
  known.known_hung = wrong.hung;
  known.known_frozen = std::move(out.pass.frozen);
  known.known_texts = std::move(out.warnings);
  return known;
}

Status JudgeSigns(const std::string& log, const Machine& machine) {
  const auto read = ReadWithAnySigns({log}, machine);
  return read ? JudgeSignsOf(read->episodes, log, machine) : Status();
}

}  // namespace hydroscope
