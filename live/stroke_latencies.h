#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/quantile.h"

namespace hydroscope {

/// How long the newest strokes took, s: from the sample that ended them was sent, and from their pipeline, until they were stored.
class StrokeLatencies {
 public:
  void Add(double since_sent, double since_pipeline) {
    if (sent_.size() >= kKept) {
      sent_.erase(sent_.begin(), sent_.begin() + kKept / 2);
      pipeline_.erase(pipeline_.begin(), pipeline_.begin() + kKept / 2);
    }
    sent_.push_back(since_sent);
    pipeline_.push_back(since_pipeline);
  }
  double SinceSent(double share) const { return Quantile(sent_, share, 0); }
  double SincePipeline(double share) const { return Quantile(pipeline_, share, 0); }
  std::vector<double> TakeSinceSent() { return std::exchange(sent_, {}); }

 private:
  static constexpr std::size_t kKept = 65536;
  std::vector<double> sent_, pipeline_;
};

}  // namespace hydroscope
