#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/records/sample_block.h"
#include "core/records/stroke_record.h"
#include "core/records/valve_check.h"
#include "core/result.h"
#include "storage/live_batch.h"

namespace hydroscope {

/// A machine model as it stood when strokes were identified with it.
struct ModelVersion {
  int version = 1;
  std::string definition;            ///< the machine file (TOML) in force
  std::vector<std::string> columns;  ///< names of the Gram columns, in order
  int promoted = 0;  ///< counts promotions of the machine; the greatest is in force, 0 = never
  std::vector<ConditionName> conditions = {};  ///< what StrokeSummary::conditions hold
};

/// A replay of one log (or, later, one session of the live service).
struct RunInfo {
  std::int64_t id = 0;
  std::string source;        ///< path of the log
  std::string fingerprint;   ///< identifies log content, machine file and program settings; same = same run
  std::int64_t strokes = 0;  ///< strokes stored so far
  std::int64_t first_sequence = 0;  ///< machine-wide sequence number of the run's stroke 0
  bool complete = false;
  std::string summary_json;  ///< counters of the finished run (rows, flags, findings), "" while incomplete
  bool abandoned = false;  ///< stopped halfway and overtaken by a later run: keeps its strokes, takes no more
  int model_version = 0;   ///< model its strokes were identified with
};

struct TrendPoint {
  std::int64_t run = 0;
  std::int64_t stroke = 0;     ///< index within the run
  std::int64_t sequence = 0;   ///< machine-wide stroke number
  double time = 0;             ///< s, end of the stroke in the log's own time
  double oil_temperature = 0;  ///< K, NaN if not measured
  Estimate estimate;
};

/// Consecutive strokes of one run as a picture of one parameter shows them; NaN where none of them has a value.
struct TrendBin {
  std::int64_t run = 0;
  std::int64_t first = 0, last = 0;  ///< machine-wide numbers of the first and the last stroke
  std::int64_t values = 0;           ///< strokes that have one
  double begin = 0, end = 0;         ///< s, ends of these two strokes in the log's own time
  double low = 0, high = 0;          ///< SI
  double mean = 0, std = 0;          ///< SI; `std` the mean of the strokes' own
  double oil_temperature = 0;        ///< K, mean of what the values stand for, or of the last stroke
};

/// Raw samples of one run, column-wise, as StoreRaw took them.
struct RawWindow {
  std::vector<std::string> signals;
  std::vector<double> time;                 ///< s
  std::vector<std::vector<double>> values;  ///< [signal][row], SI
  std::vector<std::vector<Quality>> flags;  ///< same shape
};

struct LiveStep {
  std::int64_t run = 0;
  const PackedBatch* batch = nullptr;
};

/// How much raw data is kept of a machine.
struct RawLimits {
  std::int64_t max_bytes = std::int64_t{1} << 30;
  double max_age = 7 * 86400.0;  ///< s before the newest row
};

/// Where the newest run of a machine stands.
struct LiveProgress {
  RunInfo run;
  std::vector<std::uint8_t> pipeline_state;  ///< behind its last stroke; empty: it has none yet
  std::vector<std::uint8_t> sender_marks;
  std::int64_t rows_taken = 0;
};

/// The part of a run that the raw window holds.
struct RawExtent {
  std::int64_t run = 0, rows = 0, bytes = 0, chunks = 0;
  double first = 0, last = 0;   ///< s
  std::int64_t rows_taken = 0;  ///< rows the pipeline took of the run; more than `rows`: not all are kept
};

/// How much the file holds of all its machines: equal counts, nothing came.
struct StoredCounts {
  std::int64_t runs = 0, strokes = 0, valve_checks = 0;
  bool operator==(const StoredCounts&) const = default;
};

/// A valve check as the trend database keeps it; NaN where nothing was measured.
struct ValveCheckRecord {
  std::string outcome;  ///< "measured", "refused", "broken", "no_answer", "unusable"
  std::string detail;   ///< one sentence for people
  ValveCheck check;     ///< its time always
};

/// The trend database, docs/database.md. WAL, synchronous=NORMAL, one transaction per batch.
/// A stroke is identified by (run, index) and is stored once, whatever is killed when. The same calls give
/// the same content to the byte: no clock, and no random number but Identity(), enters the file. Errors:
/// kBadInput for a file of another program, a newer version or damage, and for content that contradicts what
/// is stored; kInternal for a full disk or a lock that is not released; a failed call leaves the file as it
/// was before the call and may be repeated. One object belongs to one thread; several processes may read
/// while one writes.
class Database {
 public:
  /// Creates the file or opens it; an older schema is migrated, a newer one is an error that says so.
  static Result<Database> Open(const std::string& path);
  /// The older format of a file that Open brings up to date, which may take minutes where it holds many millions of estimates;
  /// nullopt if there is nothing to do, or no such file.
  static std::optional<int> OlderFormat(const std::string& path);
  /// For readers: never creates the file.
  static Result<Database> OpenReadOnly(const std::string& path);
  Database(Database&&) noexcept;
  Database& operator=(Database&&) noexcept;
  ~Database();

  /// Looks through the whole file for damage, in a connection of its own. Error: it is damaged, or no database
  /// of ours. Ends early, without a finding, when `stop` asks for it.
  static Status Check(const std::string& path, const std::stop_token& stop);

  /// 32 hex digits that no other database has; copies of the file keep them.
  Result<std::string> Identity() const;
  /// Id of the machine of this name, created if new.
  Result<std::int64_t> MachineId(const std::string& name);
  Result<std::vector<std::string>> MachineNames() const;
  /// Stores the definition as a new version if it differs from the latest; returns its version number.
  Result<int> PutModelVersion(std::int64_t machine, const ModelVersion& model);
  Result<ModelVersion> GetModelVersion(std::int64_t machine, int version) const;
  /// All versions in order, without their columns.
  Result<std::vector<ModelVersion>> ModelVersions(std::int64_t machine) const;
  /// Makes a stored version the model of replay and monitor.
  Status PromoteModel(std::int64_t machine, int version);
  /// The version promoted last; nullopt if none ever was.
  Result<std::optional<ModelVersion>> PromotedModel(std::int64_t machine) const;

  /// The run with this fingerprint, with the strokes it already has; created if new. A machine has one open
  /// run at a time: beginning another closes an incomplete one as `abandoned` (without strokes: removes it),
  /// so that machine-wide sequence numbers stay unique, without gaps and increasing. Beginning an abandoned
  /// run again is an error: its remaining strokes would come out of order.
  Result<RunInfo> BeginRun(std::int64_t machine, int model_version, const std::string& source,
                           const std::string& fingerprint);
  /// Appends strokes in one transaction. Strokes whose index is already stored are skipped, a hole is an
  /// error, and so is a stored stroke offered with other content: then nothing of the batch is stored.
  Status StoreStrokes(std::int64_t run, const std::vector<StrokeRecord>& strokes);
  /// Marks the run complete; `pipeline_state` lets the next run of the machine continue from here.
  Status FinishRun(std::int64_t run, const std::string& summary_json,
                   const std::vector<std::uint8_t>& pipeline_state);
  /// State the machine's latest complete run before `run` left; nullopt for the first run.
  Result<std::optional<std::vector<std::uint8_t>>> PipelineStateBefore(std::int64_t run) const;

  Result<std::vector<RunInfo>> Runs(std::int64_t machine) const;
  /// Trend of one parameter ("" = all), in order of sequence: strokes with first <= sequence < end. A long history is
  /// read piece by piece: a point takes some 200 bytes.
  Result<std::vector<TrendPoint>> Trend(std::int64_t machine, const std::string& parameter,
                                        std::int64_t first = 0,
                                        std::int64_t end = std::numeric_limits<std::int64_t>::max()) const;
  /// The trend of one parameter for a picture: strokes with first <= sequence < end, `width` of them to a bin, bins
  /// counted from the begin of their run. `most` > 0: only so many strokes of each bin are looked at, its first ones.
  /// SQLite finds lowest and highest value; a stroke takes some 0.2 us, a bin some 5 us.
  Result<std::vector<TrendBin>> TrendBins(std::int64_t machine, const std::string& parameter,
                                          std::int64_t first, std::int64_t end, std::int64_t width,
                                          std::int64_t most = 0) const;
  /// Sequence of the first stroke that ends at or after `time`, found by halving: for times that only grow over all
  /// runs, which is not looked into (SequenceAt does); the machine's end if there is none.
  Result<std::int64_t> SequenceNear(std::int64_t machine, double time) const;
  /// Names of the parameters whose estimates the machine's strokes hold, in the order in which they came.
  Result<std::vector<std::string>> ParameterNames(std::int64_t machine) const;
  Result<std::vector<StrokeSummary>> Strokes(std::int64_t run) const;
  /// Grams of strokes with first <= sequence < last.
  Result<std::vector<StrokeGram>> Grams(std::int64_t machine, std::int64_t first, std::int64_t last) const;
  /// Sequence behind the machine's newest stroke; 0 without strokes.
  Result<std::int64_t> EndSequence(std::int64_t machine) const;
  /// For who waits for more of any machine: one question in place of one for each.
  Result<StoredCounts> CountStored() const;
  /// Sequence of the first stroke that ends at or after `time` (s, the logs' own time). Error: a log begins
  /// before the log before it ended, so that a time does not tell which log is meant.
  Result<std::int64_t> SequenceAt(std::int64_t machine, double time) const;
  /// Summaries of strokes with first <= sequence < last, `index` being the sequence; of more than `most`,
  /// evenly spread ones.
  Result<std::vector<StrokeSummary>> SummariesOf(std::int64_t machine, std::int64_t first, std::int64_t last,
                                                 std::int64_t most) const;
  /// Their sum, from stored sums of 64 and 4096 strokes where these lie inside: single strokes in order of
  /// sequence inside each 64, the 64s in order inside each 4096. Equal to adding Grams() up to rounding.
  /// Strokes of different Gram columns do not add: an error that names where they change. Without strokes: an
  /// empty Gram (dimension 0).
  Result<StrokeGram> SumGrams(std::int64_t machine, std::int64_t first, std::int64_t last) const;

  /// Raw window: consecutive samples as compressed blobs, the machine's oldest dropped beyond `max_bytes`.
  /// Time increases strictly; rows not after the run's newest stored row are skipped (a resumed replay offers them again).
  Status StoreRaw(std::int64_t run, const std::vector<std::string>& signals, const std::vector<double>& time,
                  const std::vector<std::vector<double>>& values, std::int64_t max_bytes);
  /// Rows of the raw window with from <= time < to; empty if none is kept.
  Result<RawWindow> LoadRaw(std::int64_t run, double from, double to) const;
  /// From when on, at `from` or later, the raw window may have rows again, s; infinity: it has none.
  Result<double> NextRaw(std::int64_t run, double from) const;

  /// Steps of several runs of the live service, in order, in one transaction: all is stored or nothing, and pages
  /// they share are written once. Strokes as by StoreStrokes; raw rows must lie behind those the run has.
  Status StoreLive(std::span<const LiveStep> steps, const std::vector<std::string>& signals,
                   const RawLimits& limits);
  /// Moves what the write-ahead log holds into the database file, as far as no reader is in the way, and waits for
  /// the disk. It happens by itself when the log is long; asked for in a pause, it keeps nobody waiting, nor does
  /// the transaction that follows.
  Status Checkpoint();
  /// For who stores strokes of so many machines again and again: SQLite's memory, 2 MB by itself, holds the pages they go into,
  /// up to 1 MB for each, however long their histories are; else each stroke reads them anew, and writes them twice.
  Status KeepPagesOf(std::size_t machines);
  /// Reads the pages into which the next stroke of a run goes. Whatever another connection writes, a checkpoint too, makes
  /// SQLite forget all it keeps; what is fetched in a pause the next stroke does not wait for. The sums of
  /// groups of strokes that another process began are fetched as well.
  Status FetchPages(std::int64_t run);
  /// Pages read from the file into SQLite's memory so far.
  std::int64_t PagesRead() const;
  /// Pages looked at so far, in memory or not.
  std::int64_t PagesAsked() const;
  /// From now on Checkpoint is called in pauses: by itself it happens only beyond 64 MB, should they not come.
  Status LeaveCheckpointsToPauses();
  /// The machine's newest run; nullopt if it has none.
  Result<std::optional<LiveProgress>> NewestRun(std::int64_t machine) const;
  /// Runs of the machine of which raw rows are kept, in order.
  Result<std::vector<RawExtent>> RawExtents(std::int64_t machine) const;
  /// The run holds exactly these strokes, to the last bit of everything stored; an error names the first that
  /// differs. More strokes at the end of `strokes` than stored are no difference.
  Status CompareStrokes(std::int64_t run, const std::vector<StrokeRecord>& strokes) const;

  Status AddValveCheck(std::int64_t machine, const ValveCheckRecord& check);
  /// In order of adding.
  Result<std::vector<ValveCheckRecord>> ValveChecks(std::int64_t machine) const;

  /// FNV-1a hash (16 hex digits) over every value of every table but `identity` in order of keys: equal
  /// content, equal digest.
  Result<std::string> ContentDigest() const;
  /// Checks pages and indices (SQLite's integrity_check), stroke counts, holes and Gram checksums of the whole file.
  Status CheckIntegrity() const;

 private:
  struct Impl;  // storage/connection.h
  explicit Database(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace hydroscope
