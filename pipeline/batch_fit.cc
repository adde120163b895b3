#include "pipeline/batch_fit.h"

#include <cmath>
#include <filesystem>
#include <optional>

#include "core/told_error.h"
#include "models/machine_kind.h"
#include "pipeline/log_faults/broken_strokes.h"
#include "pipeline/log_faults/physical_sizes.h"
#include "pipeline/log_faults/stuck_signal.h"
#include "pipeline/log_pass.h"
#include "pipeline/raw_log.h"
#include "pipeline/time_stamps.h"
#include "replay/resampled_reader.h"

namespace hydroscope {
namespace {

void Add(const StrokeCounters& more, StrokeCounters& sum) {
  sum.samples += more.samples;
  sum.gated += more.gated;
  sum.used += more.used;
  for (std::size_t f = 0; f < sum.flagged.size(); ++f) sum.flagged[f] += more.flagged[f];
}

/// Marks what was read as of log number `log`.
void Label(LogStrokes& read, int log) {
  for (StrokeRecord& stroke : read.strokes) stroke.gram.log = log;
  for (StrokeStretches& stroke : read.stretches)
    for (Stretch& stretch : stroke) stretch.log = log;
}

/// s, from the origin of Stretch::begin to the end of the last stretch.
double LastTime(const LogStrokes& log) {
  double last = 0;
  for (const StrokeStretches& stroke : log.stretches)
    for (const Stretch& s : stroke) last = std::max(last, s.begin + s.samples * s.period);
  return last;
}

void MoveTime(LogStrokes& log, double by) {
  for (StrokeStretches& stroke : log.stretches)
    for (Stretch& s : stroke) s.begin += by;
}

}  // namespace

std::vector<StrokeGram> LogStrokes::Grams() const {
  std::vector<StrokeGram> grams;
  for (const StrokeRecord& stroke : strokes) grams.push_back(stroke.gram);
  return grams;
}

StrokeCollector::StrokeCollector(const Machine& machine, KeepSamples keep) : keep_(keep) {
  out_.machine = machine;
}

Pipeline::RecordSink StrokeCollector::Sink() {
  return [this](StrokeRecord&& record) {
    if (record.summary.index % stride_ == 0) Keep(std::move(record));
    pending_.clear();
    pending_samples_ = 0;
    if (keep_ == KeepSamples::kThinned &&
        (kept_ >= kMaxKeptSamples || out_.strokes.size() > kMaxThinnedStrokes))
      Thin();
  };
}

void StrokeCollector::Keep(StrokeRecord&& record) {
  if (keep_ != KeepSamples::kNo && kept_ < kMaxKeptSamples) {
    StrokeStretches stroke;
    for (auto& [begin, stretch] : pending_)
      if (begin >= record.summary.begin) {
        kept_ += stretch.samples;
        stroke.push_back(std::move(stretch));
      }
    out_.stretches.push_back(std::move(stroke));
  }
  out_.strokes.push_back(std::move(record));
}

/// Doubles the stride. Kept strokes and their stretches stand at the same places.
void StrokeCollector::Thin() {
  stride_ *= 2;
  std::vector<StrokeRecord> strokes;
  std::vector<StrokeStretches> stretches;
  kept_ = 0;
  for (std::size_t s = 0; s < out_.strokes.size(); ++s) {
    if (out_.strokes[s].summary.index % stride_ != 0) continue;
    for (const Stretch& stretch : out_.stretches[s]) kept_ += stretch.samples;
    strokes.push_back(std::move(out_.strokes[s]));
    stretches.push_back(std::move(out_.stretches[s]));
  }
  out_.strokes = std::move(strokes);
  out_.stretches = std::move(stretches);
}

Pipeline::EquationTap StrokeCollector::Tap() {
  if (keep_ == KeepSamples::kNo) return {};
  return [this](const Stretch& stretch, const SpanEquations& equations) {
    if (kept_ + pending_samples_ >= kMaxKeptSamples) return;  // a gate that never closes is one stroke
    pending_samples_ += stretch.samples;
    pending_.emplace_back(equations.begin, stretch);
  };
}

LogStrokes StrokeCollector::Finish(const Pipeline& pipeline) {
  out_.totals = pipeline.totals();
  out_.discarded_strokes = pipeline.discarded_strokes();
  out_.window = pipeline.window();
  out_.model = pipeline.shared_model();
  return std::move(out_);
}

namespace {

/// Geometry without a tolerance gets the usual one (pipeline/geometry_tolerance.h). `period`: of the logs before, 0 = none.
/// A log in which sensors turn out to end, or to have frozen, is read again, without their readings there.
Result<LogStrokes> ReadOne(const std::string& log, const Machine& stated, KeepSamples keep, double period,
                           const LogPass* known = nullptr) {
  if (ClosedLoopOf(stated) != nullptr)
    return BadInput(Tell(
        "machine '{}': a {} is judged by its frequency response at the command line: `hydroscope frf LOG --machine FILE` measures "
        "it, `hydroscope explain LOG --machine FILE` says what changed from the references of the file, with --since BEFORE "
        "from another log",
        "Maschine '{}': ein {} wird über seinen Frequenzgang beurteilt, an der Befehlszeile: `hydroscope frf LOG --machine DATEI` "
        "misst ihn, `hydroscope explain LOG --machine DATEI` sagt, was sich gegenüber den Bezugswerten der Datei geändert hat, "
        "mit --since VORHER gegenüber einem anderen Log",
        stated.name, KindOf(stated).title));
  Machine machine = stated;
  AssumeTolerances(machine);
  TRY(JudgeSizes(log, machine));
  std::string note;
  auto reader = TRY(OpenRecording(log, machine, period, note));
  StrokeCollector collector(machine, keep);
  auto pipeline = TRY(Pipeline::Create(machine, reader->SamplePeriod(), collector.Sink()));
  pipeline->set_tap(collector.Tap());
  LogPassHooks hooks;
  if (known != nullptr) {
    hooks.known_cut_offs = known->cut_offs;
    hooks.known_frozen = known->frozen;
  }
  const auto pass = TRY(PassLog(*reader, machine, pipeline.get(), "reading", hooks));
  if (!pass.summary.stopped.empty()) return BadInput("{}", pass.summary.stopped);
  if (!pass.no_verdict.empty()) return BadInput(Tell("{}: {}", "{}: {}", log, pass.no_verdict));
  if (known == nullptr && pass.WouldLeaveOutMore()) return ReadOne(log, stated, keep, period, &pass);
  LogStrokes out = collector.Finish(*pipeline);
  out.log_names = {std::filesystem::path(log).filename().string()};
  out.reader = reader->counters();
  // Where too few strokes for a verdict are left, the time stamps may be the cause.
  if (const Told coarse = CoarseTimeStamps(out.reader, machine.signals.size());
      out.strokes.size() < kMinExplainStrokes && !coarse.empty())
    return BadInput(Tell("{}: {}", "{}: {}", log, coarse));
  if (out.strokes.size() < kMinExplainStrokes && !pass.reversed.empty())
    return BadInput(Tell("{}: {}", "{}: {}", log, pass.reversed.front()));
  for (const auto& texts : {pass.reversed, pass.wrong_answers})
    for (const Told& text : texts) out.doubts.push_back(Tell("{}: {}", "{}: {}", log, text));
  if (!note.empty()) out.notes.push_back(log + ": " + note);
  for (const ReadingFaults::Echo& echo : out.echoes = pass.echoes)
    out.notes.push_back(log + ": " + echo.Sentence().english);
  if (const Told broken = BrokenUp(pass.channels, machine, std::ssize(out.strokes), out.discarded_strokes);
      !broken.empty())
    out.swapped.push_back(Tell("{}: {}", "{}: {}", log, broken));
  for (const Told& text : pass.outside_declared) out.notes.push_back(log + ": " + text.english);
  for (const Told& text : pass.LeftOut(machine)) out.notes.push_back(log + ": " + text.english);
  out.stuck = StuckSignal(pass.summary, machine, *out.model);
  for (const Told& swapped : pass.swapped) out.swapped.push_back(Tell("{}: {}", "{}: {}", log, swapped));
  return out;
}

}  // namespace

void Append(LogStrokes next, LogStrokes& all) {
  // Samples are kept up to a limit; strokes whose samples are not kept come last in every log.
  if (all.stretches.size() < all.strokes.size()) next.stretches.clear();
  Label(next, all.logs++);
  all.log_names.insert(all.log_names.end(), next.log_names.begin(), next.log_names.end());
  MoveTime(next, LastTime(all));
  const auto offset = static_cast<std::int64_t>(all.strokes.size());
  for (StrokeRecord& stroke : next.strokes) {
    stroke.summary.index += offset;
    all.strokes.push_back(std::move(stroke));
  }
  for (StrokeStretches& stretches : next.stretches) all.stretches.push_back(std::move(stretches));
  Add(next.totals, all.totals);
  all.notes.insert(all.notes.end(), next.notes.begin(), next.notes.end());
  all.echoes.insert(all.echoes.end(), next.echoes.begin(), next.echoes.end());
  all.swapped.insert(all.swapped.end(), next.swapped.begin(), next.swapped.end());
  all.doubts.insert(all.doubts.end(), next.doubts.begin(), next.doubts.end());
  if (all.stuck.empty()) all.stuck = next.stuck;
  all.discarded_strokes += next.discarded_strokes;
  all.reader.rows += next.reader.rows;
  all.reader.rejected_rows += next.reader.rejected_rows;
}

Result<LogStrokes> ReadStrokes(const std::string& log, const Machine& machine, KeepSamples keep) {
  return ReadOne(log, machine, keep, 0);
}

Result<LogStrokes> ReadStrokes(const std::vector<std::string>& logs, const Machine& machine,
                               KeepSamples keep) {
  TRY(JudgeDistinct(logs));
  std::optional<LogStrokes> all;
  for (const std::string& log : logs) {
    auto next = ReadOne(log, machine, keep, all ? all->window.period : 0);
    if (!next) return next;
    if (!all) {
      all = std::move(*next);
      continue;
    }
    const double period = next->window.period, first = all->window.period;
    if (std::abs(period - first) > kSamePeriod * first || next->window.block != all->window.block)
      return BadInput(Tell(
          "{}: rows are {:.4g} s apart, in {} {:.4g} s, too different to be taken together; give logs of "
          "nearly the same sampling rate (25 %)",
          "{}: Zeilen liegen {:.4g} s auseinander, in {} {:.4g} s, zu verschieden, um zusammen genommen zu werden; "
          "Logs mit fast derselben Abtastrate nehmen (25 %)",
          log, period, logs.front(), first));
    Append(std::move(*next), *all);
  }
  if (!all) return UsageError("no log given");
  return std::move(*all);
}

}  // namespace hydroscope
