#include "live/axis_pipeline.h"

#include "live/log.h"
#include "models/machine_kind.h"
#include "pipeline/doubtful_estimates.h"
#include "pipeline/episode_pipeline.h"
#include "pipeline/log_pass.h"
#include "pipeline/run_summary.h"

namespace hydroscope {
namespace {

/// s of rows over which signals are held against their commands: what was wrong and is mended is no longer told after twice that.
constexpr double kAnswersOver = 300;

void Append(const SampleBlock& from, SampleBlock& to) {
  to.time.insert(to.time.end(), from.time.begin(), from.time.end());
  to.signal.resize(from.signal.size());
  to.quality.resize(from.quality.size());
  for (std::size_t s = 0; s < from.signal.size(); ++s) {
    to.signal[s].insert(to.signal[s].end(), from.signal[s].begin(), from.signal[s].end());
    to.quality[s].insert(to.quality[s].end(), from.quality[s].begin(), from.quality[s].end());
  }
}

}  // namespace

Result<std::unique_ptr<AxisPipeline>> AxisPipeline::Create(int axis, std::shared_ptr<const LiveModel> model,
                                                           ColumnPacker& packer) {
  std::unique_ptr<AxisPipeline> made(new AxisPipeline(axis, std::move(model), packer));
  TRY(made->Build());
  return made;
}

Status AxisPipeline::Build() {
  const Machine& machine = model_->machine;
  auto pipeline = TRY(Pipeline::Create(machine, machine.live->grid_period, [this](StrokeRecord&& record) {
    last_ = {record.summary, {}, record.estimates};
    ++strokes_;
    if (record.estimates.empty() && InEpisodes(KindOf(model_->machine)))
      LogWarning("episode_without_estimate", {{"axis", AxisMachineName(model_->machine, axis_)},
                                              {"episode", std::to_string(record.summary.index)},
                                              {"why", SilentEpisode(model_->machine)}});
    step_.strokes.push_back(std::move(record));
    step_.pipeline_state = pipeline_->SaveState();
  }));
  pipeline_ = std::move(pipeline);
  monitor_ = std::make_unique<QualityMonitor>(machine, machine.live->grid_period);
  answers_ = std::make_unique<CommandAnswers>(machine);
  answered_rows_ = 0;
  unanswered_.clear();
  rows_taken_ = 0;
  return {};
}

bool AxisPipeline::Process(SampleBlock&& block) {
  const std::size_t before = step_.strokes.size();
  rows_taken_ += static_cast<std::int64_t>(block.rows());
  Append(block, step_.raw);
  monitor_->Inspect(block);
  answers_->Observe(block);
  answered_rows_ += static_cast<std::int64_t>(block.rows());
  if (static_cast<double>(answered_rows_) * model_->machine.live->grid_period >= kAnswersOver) {
    unanswered_ = UnansweredIn(*answers_);
    answers_ = std::make_unique<CommandAnswers>(model_->machine);
    answered_rows_ = 0;
  }
  pipeline_->Process(block);
  return step_.strokes.size() > before;
}

std::vector<Told> AxisPipeline::UnansweredIn(const CommandAnswers& answers) const {
  std::vector<Told> told;
  if (rows_taken_ == 0) return told;
  const double gated = static_cast<double>(pipeline_->totals().gated);
  for (const auto& faults : {answers.Against(gated / static_cast<double>(rows_taken_)), answers.Sizes()})
    for (const CommandAnswers::Fault& fault : faults) told.push_back(fault.text);
  return told;
}

std::vector<Told> AxisPipeline::doubts() const {
  std::vector<Told> doubts = strokes_ > 0 ? pipeline_->doubts() : std::vector<Told>();
  const std::vector<Told> now = UnansweredIn(*answers_);
  AddDoubts(now.empty() ? unanswered_ : now, doubts);
  return doubts;
}

bool AxisPipeline::StrokeEndsSoon() const {
  const Machine& machine = model_->machine;
  const double soon = machine.gate.stroke_gap / 4;
  return pipeline_->stroke_closed_for() > machine.gate.stroke_gap - soon &&
         static_cast<double>(pending_rows()) * machine.live->grid_period > soon;
}

WriteItem AxisPipeline::TakeStep(std::vector<std::uint8_t> sender_marks) {
  WriteItem item;
  item.axis = axis_;
  step_.rows_taken = rows_taken_;
  step_.sender_marks = std::move(sender_marks);
  item.step = Pack(std::exchange(step_, {}), packer_);
  return item;
}

std::vector<WriteItem> AxisPipeline::Finish(const std::vector<std::uint8_t>& sender_marks) {
  SampleBlock rest;
  monitor_->Flush(rest);
  pipeline_->Process(rest);
  pipeline_->Finish();
  std::vector<WriteItem> items;
  items.push_back(TakeStep(sender_marks));
  WriteItem end;
  end.kind = WriteItem::Kind::kEndRun;
  end.axis = axis_;
  end.summary = Summary();
  end.state = pipeline_->SaveState();
  items.push_back(std::move(end));
  return items;
}

Result<std::vector<WriteItem>> AxisPipeline::BeginNewRun(std::shared_ptr<const LiveModel> model,
                                                         const std::vector<std::uint8_t>& sender_marks) {
  const auto next = Create(axis_, model, packer_);  // refuses before anything is ended
  if (!next) return tl::unexpected(next.error());
  std::vector<WriteItem> items = Finish(sender_marks);
  model_ = std::move(model);
  TRY(Build());
  if (const Status restored = RestoreState(items.back().state); !restored)
    LogWarning("estimator_starts_anew",
               {{"axis", AxisMachineName(model_->machine, axis_)}, {"why", restored.error().text}});
  WriteItem begin;
  begin.kind = WriteItem::Kind::kBeginRun;
  begin.axis = axis_;
  begin.model = model_;
  items.push_back(std::move(begin));
  return items;
}

std::string AxisPipeline::Summary() const {
  LogPass pass;
  TakeChannels(*monitor_, model_->machine, pass);
  RunSummary& summary = pass.summary;
  summary.sample_period = model_->machine.live->grid_period;
  summary.rows = rows_taken_;
  summary.gated = pipeline_->totals().gated;
  summary.used = pipeline_->totals().used;
  summary.discarded_strokes = pipeline_->discarded_strokes();
  return FormatRunSummary(summary);
}

}  // namespace hydroscope
