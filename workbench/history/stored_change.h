#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/records/alarm_records.h"
#include "models/counted_words.h"
#include "models/machine.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {

/// A change inside a piece of a machine's history.
struct StoredChange {
  std::int64_t since = 0;       ///< first stroke behind it, machine-wide
  std::int64_t before_end = 0;  ///< strokes from here to `since` may lie on either side
  std::string by;               ///< what shows it: id of an alarm, a parameter, or kByModelError
  Told text;                    ///< "since stroke 481, told by the alarm internal_leakage"
  bool passes =
      false;  ///< strokes from `before_end` to `since` differ, those on both sides of them are alike
};

/// The alarm speaks of a change of the machine that stands: not of signals, limits or the service itself.
bool TellsAChange(const AlarmState& alarm);

/// The earliest change that a standing alarm of the drift watch tells inside `part`; without one, the change
/// of a parameter that is evident in the stored strokes: two levels describe independent blocks of strokes
/// (workbench/history/block_estimates.h) far better than one does, and clearly better than a line over the strokes or
/// over the oil temperature. Without that, the place where the error that each block's own fit leaves begins to be
/// larger (FindErrorGrowth). At least kFewestOnASide strokes lie on either side. nullopt: there is none, or
/// the strokes cannot be compared.
inline constexpr std::int64_t kFewestOnASide = 8;
inline constexpr const char* kByModelError = "model_error";
std::optional<StoredChange> FindStoredChange(const Database& database, const HistoryPart& part,
                                             const Machine& machine, const std::vector<AlarmState>& alarms);

/// Where FindStoredChange finds no place, as something moves on over the record or in several steps: the first strokes against the
/// newest of the parameter or size of an effect that does so most evidently (FindWhatMovesOn). nullopt as FindStoredChange.
std::optional<StoredChange> FindMovingOn(const Database& database, const HistoryPart& part,
                                         const Machine& machine);

/// All changes inside `part` in their order, kMostChanges at most: that of FindStoredChange and those on either side of it; of
/// a piece without one the stretch that differs from both of its sides (FindStretch). Without any of these, FindMovingOn.
inline constexpr std::size_t kMostChanges = 6;
std::vector<StoredChange> FindStoredChanges(const Database& database, const HistoryPart& part,
                                            const Machine& machine, const std::vector<AlarmState>& alarms);

/// Strokes of another machine differ from those before, too: the log that begins where they change, and does not begin `part`.
std::optional<RunInfo> LogThatBegins(const Database& database, const HistoryPart& part,
                                     const StoredChange& change);

/// "The log b.csv begins there, with stroke 154: if it is of another machine, ...".
Told AnotherMachineText(const RunInfo& log, const CountedWords& counted);

/// What speaks against taking the strokes on both sides of a change, or those of a stretch and the others, as one.
Told WarningOfBothSides(const StoredChange& change, const CountedWords& counted);

/// The alarms the journal beside the database knows of a machine; none if there is no journal, or it cannot
/// be read. Never creates it.
std::vector<AlarmState> AlarmsBeside(const std::string& database, const std::string& machine);

/// Two levels in a series.
struct LevelChange {
  std::size_t at = 0;  ///< first value of the second level
  double before = 0, after = 0;
  double p = 1;  ///< of no change, over all places it could have been
};
/// The place where two levels describe `values` best, if that is evident: p below 1e-4, and squares left that
/// are at most half of those about a straight line over the values' numbers and over each of `others` (as
/// long as `values`; NaN: not known, then that one is not asked). nullopt below 8 values.
std::optional<LevelChange> FindLevelChange(const std::vector<double>& values,
                                           const std::vector<std::vector<double>>& others);

/// Values alike at either end of a series: those before `first_end` and those from `last_begin` on.
struct BothEnds {
  std::size_t first_end = 0, last_begin = 0;
  double p = 1;  ///< of no change, as of LevelChange
};
/// The ends of a series that moves on, or in several steps: evident as a LevelChange, but that a straight line over the values'
/// numbers may describe it as well. nullopt below 8 values, or where a line over one of `others` does.
std::optional<BothEnds> FindWhatMovesOn(const std::vector<double>& values,
                                        const std::vector<std::vector<double>>& others);

/// A stretch of a series that differs from what lies on both sides of it, which is alike: first <= value < last.
struct Stretched {
  std::size_t first = 0, last = 0;
  double inside = 0, outside = 0;  ///< means
  double p = 1;                    ///< of none, over all that it could have been
};
/// The stretch that describes `values` best, evident as a LevelChange is (circular binary segmentation, Olshen et al. 2004).
std::optional<Stretched> FindStretch(const std::vector<double>& values,
                                     const std::vector<std::vector<double>>& others);

/// The place from which on `errors` (logarithms of error and noise energy over noise energy) are larger by more than
/// estimation/floor_trust.h lets a model err, if that is evident: p below 1e-4, successive values taken as correlated,
/// and squares left that are at most half of those about a straight line over each of `others`, as FindLevelChange. An
/// error that grows steadily is a change as well: no line over the values' numbers is asked, and as it draws the step behind
/// its beginning, the place is where the values begin to stand out. nullopt below 8 values.
std::optional<LevelChange> FindErrorGrowth(const std::vector<double>& errors,
                                           const std::vector<std::vector<double>>& others);

}  // namespace hydroscope
