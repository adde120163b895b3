#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/records/alarm_records.h"
#include "core/result.h"

namespace hydroscope {

/// Version of the journal's tables, in `PRAGMA user_version`; docs/alarms.md describes them.
inline constexpr int kJournalFormat = 4;
/// "HYDJ", in `PRAGMA application_id`.
inline constexpr int kJournalApplicationId = 0x4859444a;

/// A frozen reference as learned, opaque bytes (diagnosis/drift/reference.h).
struct StoredReference {
  int version = 0;
  std::int64_t first_stroke = 0, last_stroke = 0;  ///< machine-wide, learned from these
  std::vector<std::uint8_t> bytes;
};

/// How far the strokes of an axis have been judged, with the monitor's state after them.
struct StoredMonitor {
  std::int64_t next_stroke = 0;  ///< machine-wide number of the first stroke not judged yet
  int model_version = 0;
  /// Opaque but for its first byte: 0 while the healthy machine is being learned. Empty before anything was
  /// stored of the axis.
  std::vector<std::uint8_t> state;

  /// There is a reference strokes are judged against.
  bool judges() const { return !state.empty() && state.front() != 0; }
};

/// Everything of one axis that changes together.
struct AxisContent {
  std::vector<AlarmState> alarms;  ///< in order of id
  StoredMonitor monitor;
  std::vector<AlarmEvent> events;           ///< to be appended
  std::vector<StoredReference> references;  ///< to be appended

  AlarmState& Alarm(const std::string& id);
  void Append(std::vector<AlarmEvent> more);
};

/// The alarm journal of a trend database, in a file of its own beside it: rows that are only ever appended,
/// numbered without gaps, with the alarms' present states and the monitors' states. WAL: events and references
/// that Change() has stored survive a loss of power; how far strokes are judged may be older after one, and is
/// found again. Triggers refuse to change or delete a row. Errors as of Database.
class AlarmJournal {
 public:
  /// "press.db" -> "press.alarms.db".
  static std::string PathFor(const std::string& database);
  static Result<AlarmJournal> Open(const std::string& path);
  /// Never creates the file.
  static Result<AlarmJournal> OpenExisting(const std::string& path);
  /// For readers, who need no right to write.
  static Result<AlarmJournal> OpenReadOnly(const std::string& path);
  AlarmJournal(AlarmJournal&&) noexcept;
  AlarmJournal& operator=(AlarmJournal&&) noexcept;
  ~AlarmJournal();

  /// Identity of the database it was paired with; "" if it was paired with none yet.
  Result<std::string> DatabaseIdentity() const;
  Status SetDatabaseIdentity(const std::string& identity);

  /// Reads the axis, lets `change` work on it and stores everything in one transaction that no other process
  /// interleaves; if `change` fails nothing is stored. `wall`: s since 1970, written with the rows.
  Status Change(const std::string& machine, double wall, const std::function<Status(AxisContent&)>& change);

  /// Differs as soon as anything was changed, through this object or by anybody else: much cheaper than to read what there is.
  struct Version {
    std::int64_t others = -1, own = -1;
    bool operator==(const Version&) const = default;
  };
  Result<Version> CurrentVersion() const;
  /// Pages of the file looked at so far, in memory or not.
  std::int64_t PagesAsked() const;
  Result<std::vector<std::string>> Machines() const;
  Result<AxisContent> Axis(const std::string& machine) const;
  /// Rows with sequence > `after`, at most `limit` (0 = all), in order; "" = all machines.
  Result<std::vector<JournalRow>> Rows(const std::string& machine, std::int64_t after = 0,
                                       std::int64_t limit = 0) const;
  /// Sequence of the newest row; 0 without rows.
  Result<std::int64_t> LastSequence() const;
  /// (machine, alarm) in the order in which rows first speak of them: since rows are only ever appended, the
  /// place of an alarm in this list never changes.
  Result<std::vector<std::pair<std::string, std::string>>> AlarmsByAppearance() const;
  /// The latest reference of a machine.
  Result<std::optional<StoredReference>> LatestReference(const std::string& machine) const;
  /// Sequence without gaps from 1, pages and indices sound.
  Status CheckIntegrity() const;

 private:
  struct Impl;
  explicit AlarmJournal(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace hydroscope
