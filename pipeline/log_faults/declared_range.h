#pragma once

#include <cstdint>
#include <vector>

#include "core/records/sample_block.h"
#include "core/told.h"
#include "models/machine.h"

namespace hydroscope {

/// How far readings may be from the range that the machine file declares (min and max of a signal). Such a range is that of a sensor,
/// and a machine at work uses more than a trace of it: a factor of 1000 between units shows at whatever use it makes.
struct DeclaredRangeOptions {
  double least = 1.0 / 500, most = 100;  ///< of the largest magnitude declared, that the largest reading has
  /// Of the readings of a signal, that may lie outside without a word: what a broken wire or a spike leaves for moments.
  double most_outside = 0.05;
};

/// Looks in the readings of a log for signals that are hundreds of times smaller or larger than their declared range, of those that
/// nothing else tells the size of (MachineInput::size): a wrong unit or scale. And for signals of which more than moments lie outside
/// of it, so that they are left out and what needs them goes without: a sign, a zero or the range is wrong.
class DeclaredRanges {
 public:
  /// `machine` must outlive it.
  explicit DeclaredRanges(const Machine& machine, const DeclaredRangeOptions& options = {});
  /// Rows as they come; missing readings and spikes do not count.
  void Observe(const SampleBlock& block);
  /// A sentence for each such signal, with the unit whose readings would fill the range.
  std::vector<Told> Sentences() const;

 private:
  struct Readings {
    std::size_t signal = 0;
    bool of_unknown_size = false;  ///< nothing but the range tells it
    double low = 0, high = 0;      ///< SI
    std::int64_t seen = 0, outside = 0, reversed_outside = 0;
  };
  bool IsOutside(const Readings& readings, double x) const;
  Told SizeText(const Readings& readings) const;
  Told OutsideText(const Readings& readings) const;

  const Machine& machine_;
  DeclaredRangeOptions options_;
  std::vector<Readings> watched_;
};

}  // namespace hydroscope
