#pragma once

#include <deque>
#include <nlohmann/json_fwd.hpp>

#include "models/machine.h"
#include "page/first_run/log_picture.h"

namespace hydroscope {

/// What one bound of a gate looks at over a log, at the size of a screen: means over blocks, or their rate, as the segmenter
/// takes them (estimation/stroke_segmenter.h).
class GateCourse {
 public:
  /// `signal`: index into Machine::signals; `block`: rows of a mean; `reach`: blocks to either side that a rate is taken over;
  /// `period`: of the rows, s.
  GateCourse(const GateBound& bound, int signal, int block, int reach, double period);
  int signal() const { return signal_; }
  /// The next value of the signal, SI.
  void Add(double value);
  /// The bound (`signal`, `rate`, `magnitude`, `min`, `max`), `si` of the signal, and `step` (s) and lists `low`, `high` (SI).
  nlohmann::json Json(const std::string& si) const;

 private:
  void EndBlock();

  GateBound bound_;
  int signal_, block_, reach_;
  double period_;
  double sum_ = 0;
  int rows_ = 0;
  std::deque<double> means_;  ///< of the last 2 reach_ + 1 blocks
  Envelope envelope_{kPicturePoints};
};

}  // namespace hydroscope
