#include "pipeline/stroke_overlays.h"

#include <algorithm>
#include <cmath>

#include "models/output_unit.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMostOverlays = 512;

}  // namespace

void StrokeOverlays::AddFlows(const SpanEquations& equations) {
  // What was collected belongs to a stroke that was too short.
  if (pipeline_.discarded_strokes() != discarded_) {
    discarded_ = pipeline_.discarded_strokes();
    time_.clear();
    flows_.clear();
  }
  // The matrix keeps the room of the longest span; the times say how many windows there are.
  for (std::size_t window = 0; window < equations.flow_time.size(); ++window) {
    time_.push_back(equations.flow_time[window]);
    flows_.push_back(equations.flow.col(window));
  }
}

void StrokeOverlays::AddStroke(const StrokeRecord& record) {
  const Eigen::VectorXd& weights = pipeline_.column_weights();
  if (weights.size() > 0 && !time_.empty()) Keep(Compare(record, weights));
  time_.clear();
  flows_.clear();
}

StrokeOverlays::Kept StrokeOverlays::Compare(const StrokeRecord& record,
                                             const Eigen::VectorXd& weights) const {
  const int output = pipeline_.model().output_column();
  Kept stroke;
  stroke.overlay.sequence = record.summary.index;
  stroke.overlay.output = pipeline_.model().words.output.english;
  stroke.overlay.unit = OutputUnit(&pipeline_.model());
  stroke.overlay.noise_floor = record.summary.noise_floor;
  stroke.overlay.time = time_;
  double squares = 0;
  for (const Eigen::VectorXd& flow : flows_) {
    stroke.overlay.measured.push_back(flow[output]);
    stroke.overlay.modelled.push_back(weights.dot(flow.head(weights.size())));
    squares += std::pow(flow[output] - stroke.overlay.modelled.back(), 2);
  }
  stroke.rms = std::sqrt(squares / static_cast<double>(time_.size()));
  return stroke;
}

void StrokeOverlays::Keep(Kept stroke) {
  if (worst_.overlay.time.empty() || stroke.rms > worst_.rms) worst_ = stroke;
  if (stroke.overlay.sequence % stride_ != 0) return;
  kept_.push_back(std::move(stroke));
  if (kept_.size() <= kMostOverlays) return;
  stride_ *= 2;
  std::erase_if(kept_, [this](const Kept& k) { return k.overlay.sequence % stride_ != 0; });
}

std::vector<StrokeOverlay> StrokeOverlays::Choose(std::int64_t first_sequence) const {
  std::vector<StrokeOverlay> chosen;
  if (kept_.empty() && worst_.overlay.time.empty()) return chosen;
  if (!kept_.empty()) {
    std::vector<const Kept*> by_error;
    for (const Kept& k : kept_) by_error.push_back(&k);
    std::ranges::sort(by_error, [](const Kept* a, const Kept* b) {
      return a->rms != b->rms ? a->rms < b->rms : a->overlay.sequence < b->overlay.sequence;
    });
    chosen.push_back(by_error[by_error.size() / 2]->overlay);
    chosen.back().label = "median error";
  }
  if (chosen.empty() || chosen.front().sequence != worst_.overlay.sequence) {
    chosen.push_back(worst_.overlay);
    chosen.back().label = "largest error";
  }
  for (StrokeOverlay& overlay : chosen) overlay.sequence += first_sequence;
  return chosen;
}

}  // namespace hydroscope
