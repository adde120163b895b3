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

  /// Leaves those rows in `block` for which `keep(row)` holds; asked of each in turn.
  template <typename Keep>
  static void KeepRows(SampleBlock& block, Keep keep) {
    std::size_t kept = 0;
    for (std::size_t row = 0; row < block.rows(); ++row)
      if (keep(row)) Move(row, kept++, block);
    block.Resize(block.signal.size(), kept);
  }

 private:
  static void Move(std::size_t from, std::size_t to, SampleBlock& block);

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
