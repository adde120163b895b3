#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"
#include "studies/plant_grade.h"

namespace hydroscope {

struct PlantLogsOptions {
  int cases = 1000;                ///< simulated logs
  int first = 0;                   ///< number of the first: a log is drawn by its number and the seed
  std::uint64_t seed = 1;          ///< of the whole campaign
  std::vector<std::string> kinds;  ///< of PlantKinds(), empty = all
  int further = 0;                 ///< imperfections of other kinds in the same log
  int threads = 0;                 ///< 0: one per core
  std::string details;             ///< one line per case to this tab-separated file, "" = none
};

/// What came out for one kind, or for all.
struct PlantTally {
  int cases = 0, right = 0, wrong = 0, flagged = 0, extra = 0, unknown = 0, missed = 0;
  int identifiable = 0;          ///< cases whose truth can be identified ...
  int identifiable_unknown = 0;  ///< ... and that ended as unknown or missed
  int fits = 0, fit_off = 0;     ///< fits, and those that are off without a word

  void Add(const PlantTally& other);
};

struct PlantLogsResult {
  std::vector<std::pair<std::string, PlantTally>> kinds;
  PlantTally all;
  std::vector<std::string> details;  ///< a line per case, tab-separated, without header
  std::vector<std::string> wrong;    ///< those of `details` whose answer is wrong
};

/// Shares that a campaign must keep to.
struct PlantGoals {
  double wrong = 0.005, flagged = 0.02, unknown = 0.15, fit_off = 0.03;
  /// The shares that are missed, a line each; empty: all reached.
  std::vector<std::string> Missed(const PlantTally& tally) const;
};

/// Simulates logs of random machines, each with one imperfection of a kind plants have, with and without a
/// hidden effect of the library, and sends each through the whole chain of `explain` and through `fit`.
/// Errors: an unknown kind.
Result<PlantLogsResult> RunPlantLogs(const PlantLogsOptions& options);

/// `benchmark plant-logs`: prints the table; 0 if every goal is reached, else 1.
int RunPlantLogsBenchmark(const PlantLogsOptions& options);

}  // namespace hydroscope
