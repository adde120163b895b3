#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/quality_monitor.h"
#include "pipeline/log_faults/command_answer.h"
#include "pipeline/pipeline.h"
#include "storage/database.h"

namespace hydroscope {

/// A machine file in force: text and what it says.
struct LiveModel {
  std::string text;
  Machine machine;
  std::vector<std::string> columns;  ///< of the Grams
  std::vector<ConditionName> conditions;
};

/// One thing for the writer to do, in order for each axis.
struct WriteItem {
  enum class Kind { kStep, kEndRun, kBeginRun };
  Kind kind = Kind::kStep;
  int axis = 0;
  PackedBatch step;                        ///< kStep
  std::string summary;                     ///< kEndRun
  std::vector<std::uint8_t> state;         ///< kEndRun: what the next run starts from
  std::shared_ptr<const LiveModel> model;  ///< kBeginRun
  std::int64_t sent = 0;   ///< ns, monotonic: when the newest row of the step was sent; 0 without stroke
  std::int64_t taken = 0;  ///< ns, monotonic: when the pipeline had it
};

/// The pipeline of one axis and its runs. A run is a piece of the life of the service that begins with a
/// stored state: monitor and pipeline start anew there, exactly as in a replay of the run's raw rows.
class AxisPipeline {
 public:
  /// `packer`: of all axes that one thread works on; must outlive this.
  static Result<std::unique_ptr<AxisPipeline>> Create(int axis, std::shared_ptr<const LiveModel> model,
                                                      ColumnPacker& packer);

  /// Error: the state belongs to another model.
  Status RestoreState(const std::vector<std::uint8_t>& state) { return pipeline_->RestoreState(state); }
  std::vector<std::uint8_t> SaveState() const { return pipeline_->SaveState(); }

  /// Judges the rows and identifies. True if a stroke ended.
  bool Process(SampleBlock&& block);
  std::int64_t pending_rows() const { return static_cast<std::int64_t>(step_.raw.rows()); }
  /// The stroke under way will probably end within a quarter of GateSpec::stroke_gap, and more rows than that
  /// are pending: store them now, so that the stroke's own step is small when it is due.
  bool StrokeEndsSoon() const;
  /// What came since the last call, to be stored.
  WriteItem TakeStep(std::vector<std::uint8_t> sender_marks);
  /// Ends the run and begins another one, with `model`. An estimator with other parameters starts anew. Error: the model
  /// cannot be built; then the run goes on.
  Result<std::vector<WriteItem>> BeginNewRun(std::shared_ptr<const LiveModel> model,
                                             const std::vector<std::uint8_t>& sender_marks);
  /// Ends the run for good.
  std::vector<WriteItem> Finish(const std::vector<std::uint8_t>& sender_marks);

  std::int64_t run_rows() const { return rows_taken_; }
  std::int64_t strokes() const { return strokes_; }
  const StrokeRecord& last_stroke() const { return last_; }  ///< valid if strokes() > 0
  const std::vector<ChannelQuality>& channels() const { return monitor_->channels(); }
  /// What makes doubtful what the last stroke says (Pipeline::doubts), and signals that do not answer their commands.
  std::vector<Told> doubts() const;

 private:
  AxisPipeline(int axis, std::shared_ptr<const LiveModel> model, ColumnPacker& packer)
      : axis_(axis), model_(std::move(model)), packer_(packer) {}
  Status Build();
  std::vector<Told> UnansweredIn(const CommandAnswers& answers) const;
  std::string Summary() const;

  int axis_;
  std::shared_ptr<const LiveModel> model_;
  ColumnPacker& packer_;
  std::unique_ptr<Pipeline> pipeline_;
  std::unique_ptr<QualityMonitor> monitor_;
  std::unique_ptr<CommandAnswers> answers_;  ///< of the last minutes
  std::int64_t answered_rows_ = 0;           ///< that `answers_` has seen
  std::vector<Told> unanswered_;             ///< what those of the minutes before said
  LiveBatch step_;
  std::int64_t rows_taken_ = 0;  ///< of the run
  std::int64_t strokes_ = 0;     ///< of the life of the service
  StrokeRecord last_;
};

}  // namespace hydroscope
