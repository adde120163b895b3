#include "service/stroke_overlays.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "estimation/gram_fit.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMaxKept = 512;

}  // namespace

StrokeOverlays::StrokeOverlays(Pipeline& pipeline, const Machine& machine)
    : pipeline_(pipeline),
      time_constant_(machine.estimator.time_constant),
      column_(static_cast<std::size_t>(pipeline.model().base_count) + 1) {
  pipeline_.set_tap([this](const Stretch&, const SpanEquations& equations) { AddFlows(equations); });
}

void StrokeOverlays::AddFlows(const SpanEquations& equations) {
  if (pipeline_.discarded_strokes() !=
      discarded_) {  // what was collected belongs to a stroke that was too short
    discarded_ = pipeline_.discarded_strokes();
    time_.clear();
    for (auto& column : column_) column.clear();
  }
  // The matrix keeps the room of the longest span; the times say how many windows there are.
  for (std::size_t window = 0; window < equations.flow_time.size(); ++window) {
    time_.push_back(equations.flow_time[window]);
    for (std::size_t c = 0; c < column_.size(); ++c)
      column_[c].push_back(equations.flow(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(window)));
  }
}

Eigen::VectorXd StrokeOverlays::Learn(const StrokeRecord& record) {
  const ModelStructure& model = pipeline_.model();
  std::vector<int> base(static_cast<std::size_t>(model.base_count));
  std::iota(base.begin(), base.end(), 0);
  const double used = static_cast<double>(record.summary.counters.used) * pipeline_.window().period;
  const double kept = std::exp(-used / time_constant_);
  recent_.h *= kept;
  recent_.g *= kept;
  recent_.yy *= kept;
  recent_.equations *= kept;
  recent_ += IntegralEquations(record.gram, base, model.output_column());
  return SolveNormalEquations(recent_);
}

void StrokeOverlays::AddStroke(const StrokeRecord& record) {
  const Eigen::VectorXd theta = Learn(record);
  if (theta.size() > 0 && !time_.empty()) Keep(Compare(record, theta));
  time_.clear();
  for (auto& column : column_) column.clear();
}

StrokeOverlays::Kept StrokeOverlays::Compare(const StrokeRecord& record, const Eigen::VectorXd& theta) const {
  Kept stroke;
  stroke.overlay.sequence = record.summary.index;
  stroke.overlay.noise_floor = record.summary.noise_floor;
  stroke.overlay.time = time_;
  stroke.overlay.measured = column_.back();
  double squares = 0;
  for (std::size_t k = 0; k < time_.size(); ++k) {
    double modelled = 0;
    for (std::size_t c = 0; c + 1 < column_.size(); ++c)
      modelled += theta[static_cast<int>(c)] * column_[c][k];
    stroke.overlay.modelled.push_back(modelled);
    squares += (column_.back()[k] - modelled) * (column_.back()[k] - modelled);
  }
  stroke.rms = std::sqrt(squares / static_cast<double>(time_.size()));
  return stroke;
}

void StrokeOverlays::Keep(Kept stroke) {
  if (worst_.overlay.time.empty() || stroke.rms > worst_.rms) worst_ = stroke;
  if (stroke.overlay.sequence % stride_ != 0) return;
  kept_.push_back(std::move(stroke));
  if (kept_.size() <= kMaxKept) return;
  stride_ *= 2;
  std::erase_if(kept_, [this](const Kept& k) { return k.overlay.sequence % stride_ != 0; });
}

std::vector<StrokeOverlay> StrokeOverlays::Choose(std::int64_t first_sequence) const {
  std::vector<StrokeOverlay> chosen;
  if (kept_.empty() && worst_.overlay.time.empty()) return chosen;
  if (!kept_.empty()) {
    std::vector<const Kept*> by_error;
    for (const Kept& k : kept_) by_error.push_back(&k);
    std::sort(by_error.begin(), by_error.end(), [](const Kept* a, const Kept* b) {
      return a->rms != b->rms ? a->rms < b->rms : a->overlay.sequence < b->overlay.sequence;
    });
    chosen.push_back(by_error[by_error.size() / 2]->overlay);
  }
  if (chosen.empty() || chosen.front().sequence != worst_.overlay.sequence) chosen.push_back(worst_.overlay);
  for (StrokeOverlay& overlay : chosen) overlay.sequence += first_sequence;
  return chosen;
}

}  // namespace hydroscope
