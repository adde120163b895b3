#pragma once

#include <cstddef>
#include <optional>

#include "core/records/sample_block.h"
#include "models/machine.h"

namespace hydroscope {

/// Finds where the output of a machine in closed loop repeats one reading, bit for bit, while its set point moves: a sensor or a
/// wire that stands. For longer than the signal's `stuck_time`, in which the set point goes through more than a few of the
/// smallest steps that the output was seen to make. An output that rests with its set point does not stand. Its noise is not asked
/// for, as a rod that is driven all the time shows none. Does not depend on how rows are cut into blocks.
class StandingOutput {
 public:
  /// Nothing of other machines, and where the output may be stuck (`stuck_time` 0). `sample_period` in s.
  static std::optional<StandingOutput> For(const Machine& machine, double sample_period);

  /// Flags the readings that stand quality::kStuck. `block` holds the rows that came next.
  void Judge(SampleBlock& block);
  std::size_t signal() const { return output_; }
  /// Readings before the block judged last that turned out to stand.
  std::size_t before() const { return before_; }
  /// Readings that may yet turn out to.
  std::size_t reach() const;

 private:
  std::size_t output_ = 0, set_point_ = 0;
  std::size_t least_ = 0;      ///< rows
  double last_ = 0;            ///< reading
  double step_ = 0;            ///< smallest seen between readings; 0: none yet
  double at_ = 0;              ///< set point when it came to this reading
  double low_ = 0, high_ = 0;  ///< set points since
  std::size_t moving_ = 0;     ///< rows since the set point left `at_`
  bool begun_ = false, stands_ = false;
  std::size_t before_ = 0;
};

}  // namespace hydroscope
