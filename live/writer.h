#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "core/told.h"
#include "live/axis_pipeline.h"
#include "live/stroke_latencies.h"
#include "storage/database.h"
#include "storage/file_identity.h"

namespace hydroscope {

struct WriterOptions {
  RawLimits raw;                           ///< per axis
  std::int64_t min_free = 64ll << 20;      ///< bytes on the disk below which nothing is written
  std::int64_t queue_bytes = 128ll << 20;  ///< raw rows that may wait; the oldest go first
  std::size_t queue_strokes = 4096;        ///< strokes that may wait
  double anew_after = 10;                  ///< s without its file after which it begins another database
};

enum class WriterState { kWriting, kDiskFull, kLocked, kFailing, kGone, kDamaged };
const char* WriterStateName(WriterState state);

struct WriterStatus {
  WriterState state = WriterState::kWriting;
  Told problem;  ///< empty while all is well
  std::int64_t free_bytes = 0, database_bytes = 0;
  std::int64_t waiting_items = 0, waiting_bytes = 0, waiting_strokes = 0;
  std::int64_t steps = 0;              ///< transactions acknowledged
  std::int64_t strokes = 0, rows = 0;  ///< stored since the start
  std::int64_t dropped_rows = 0, dropped_strokes = 0, refused = 0;
  std::int64_t pauses = 0;                                   ///< times it could not write
  std::int64_t databases = 1;                                ///< since the start: others were lost
  Told begun_anew;                                           ///< why the present one was begun; "": the first
  double latency_p50 = 0, latency_p99 = 0, latency_max = 0;  ///< s, stroke sent to estimate stored
  double commit_p99 = 0;                                     ///< s, pipeline to stored
};

/// Ending of the fingerprint of a run whose begin went with a lost database.
inline constexpr const char* kBegunAnew = "/begun anew";

/// Stores what the pipelines say, on a thread of its own: a step is stored as a whole or not at all, and
/// steps that wait together share a transaction, so that strokes of many axes that end at once cost little
/// more than one. When the disk is full or the database locked, it waits and tries again; what waits
/// meanwhile is bounded: raw rows go first, oldest first, then strokes, counted. Once a second, also while
/// there is nothing to store, it looks whether its file is still there and whether somebody else wrote into it.
/// A damaged file is set aside under a dated name, one that stays away is given up, and another one begun, into
/// which goes what waits; the runs under way are ended and begun anew, since a part of their rows is lost.
class LiveWriter {
 public:
  /// Runs already begun, one id per axis. `acknowledged`, if given, is told each stored step.
  struct Axis {
    std::int64_t machine = 0, run = 0;
    std::int64_t strokes = 0;                ///< of the run
    std::string name;                        ///< of the machine in the database
    std::shared_ptr<const LiveModel> model;  ///< of the run
  };
  using Acknowledged = std::function<void(const Axis&, const WriteItem&)>;
  LiveWriter(Database database, std::string path, std::vector<std::string> signals, std::vector<Axis> axes,
             WriterOptions options, Clock clock, Acknowledged acknowledged);
  ~LiveWriter();

  /// What belongs together is handed over at once: it then shares a transaction. Leaves `items` empty.
  void Push(std::vector<WriteItem>&& items);
  /// Writes what waits, for at most `seconds`, and ends the thread. False: something could not be written.
  bool Stop(double seconds);
  WriterStatus status() const;
  /// Axes whose run lost strokes or was refused, to be begun anew; each is told once.
  std::set<int> TakeBroken();
  /// All latencies (s) since the last call, for benchmarks; at most the newest 65536.
  std::vector<double> TakeLatencies();
  void AddValveCheck(int axis, ValveCheckRecord check);

 private:
  void Run();
  bool WaitForWork(std::unique_lock<std::mutex>& lock);
  Status Work();
  Status StoreSteps();
  Status Execute(WriteItem& item);
  Status NoRoom() const;
  Status LookAtFile();
  Status Gone() const;
  Status BeginAnew(const Told& why, bool damaged);
  Status BeginRuns();
  Status BeginRun(Axis& axis, const char* ending);
  void LookForDamage();
  bool CheckpointIsDue() const;
  Status Checkpoint();
  void FetchPages();
  void Settle(const Status& done);
  bool HasCurrent() const { return !current_.empty() || current_check_.has_value(); }
  void Trim();
  bool DiskHasRoom();
  void Fail(const Error& error);
  void Count(const WriteItem& item);

  std::optional<Database> database_;  ///< nullopt: lost, and another one could not be begun yet
  std::string path_;
  std::optional<Database> for_checkpoints_;  ///< used by `checkpointer_` alone while it runs
  std::vector<std::string> signals_;
  std::vector<Axis> axes_;
  WriterOptions options_;
  Clock clock_;
  FileIdentity file_;            ///< the database as it was opened
  std::int64_t written_ = 0;     ///< ns since 1970, when we last wrote into the file; steps go into its log
  std::int64_t gone_since_ = 0;  ///< ns, monotonic; 0: it is there
  Acknowledged acknowledged_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<WriteItem> items_;
  std::deque<std::pair<int, ValveCheckRecord>> valve_checks_;
  std::vector<WriteItem> current_;  ///< taken off the queue by the thread, which alone touches it
  std::size_t singly_ = 0;          ///< items to be taken one by one, because one of them was refused
  std::atomic<std::size_t> not_checkpointed_ = 0;  ///< transactions
  bool stroke_stored_ = false;                     ///< by the last one
  std::size_t to_fetch_ = 0;                       ///< axes into whose pages the next strokes have to be read
  std::optional<std::pair<int, ValveCheckRecord>> current_check_;
  WriterStatus status_;
  StrokeLatencies latencies_;
  std::set<int> broken_;
  Told damage_;  ///< what is wrong with the file, from a check or from SQLite itself
  bool checking_ = false;
  bool checkpointing_ = false;
  Status checkpointed_;  ///< how the last checkpoint went
  bool stopping_ = false, give_up_ = false;
  std::jthread checker_, checkpointer_;
  std::thread thread_;
};

}  // namespace hydroscope
