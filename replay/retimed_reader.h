#pragma once

#include <memory>

#include "core/told.h"
#include "replay/log_reader.h"
#include "replay/time_check.h"

namespace hydroscope {

/// A log whose rows get other times than it has, or of which some are left out: flags of time follow from the times that are
/// given out, and rows are counted as they are.
class RetimedReader : public LogReader {
 public:
  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) final;
  double Progress() const final { return inner_->Progress(); }
  double SamplePeriod() const final { return period_; }
  const LogCounters& counters() const final { return counters_; }

 protected:
  /// `why` becomes LogCounters::time_base, behind that of `inner`.
  RetimedReader(std::unique_ptr<LogReader> inner, double period, const Told& why);

 private:
  /// Changes the times of `block`, as it was read but for its flags of time, or takes rows out of it.
  virtual void Retime(SampleBlock& block) = 0;
  void Count();

  std::unique_ptr<LogReader> inner_;
  double period_;  ///< s
  TimeChecker check_;
  LogCounters counters_, of_time_;
  std::int64_t given_ = 0;  ///< rows
};

}  // namespace hydroscope
