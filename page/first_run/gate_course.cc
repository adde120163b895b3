#include "page/first_run/gate_course.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/constants.h"

namespace hydroscope {

GateCourse::GateCourse(const GateBound& bound, int signal, int block, int reach, double period)
    : bound_(bound), signal_(signal), block_(block), reach_(bound.rate ? reach : 0), period_(period) {
  for (int k = 0; k < reach_; ++k) envelope_.Add(kNaN);  // a rate is known that many blocks late
}

void GateCourse::Add(double value) {
  sum_ += value;
  if (++rows_ < block_) return;
  EndBlock();
  sum_ = 0;
  rows_ = 0;
}

void GateCourse::EndBlock() {
  means_.push_back(sum_ / block_);
  if (static_cast<int>(means_.size()) <= 2 * reach_) return;
  double x = means_.back();
  if (bound_.rate) {
    const double before = std::accumulate(means_.begin(), means_.begin() + reach_, 0.0),
                 after = std::accumulate(means_.end() - reach_, means_.end(), 0.0);
    x = (after - before) / reach_ / ((reach_ + 1) * block_ * period_);
  }
  envelope_.Add(bound_.magnitude ? std::abs(x) : x);
  means_.pop_front();
}

nlohmann::json GateCourse::Json(const std::string& si) const {
  const auto bound = [](const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
  };
  return {{"signal", bound_.signal},
          {"rate", bound_.rate},
          {"magnitude", bound_.magnitude},
          {"min", bound(bound_.min)},
          {"max", bound(bound_.max)},
          {"si", si},
          {"step", period_ * block_ * static_cast<double>(envelope_.rows_per_stretch())},
          {"low", envelope_.low()},
          {"high", envelope_.high()}};
}

}  // namespace hydroscope
