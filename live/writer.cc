#include "live/writer.h"

#include <sys/resource.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>

#include "core/told_error.h"
#include "host/resident_memory.h"
#include "live/burst_memory.h"
#include "live/log.h"
#include "live/store_errors.h"
#include "monitor/promoted_model.h"
#include "pipeline/run_summary.h"
#include "storage/set_aside.h"

namespace hydroscope {
namespace {

constexpr std::chrono::milliseconds kRetry(250);
constexpr std::chrono::milliseconds kPause(50);   // without work: time for a checkpoint, if it is due
constexpr std::chrono::milliseconds kLook(1000);  // at the file, without work
// transactions; behind a stroke, when the next one is farthest.
constexpr std::size_t kStepsToCheckpoint = 16;
constexpr std::size_t kStepsWithoutStroke = 128;
constexpr std::size_t kStepsTogether = 128;
constexpr int kPatience = 10;  // niceness of checkpoints beyond that of the service
constexpr std::size_t kItemsKept = 10'000;

std::int64_t Bytes(const WriteItem& item) {
  std::int64_t bytes = 0;
  if (item.step.raw)
    for (const RawChunk& chunk : *item.step.raw) bytes += chunk.bytes();
  return bytes;
}

std::optional<Database> Opened(const std::string& path) {
  auto database = Database::Open(path);
  return database ? std::optional(std::move(*database)) : std::nullopt;
}

}  // namespace

const char* WriterStateName(WriterState state) {
  switch (state) {
    case WriterState::kWriting:
      return "writing";
    case WriterState::kDiskFull:
      return "disk_full";
    case WriterState::kLocked:
      return "locked";
    case WriterState::kFailing:
      return "failing";
    case WriterState::kGone:
      return "gone";
    case WriterState::kDamaged:
      return "damaged";
  }
  return "";
}

LiveWriter::LiveWriter(Database database, std::string path, std::vector<std::string> signals,
                       std::vector<Axis> axes, WriterOptions options, Clock clock, Acknowledged acknowledged)
    : database_(std::move(database)),
      path_(std::move(path)),
      for_checkpoints_(Opened(path_)),
      signals_(std::move(signals)),
      axes_(std::move(axes)),
      options_(options),
      clock_(std::move(clock)),
      file_(FileIdentity::Of(path_)),
      written_(LastWritten(path_)),
      acknowledged_(std::move(acknowledged)),
      thread_([this] { Run(); }) {}

LiveWriter::~LiveWriter() { Stop(0); }

void LiveWriter::Push(std::vector<WriteItem>&& items) {
  if (items.empty()) return;
  {
    std::lock_guard lock(mutex_);
    for (WriteItem& item : items) {
      status_.waiting_bytes += Bytes(item);
      status_.waiting_strokes += static_cast<std::int64_t>(item.step.strokes.size());
      items_.push_back(std::move(item));
    }
    Trim();
  }
  items.clear();
  changed_.notify_one();
}

/// Keeps what waits within bounds: raw rows of the oldest steps go first, then their strokes.
void LiveWriter::Trim() {
  for (WriteItem& item : items_) {
    if (status_.waiting_bytes <= options_.queue_bytes) break;
    if (item.step.rows == 0) continue;
    status_.waiting_bytes -= Bytes(item);
    status_.dropped_rows += std::exchange(item.step.rows, 0);
    item.step.raw = {};
    broken_.insert(item.axis);
  }
  for (WriteItem& item : items_) {
    if (status_.waiting_strokes <= static_cast<std::int64_t>(options_.queue_strokes)) break;
    auto& strokes = item.step.strokes;
    status_.waiting_strokes -= static_cast<std::int64_t>(strokes.size());
    status_.dropped_strokes += static_cast<std::int64_t>(strokes.size());
    if (!strokes.empty()) broken_.insert(item.axis);
    strokes.clear();
  }
  const auto says_nothing = [](const WriteItem& item) {
    return item.kind == WriteItem::Kind::kStep && item.step.rows == 0 && item.step.strokes.empty();
  };
  if (items_.size() > kItemsKept) std::erase_if(items_, says_nothing);
}

void LiveWriter::Run() {
  // If that fails the first step fails as well.
  static_cast<void>(database_->LeaveCheckpointsToPauses());
  static_cast<void>(database_->KeepPagesOf(axes_.size()));
  FetchMemory(BurstMemory(axes_.size()));
  DiskHasRoom();  // known before anything is to be written
  std::unique_lock lock(mutex_);
  to_fetch_ = 2 * axes_.size();  // sums that an earlier life began come first, and push pages out
  while (WaitForWork(lock)) {
    lock.unlock();
    const Status file = LookAtFile();
    Status done = !file || !HasCurrent() ? file : DiskHasRoom() ? Work() : NoRoom();
    if (done && !HasCurrent()) FetchPages();
    if (done && !HasCurrent()) done = Checkpoint();
    lock.lock();
    if (!done && IsDamage(done.error(), path_)) damage_ = ToldOf(done.error());
    if (done || (file && damage_.empty() && !MayPass(done.error()))) {
      Settle(done);
      continue;
    }
    Fail(done.error());
    changed_.wait_for(lock, kRetry, [this] { return give_up_; });
  }
}

/// Begins one if it is due, on a thread and a connection of its own: the disk takes its time, and strokes do not wait for it.
/// Returns how the last one went, so that who is in its way is told.
Status LiveWriter::Checkpoint() {
  std::lock_guard lock(mutex_);
  if (checkpointing_ || !CheckpointIsDue()) return checkpointed_;
  checkpointing_ = true;
  not_checkpointed_ = 0;
  checkpointer_ = std::jthread([this] {
    setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + kPatience);  // of this thread
    const Status done = for_checkpoints_ ? for_checkpoints_->Checkpoint() : Status{};
    {
      std::lock_guard locked(mutex_);
      written_ = LastWritten(path_);
      checkpointing_ = false;
      to_fetch_ = axes_.size();
      const bool again = !done && MayPass(done.error());
      checkpointed_ = again || (!done && IsDamage(done.error(), path_)) ? done : Status{};
      if (again) not_checkpointed_ = kStepsWithoutStroke;
    }
    changed_.notify_all();
  });
  return checkpointed_;
}

/// Of one axis, so that a stroke that comes meanwhile hardly waits. What is wrong with the file the next step tells.
void LiveWriter::FetchPages() {
  std::size_t axis = 0;
  {
    std::lock_guard lock(mutex_);
    if (to_fetch_ == 0) return;
    axis = --to_fetch_ % axes_.size();
  }
  static_cast<void>(database_->FetchPages(axes_[axis].run));
}

bool LiveWriter::CheckpointIsDue() const {
  return not_checkpointed_ >= (stroke_stored_ ? kStepsToCheckpoint : kStepsWithoutStroke);
}

/// Takes the next things to do, nothing if there is time for a checkpoint or a look at the file; false at the end. What could not
/// be written is taken again.
bool LiveWriter::WaitForWork(std::unique_lock<std::mutex>& lock) {
  const auto wanted = [this] {
    return stopping_ || HasCurrent() || !items_.empty() || !valve_checks_.empty();
  };
  changed_.wait_for(lock, CheckpointIsDue() ? kPause : kLook, [&] { return wanted() || to_fetch_ > 0; });
  if (!wanted()) return true;
  if (give_up_) return false;
  if (HasCurrent()) return true;
  if (!valve_checks_.empty()) {
    current_check_ = std::move(valve_checks_.front());
    valve_checks_.pop_front();
    return true;
  }
  const auto is_step = [this] { return !items_.empty() && items_.front().kind == WriteItem::Kind::kStep; };
  const std::size_t most = singly_ > 0 ? 1 : kStepsTogether;
  while (current_.empty() ? !items_.empty() : current_.size() < most && is_step()) {
    current_.push_back(std::move(items_.front()));
    items_.pop_front();
    if (current_.front().kind != WriteItem::Kind::kStep) break;
  }
  singly_ -= std::min(singly_, current_.size());
  return HasCurrent();
}

Status LiveWriter::Work() {
  if (current_check_)
    return database_->AddValveCheck(axes_[static_cast<std::size_t>(current_check_->first)].machine,
                                    current_check_->second);
  return current_.front().kind == WriteItem::Kind::kStep ? StoreSteps() : Execute(current_.front());
}

/// All steps of `current_` in one transaction.
Status LiveWriter::StoreSteps() {
  std::map<int, std::int64_t> next;  // stroke of each axis
  std::vector<LiveStep> steps;
  for (WriteItem& item : current_) {
    const Axis& axis = axes_[static_cast<std::size_t>(item.axis)];
    std::int64_t& index = next.try_emplace(item.axis, axis.strokes).first->second;
    for (PackedStroke& stroke : item.step.strokes) stroke.summary.index = index++;
    steps.push_back({axis.run, &item.step});
  }
  TRY(database_->StoreLive(steps, signals_, options_.raw));
  ++not_checkpointed_;
  stroke_stored_ = false;
  for (const WriteItem& item : current_) {
    Axis& axis = axes_[static_cast<std::size_t>(item.axis)];
    axis.strokes += static_cast<std::int64_t>(item.step.strokes.size());
    stroke_stored_ = stroke_stored_ || !item.step.strokes.empty();
    if (acknowledged_) acknowledged_(axis, item);
  }
  return {};
}

Status LiveWriter::NoRoom() const {
  return InternalError(
      Tell("{}: the disk is full: less than {} MB are free. Nothing is written until there is room",
           "{}: die Platte ist voll: weniger als {} MB sind frei. Nichts wird geschrieben, bis Platz ist",
           path_, options_.min_free >> 20));
}

/// What was to be done is over, one way or the other. Of several steps refused together each is tried alone.
void LiveWriter::Settle(const Status& done) {
  if (!done && current_.size() > 1) {
    singly_ = current_.size();
    items_.insert(items_.begin(), std::make_move_iterator(current_.begin()),
                  std::make_move_iterator(current_.end()));
    current_.clear();
    return;
  }
  if (!done) {
    ++status_.refused;
    const int axis = current_check_ ? current_check_->first : current_.front().axis;
    broken_.insert(axis);
    LogError("write_refused",
             {{"axis", axes_[static_cast<std::size_t>(axis)].name}, {"why", done.error().text}});
  }
  for (const WriteItem& item : current_) {
    status_.waiting_bytes -= Bytes(item);
    status_.waiting_strokes -= static_cast<std::int64_t>(item.step.strokes.size());
    if (done) Count(item);
  }
  current_.clear();
  current_check_.reset();
  if (done && status_.state != WriterState::kWriting) {
    LogInfo("writing_again", {{"after", WriterStateName(status_.state)}});
    status_.state = WriterState::kWriting;
    status_.problem = {};
  }
  changed_.notify_all();
}

void LiveWriter::Fail(const Error& error) {
  const WriterState state = !damage_.empty()                      ? WriterState::kDamaged
                            : ErrorSays(error, "file is gone")    ? WriterState::kGone
                            : ErrorSays(error, "disk is full")    ? WriterState::kDiskFull
                            : ErrorSays(error, "another process") ? WriterState::kLocked
                                                                  : WriterState::kFailing;
  if (status_.state != state) {
    ++status_.pauses;
    LogWarning("cannot_write", {{"state", WriterStateName(state)}, {"why", error.text}});
  }
  status_.state = state;
  status_.problem = ToldOf(error);
}

/// The file that was opened still has its name, and nobody damaged it: one that was deleted, moved or replaced
/// would take what is written with it, unseen.
Status LiveWriter::LookAtFile() {
  Told damage;
  {
    std::lock_guard lock(mutex_);
    damage = damage_;
  }
  if (!damage.empty()) return BeginAnew(damage, true);
  const std::int64_t now = clock_().monotonic_ns;
  if (database_ && FileIdentity::Of(path_) == file_) {
    gone_since_ = 0;
    LookForDamage();
    return {};
  }
  if (gone_since_ == 0) gone_since_ = now;
  if (database_ && Seconds(now - gone_since_) < options_.anew_after) return Gone();
  return BeginAnew({"the database file was deleted, moved or replaced",
                    "die Datei der Datenbank wurde gelöscht, verschoben oder ersetzt"},
                   false);
}

/// Begins a look if somebody else wrote into the file: another program of ours, or one that damages it. Not one that deletes it.
void LiveWriter::LookForDamage() {
  std::lock_guard lock(mutex_);
  const std::int64_t written = LastWritten(path_);
  if (checking_ || checkpointing_ || written == written_) return;  // a look under way may have passed it
  checking_ = true;
  written_ = written;
  checker_ = std::jthread([this, file = file_](const std::stop_token& stop) {
    const Status sound = Database::Check(path_, stop);
    {
      std::lock_guard locked(mutex_);
      checking_ = false;
      if (!sound && sound.error().kind == ErrorKind::kBadInput && !MayPass(sound.error()) &&
          FileIdentity::Of(path_) == file)
        damage_ = ToldOf(sound.error());
    }
    changed_.notify_all();
  });
}

/// Another file that lies in place of ours is used if it is a database of ours, else it is set aside.
Status LiveWriter::BeginAnew(const Told& why, bool damaged) {
  checkpointer_ = {};
  for_checkpoints_.reset();
  database_.reset();  // before another file of this name is open: closing may remove what lies beside it
  const bool found = FileIdentity::Of(path_).exists();
  auto opened = damaged || !found ? Result<Database>(tl::unexpected(Error{})) : Database::Open(path_);
  std::string kept;
  if (!opened) {
    auto aside = TRY(SetAside(path_, Seconds(clock_().wall_ns)));
    if (found) kept = aside;
    opened = Database::Open(path_);
  }
  if (!opened) return tl::unexpected(opened.error());
  database_ = std::move(*opened);
  if (const Status begun = BeginRuns(); !begun) {
    database_.reset();
    return begun;
  }
  for_checkpoints_ = Opened(path_);
  file_ = FileIdentity::Of(path_);
  written_ = LastWritten(path_);
  gone_since_ = 0;
  std::lock_guard lock(mutex_);
  damage_ = {};
  checkpointed_ = {};
  ++status_.databases;
  status_.begun_anew =
      kept.empty() ? why
                   : Tell("{}; what was there is kept as {}", "{}; was da war, liegt als {}", why, kept);
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) broken_.insert(static_cast<int>(axis));
  LogError("database_begun_anew", {{"why", status_.begun_anew.english},
                                   {"strokes_in_memory", std::to_string(status_.waiting_strokes)}});
  return {};
}

/// Runs for what waits: their rows do not begin with the first one, so that no replay can check them. Proper
/// ones follow as soon as the pipelines begin theirs (TakeBroken).
Status LiveWriter::BeginRuns() {
  TRY(database_->LeaveCheckpointsToPauses());
  TRY(database_->KeepPagesOf(axes_.size()));
  for (Axis& axis : axes_) {
    axis.machine = TRY(database_->MachineId(axis.name));
    TRY(BeginRun(axis, kBegunAnew));
  }
  return {};
}

Status LiveWriter::Gone() const {
  return InternalError(Tell(
      "{}: the database file is gone: it was deleted, moved or replaced while in use. Nothing is written; put it back, or "
      "another one is begun {} s after it went",
      "{}: die Datei der Datenbank ist weg: sie wurde im Betrieb gelöscht, verschoben oder ersetzt. Nichts wird "
      "geschrieben; legen Sie sie zurück, sonst wird {} s danach eine andere begonnen",
      path_, std::lround(options_.anew_after)));
}

bool LiveWriter::DiskHasRoom() {
  struct statvfs disk {};
  const std::string folder = std::filesystem::absolute(path_).parent_path().string();
  std::int64_t free = options_.min_free;
  if (statvfs(folder.c_str(), &disk) == 0)
    free = static_cast<std::int64_t>(disk.f_bavail) * static_cast<std::int64_t>(disk.f_frsize);
  std::error_code ignored;
  const auto size = std::filesystem::file_size(path_, ignored);
  std::lock_guard lock(mutex_);
  status_.free_bytes = free;
  status_.database_bytes = ignored ? 0 : static_cast<std::int64_t>(size);
  return free >= options_.min_free;
}

/// `ending` of the run's fingerprint.
Status LiveWriter::BeginRun(Axis& axis, const char* ending) {
  const auto version = TRY(VersionFor(*database_, axis.machine,
                                      {1, axis.model->text, axis.model->columns, 0, axis.model->conditions}));
  const auto run = TRY(database_->BeginRun(axis.machine, version, kLiveSource,
                                           fmt::format("live/{}/{}{}", axis.name, clock_().wall_ns, ending)));
  axis.run = run.id;
  axis.strokes = run.strokes;
  return {};
}

/// Ends or begins a run.
Status LiveWriter::Execute(WriteItem& item) {
  Axis& axis = axes_[static_cast<std::size_t>(item.axis)];
  switch (item.kind) {
    case WriteItem::Kind::kStep:
      break;
    case WriteItem::Kind::kEndRun:
      TRY(database_->FinishRun(axis.run, item.summary, item.state));
      break;
    case WriteItem::Kind::kBeginRun: {
      axis.model = item.model;
      TRY(BeginRun(axis, ""));
      break;
    }
  }
  if (acknowledged_) acknowledged_(axis, item);
  return {};
}

void LiveWriter::Count(const WriteItem& item) {
  ++status_.steps;
  status_.rows += item.step.rows;
  status_.strokes += static_cast<std::int64_t>(item.step.strokes.size());
  const std::int64_t now = clock_().monotonic_ns;
  // A sender whose clock runs faster than ours (a simulated press at 15 times its speed) has no latency to tell.
  if (item.sent == 0 || item.sent > now) return;
  const double since_sent = static_cast<double>(now - item.sent) * 1e-9;
  latencies_.Add(since_sent, static_cast<double>(now - item.taken) * 1e-9);
  status_.latency_max = std::max(status_.latency_max, since_sent);
}

bool LiveWriter::Stop(double seconds) {
  {
    std::unique_lock lock(mutex_);
    if (!thread_.joinable()) return items_.empty() && current_.empty();
    checker_.request_stop();
    stopping_ = true;
    changed_.notify_all();
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while ((!items_.empty() || HasCurrent() || !valve_checks_.empty()) &&
           std::chrono::steady_clock::now() < until)
      changed_.wait_for(lock, std::chrono::milliseconds(5));
    give_up_ = true;
  }
  changed_.notify_all();
  thread_.join();
  return items_.empty() && current_.empty();
}

WriterStatus LiveWriter::status() const {
  WriterStatus status;
  StrokeLatencies latencies;  // sorted without the lock, for which strokes wait
  {
    std::lock_guard lock(mutex_);
    status = status_;
    status.waiting_items =
        static_cast<std::int64_t>(items_.size()) + static_cast<std::int64_t>(current_.size());
    latencies = latencies_;
  }
  status.latency_p50 = latencies.SinceSent(0.5);
  status.latency_p99 = latencies.SinceSent(0.99);
  status.commit_p99 = latencies.SincePipeline(0.99);
  return status;
}

std::set<int> LiveWriter::TakeBroken() {
  std::lock_guard lock(mutex_);
  if (status_.state != WriterState::kWriting) return {};  // a new run could not be begun yet
  return std::exchange(broken_, {});
}

std::vector<double> LiveWriter::TakeLatencies() {
  std::lock_guard lock(mutex_);
  return latencies_.TakeSinceSent();
}

void LiveWriter::AddValveCheck(int axis, ValveCheckRecord check) {
  {
    std::lock_guard lock(mutex_);
    valve_checks_.emplace_back(axis, std::move(check));
  }
  changed_.notify_one();
}

}  // namespace hydroscope
