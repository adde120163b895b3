#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/records/sample_block.h"
#include "core/told.h"
#include "models/machine.h"
#include "models/pressure_rule.h"

namespace hydroscope {

/// Whether a log's pressures are in one another's place, by the rules of the machine's kind (MachineKind::pressures), or two of them
/// are one reading.
class SwappedPressures {
 public:
  explicit SwappedPressures(const Machine& machine);
  /// Rows with their flags set.
  void Observe(const SampleBlock& block);
  /// A sentence for each pair that breaks its rule.
  std::vector<Told> Sentences() const;

 private:
  struct Mean {
    double sum = 0;
    std::int64_t rows = 0;
    void Add(double pressure) {
      sum += pressure;
      ++rows;
    }
    double value() const { return sum / static_cast<double>(rows); }
  };
  struct Pair {
    const PressureRule* rule = nullptr;
    std::size_t lower = 0, higher = 0, driven_by = 0;
    std::int64_t rows = 0, above = 0;  ///< in `above` of these `lower` stands above `higher`
    std::int64_t read = 0, alike = 0;  ///< rows in which both are good, and have the same reading
    double last = 0;                   ///< Pa, reading of `higher`
    bool moves = false;
    std::array<Mean, 2> of_lower, of_higher;  ///< Pa, as oil leaves the chamber, and as it enters
  };
  static void Count(double lower, double higher, double drive, Pair& pair);
  Told Sentence(const Pair& pair) const;
  Told Above(const Pair& pair, const Told& lower, const Told& higher) const;
  Told TheSame(const Pair& pair, const Told& lower, const Told& higher) const;
  Told PressedOut(const Pair& pair, const Told& lower, const Told& higher) const;

  const Machine& machine_;
  std::vector<Pair> pairs_;
};

}  // namespace hydroscope
