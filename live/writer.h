#pragma once

#include <sys/types.h>

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
#include "live/axis_pipeline.h"
#include "storage/database.h"

namespace hydroscope {

struct WriterOptions {
  RawLimits raw;                           ///< per axis
  std::int64_t min_free = 64ll << 20;      ///< bytes on the disk below which nothing is written
  std::int64_t queue_bytes = 128ll << 20;  ///< raw rows that may wait; the oldest go first
  std::size_t queue_strokes = 4096;        ///< strokes that may wait
};

enum class WriterState { kWriting, kDiskFull, kLocked, kFailing, kGone };
const char* WriterStateName(WriterState state);

struct WriterStatus {
  WriterState state = WriterState::kWriting;
  std::string problem;  ///< "" while all is well
  std::int64_t free_bytes = 0, database_bytes = 0;
  std::int64_t waiting_items = 0, waiting_bytes = 0, waiting_strokes = 0;
  std::int64_t steps = 0;              ///< transactions acknowledged
  std::int64_t strokes = 0, rows = 0;  ///< stored since the start
  std::int64_t dropped_rows = 0, dropped_strokes = 0, refused = 0;
  std::int64_t pauses = 0;                                   ///< times it could not write
  double latency_p50 = 0, latency_p99 = 0, latency_max = 0;  ///< s, stroke sent to estimate stored
  double commit_p99 = 0;                                     ///< s, pipeline to stored
};

/// Stores what the pipelines say, on a thread of its own: a step is stored as a whole or not at all, and
/// steps that wait together share a transaction, so that strokes of many axes that end at once cost little
/// more than one. When the disk is full or the database locked, it waits and tries again; what waits
/// meanwhile is bounded: raw rows go first, oldest first, then strokes, counted.
class LiveWriter {
 public:
  /// Runs already begun, one id per axis. `acknowledged`, if given, is told each stored step.
  struct Axis {
    std::int64_t machine = 0, run = 0;
    std::int64_t strokes = 0;  ///< of the run
    std::string name;          ///< of the machine in the database
  };
  using Acknowledged = std::function<void(const Axis&, const WriteItem&)>;
  LiveWriter(Database database, std::string path, std::vector<std::string> signals, std::vector<Axis> axes,
             WriterOptions options, Clock clock, Acknowledged acknowledged);
  ~LiveWriter();

  void Push(WriteItem&& item);
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
  bool FileIsThere() const;
  Status Gone() const;
  void Settle(const Status& done);
  bool HasCurrent() const { return !current_.empty() || current_check_.has_value(); }
  void Trim();
  bool DiskHasRoom();
  void Fail(const Error& error);
  void Count(const WriteItem& item);

  Database database_;
  std::string path_;
  std::vector<std::string> signals_;
  std::vector<Axis> axes_;
  WriterOptions options_;
  Clock clock_;
  std::pair<dev_t, ino_t> file_;  ///< the database as it was opened
  Acknowledged acknowledged_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<WriteItem> items_;
  std::deque<std::pair<int, ValveCheckRecord>> valve_checks_;
  std::vector<WriteItem> current_;    ///< taken off the queue by the thread, which alone touches it
  std::size_t singly_ = 0;            ///< items to be taken one by one, because one of them was refused
  std::size_t not_checkpointed_ = 0;  ///< transactions
  bool stroke_stored_ = false;        ///< by the last one
  std::optional<std::pair<int, ValveCheckRecord>> current_check_;
  WriterStatus status_;
  std::vector<double> latencies_, commits_;
  std::set<int> broken_;
  bool stopping_ = false, give_up_ = false;
  std::thread thread_;
};

}  // namespace hydroscope
