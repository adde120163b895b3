#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/records/sample_block.h"
#include "core/records/stroke_record.h"
#include "core/result.h"
#include "core/told.h"
#include "estimation/span_equations.h"
#include "models/machine.h"
#include "models/model_structure.h"

namespace hydroscope {

/// The way of one sample, for live service and replay alike: samples -> strokes -> StrokeRecord. Of a balance: BalancePipeline;
/// of a machine with states: EpisodePipeline. Pure: no clock, no files; the same rows give the same bytes however they are cut
/// into blocks. Blocks come in with their quality flags set (acquisition/quality_monitor.h).
class Pipeline {
 public:
  using RecordSink = std::function<void(StrokeRecord&&)>;
  /// Sees every stretch with its equations, for overlays and for locating errors.
  using EquationTap = std::function<void(const Stretch&, const SpanEquations&)>;

  static Result<std::unique_ptr<Pipeline>> Create(const Machine& machine, double sample_period,
                                                  RecordSink sink);
  virtual ~Pipeline() = default;

  /// The tap runs before the equations are forgotten and sees them with all columns, those of added effects behind. A machine
  /// with states has no stretches.
  void set_tap(EquationTap tap) { tap_ = std::move(tap); }
  virtual void Process(const SampleBlock& block) = 0;
  virtual void Finish() = 0;

  /// State between logs: what the estimator learned. Restore refuses a state of another model or version.
  virtual std::vector<std::uint8_t> SaveState() const = 0;
  virtual Status RestoreState(const std::vector<std::uint8_t>& state) = 0;

  const ModelStructure& model() const { return *model_; }
  std::shared_ptr<const ModelStructure> shared_model() const { return model_; }
  const WindowSamples& window() const { return window_; }
  virtual const StrokeCounters& totals() const = 0;
  /// The model after the stroke handed over last: modelled output = weights . first rows of SpanEquations::flow. Empty
  /// before the first estimate.
  virtual const Eigen::VectorXd& column_weights() const = 0;
  /// s for which the stroke under way has been outside the gate; it is over after GateSpec::stroke_gap.
  virtual double stroke_closed_for() const = 0;
  virtual std::int64_t discarded_strokes() const = 0;
  /// What makes doubtful what the stroke handed over last says (EpisodeModel::DoubtsOf).
  virtual std::vector<Told> doubts() const { return {}; }

 protected:
  Pipeline(std::shared_ptr<const ModelStructure> model, WindowSamples window)
      : model_(std::move(model)), window_(window) {}
  const EquationTap& tap() const { return tap_; }

 private:
  std::shared_ptr<const ModelStructure> model_;
  WindowSamples window_;
  EquationTap tap_;
};

}  // namespace hydroscope
