#include "pipeline/log_pass.h"

#include <algorithm>
#include <optional>

#include "acquisition/repeated_rows.h"
#include "acquisition/straight_runs.h"
#include "host/output.h"
#include "pipeline/log_faults/command_answer.h"
#include "pipeline/log_faults/declared_range.h"
#include "pipeline/log_faults/hung_input.h"
#include "pipeline/log_faults/swapped_pressures.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsPerBlock = 1024;
constexpr std::size_t kFindingsKept = 10;

Status PassBlock(const SampleBlock& block, Pipeline* pipeline, const LogPassHooks& hooks) {
  if (hooks.observe) hooks.observe(block);
  if (pipeline) pipeline->Process(block);
  return hooks.after_block ? hooks.after_block() : Status();
}

void TakeCounters(const LogReader& reader, const Pipeline* pipeline, RunSummary& summary) {
  const LogCounters& counters = reader.counters();
  summary.sample_period = reader.SamplePeriod();
  summary.rows = counters.rows;
  summary.rejected_rows = counters.rejected_rows;
  summary.findings.assign(counters.findings.begin(),
                          counters.findings.begin() + std::min(kFindingsKept, counters.findings.size()));
  if (pipeline == nullptr) return;
  summary.gated = pipeline->totals().gated;
  summary.used = pipeline->totals().used;
  summary.discarded_strokes = pipeline->discarded_strokes();
}

}  // namespace

void TakeChannels(const QualityMonitor& monitor, const Machine& machine, LogPass& pass) {
  pass.channels = monitor.channels();
  for (std::size_t c = 0; c < pass.channels.size(); ++c) {
    const ChannelQuality& channel = pass.channels[c];
    if (!machine.signals[c].required && channel.rows > 0 && channel.flagged[0] == channel.rows) {
      pass.summary.absent.push_back(channel.name);
      continue;
    }
    for (std::size_t bit = 0; bit < channel.flagged.size(); ++bit)
      for (const auto& [flag, name] : quality::kFlagNames)
        if (flag == 1u << bit && channel.flagged[bit] > 0)
          pass.summary.flagged[channel.name][std::string(name)] = channel.flagged[bit];
  }
}

std::vector<Told> LogPass::LeftOut(const Machine& machine) const {
  std::vector<Told> texts = FrozenTexts(frozen, machine);
  for (const CutOff& cut : cut_offs)
    if (!cut.text.empty()) texts.push_back(cut.text);
  texts.insert(texts.end(), known_texts.begin(), known_texts.end());
  return texts;
}

Result<LogPass> PassLog(LogReader& reader, const Machine& machine, Pipeline* pipeline,
                        const std::string& what, const LogPassHooks& hooks) {
  LogPass pass;
  QualityMonitor monitor(Within(machine, hooks.known_cut_offs), reader.SamplePeriod());
  std::optional<RepeatedRows> repeated;
  std::optional<StraightRuns> straight;
  if (hooks.distrust_logger) {
    repeated.emplace(machine.signals.size());
    straight.emplace(machine.signals.size());
  }
  ReadingFaults faults(machine, reader.SamplePeriod());
  SwappedPressures swapped(machine);
  DeclaredRanges declared(machine);
  CommandAnswers answers(machine);
  std::optional<SaturatedPressures> saturated;
  std::optional<FrozenPressures> frozen;
  if (hooks.distrust_logger && hooks.known_frozen.empty()) frozen.emplace(machine);
  if (hooks.distrust_logger && hooks.known_cut_offs.empty()) saturated.emplace(machine);
  const auto judge = [&](SampleBlock& block) {
    FlagFrozen(hooks.known_frozen, block);
    LeaveOutHung(hooks.known_hung, block);
    if (straight) straight->Inspect(block);
    monitor.Inspect(block);
  };
  const auto pass_on = [&](const SampleBlock& block) {
    faults.Observe(block, monitor.channels());
    if (frozen) frozen->Observe(block, monitor.channels());
    swapped.Observe(block);
    declared.Observe(block);
    answers.Observe(block);
    if (saturated) saturated->Observe(block);
    return PassBlock(block, pipeline, hooks);
  };
  ProgressBar progress(what, "rows");
  SampleBlock block;
  while (reader.counters().rows < hooks.most_rows) {
    const auto rows = reader.Read(block, kRowsPerBlock);
    if (!rows) {
      pass.summary.stopped = rows.error().text;
      break;
    }
    if (*rows == 0) break;
    if (repeated) repeated->Inspect(block);
    judge(block);
    TRY(pass_on(block));
    progress.Update(reader.Progress(), reader.counters().rows);
  }
  if (repeated) {
    repeated->Flush(block);
    judge(block);
    TRY(pass_on(block));
  }
  if (straight) {
    straight->Flush(block);
    monitor.Inspect(block);
    TRY(pass_on(block));
  }
  monitor.Flush(block);
  TRY(pass_on(block));
  if (pipeline) pipeline->Finish();
  TakeChannels(monitor, machine, pass);
  TakeCounters(reader, pipeline, pass.summary);
  if (repeated) pass.copied_rows = repeated->copies();
  pass.no_verdict = faults.NoVerdict();
  pass.echoes = faults.Echoes();
  pass.swapped = swapped.Sentences();
  pass.outside_declared = declared.Sentences();
  const auto rows = static_cast<double>(std::max<std::int64_t>(1, pass.summary.rows));
  for (CommandAnswers::Fault& fault : answers.Against(static_cast<double>(pass.summary.gated) / rows))
    pass.reversed.push_back(std::move(fault.text));
  for (CommandAnswers::Fault& fault : answers.Sizes()) pass.wrong_answers.push_back(std::move(fault.text));
  pass.frozen = frozen ? frozen->Found() : hooks.known_frozen;
  pass.known_texts = hooks.known_texts;
  pass.cut_offs = hooks.known_cut_offs;
  if (pass.cut_offs.empty()) pass.cut_offs = CutOffsOf(pass.channels, machine);
  if (saturated)
    for (CutOff& cut : saturated->Found())
      if (std::ranges::none_of(
              pass.cut_offs, [&](const CutOff& other) { return other.upper && other.signal == cut.signal; }))
        pass.cut_offs.push_back(std::move(cut));
  return pass;
}

}  // namespace hydroscope
