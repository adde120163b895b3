#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "acquisition/aligner.h"
#include "acquisition/source.h"
#include "live/axis_pipeline.h"
#include "live/inbox.h"
#include "live/live_status.h"
#include "live/writer.h"

namespace hydroscope {

struct LiveOptions {
  std::string machine_file;
  std::string database;
  WriterOptions writer;
  std::int64_t inbox_values = 4'000'000;  ///< values that may wait for the pipeline: 32 MB
  double raw_period = 1.0;                ///< s between two stored pieces of raw rows
  double run_length = 3600.0;             ///< s after which a run ends at the next pause between strokes
  bool patient = true;                    ///< a stopped service writes for up to 10 s what waits
};

/// The monitoring service without its surroundings (signals, ports, systemd): sources -> inbox -> aligner ->
/// quality monitor -> pipeline -> writer, all axes of one machine file, which become the machines "name/axis"
/// of the database.
class LiveService {
 public:
  using SourceFactory = std::function<std::vector<std::unique_ptr<Source>>(const Machine&, const Clock&)>;
  /// What the pipeline's thread does once per round, at least 100 times a second: feeds the watchdog.
  using Heartbeat = std::function<void()>;

  /// Reads the machine file, opens the database, ends runs a killed service left open and begins new ones
  /// from the stored states. Errors: machine file, database.
  static Result<std::unique_ptr<LiveService>> Create(const LiveOptions& options, SourceFactory sources,
                                                     Clock clock, Heartbeat heartbeat = {},
                                                     LiveWriter::Acknowledged acknowledged = {});
  ~LiveService();

  /// Starts the threads. Errors: a source whose settings can never work.
  Status Start();
  /// Ends sources, pipelines (their last strokes and states are stored) and writer. False: something could
  /// not be written in time.
  bool Stop();

  /// Reads the machine file again and takes over limits (min, max, stuck_time, monitors); each axis begins a
  /// new run from its present state. Errors: file bad, or something else than limits changed; then all stays.
  Status Reload();
  /// Looks whether another model was promoted for an axis since (`model promote`, or the page): the axis goes by it from its
  /// next pause between strokes on, in a run of its own. True: there was one. Errors: the database cannot be read. To be called
  /// by the thread that calls Reload.
  Result<bool> TakePromotions() { return TakeModels(false); }
  LiveStatus status() const;
  std::vector<double> TakeLatencies() { return writer_->TakeLatencies(); }
  const Machine& machine() const { return first_model_->machine; }

  /// Sees every block of an axis before the pipeline; for valve checks and `check --live`. Set before Start.
  using Tap = std::function<void(int axis, const SampleBlock&)>;
  void set_tap(Tap tap) { tap_ = std::move(tap); }
  void AddValveCheck(int axis, ValveCheckRecord check) { writer_->AddValveCheck(axis, std::move(check)); }

 private:
  LiveService(const LiveOptions& options, std::shared_ptr<const LiveModel> model, SourceFactory sources,
              Clock clock, Heartbeat heartbeat);
  /// Of axes with another model than before, or of all if limits changed; false if there is none.
  Result<bool> TakeModels(bool limits_changed);
  Result<LiveWriter::Axis> OpenAxis(Database& database, int axis, std::vector<std::uint8_t>& marks);
  void Run();
  void ProcessAxis(int axis, std::int64_t now, int& steps, std::vector<WriteItem>& items);
  void BeginNewRun(int axis, std::vector<WriteItem>& items);
  void UpdateStatus(HostTime now);
  std::vector<ChannelStatus> Channels(std::int64_t now);
  std::vector<SenderStatus> Senders(std::int64_t now) const;

  LiveOptions options_;
  const std::shared_ptr<const LiveModel> first_model_;  ///< the aligner refers to it
  std::shared_ptr<const LiveModel> model_;              ///< in force
  SourceFactory source_factory_;
  Clock clock_;
  Heartbeat heartbeat_;
  Tap tap_;
  HostTime start_;
  Inbox inbox_;
  std::unique_ptr<Aligner> aligner_;
  struct AxisState;
  ColumnPacker packer_;  // of all axes
  std::vector<std::unique_ptr<AxisState>> axes_;
  std::unique_ptr<LiveWriter> writer_;
  std::vector<std::unique_ptr<Source>> sources_;
  std::vector<LiveChannel> live_channels_;
  std::vector<std::int64_t> values_before_;
  std::int64_t rates_since_ = 0;
  std::vector<double> rates_;
  mutable std::mutex status_mutex_;
  mutable std::condition_variable status_changed_;
  mutable std::atomic<bool> status_wanted_{false};
  LiveStatus status_;
  std::shared_ptr<const LiveModel> reloaded_;                    ///< waits for the pipeline's thread
  std::map<int, std::shared_ptr<const LiveModel>> next_models_;  ///< by axis: so do these
  std::map<int, int> promotions_;  ///< by axis: version promoted last that was looked at
  std::atomic<bool> stop_{false};
  std::int64_t heartbeats_ = 0;
  std::thread thread_;
};

/// Machine file with a live section, as the service needs it. Errors: no such section, no balance.
Result<std::shared_ptr<const LiveModel>> LoadLiveModel(const std::string& path);
/// `now` with other limits and nothing else; an error names what else changed.
Status OnlyLimitsDiffer(const Machine& before, const Machine& now);

}  // namespace hydroscope
