#include "live/live_service.h"

#include <fmt/ranges.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "core/clock.h"
#include "core/constants.h"
#include "core/told_error.h"
#include "core/units.h"
#include "host/resident_memory.h"
#include "host/text_file.h"
#include "live/burst_memory.h"
#include "live/log.h"
#include "live/process_use.h"
#include "models/model_structure.h"
#include "models/source_kind.h"
#include "monitor/promoted_model.h"
#include "pipeline/run_summary.h"

namespace hydroscope {
namespace {

constexpr double kRound = 0.005;            ///< s the pipeline's thread waits for batches
constexpr double kStatusPeriod = 1.0;       ///< s
constexpr double kStreamPeriod = 0.1;       ///< s within which rows of a stream come
constexpr double kRatePeriod = 2.0;         ///< s
constexpr double kDrainPatience = 10.0;     ///< s
constexpr std::size_t kItemsTogether = 16;  ///< handed to the writer, which works beside the next ones
constexpr int kStepsPerRound = 8;  ///< without a stroke: 2 ms of packing that strokes may have to wait for

constexpr std::chrono::milliseconds kFreshStatus(100);  ///< the pipeline's thread has to tell its state

bool IsLive(const RunInfo& run) { return run.fingerprint.starts_with("live/"); }

/// Machine without what a reload may change.
Machine WithoutLimits(Machine machine) {
  for (SignalSpec& signal : machine.signals) {
    signal.min.reset();
    signal.max.reset();
    signal.noise_std.reset();
    signal.stuck_time = 0;
  }
  machine.monitors.clear();
  machine.description.clear();
  machine.log = {};
  return machine;
}

}  // namespace

struct LiveService::AxisState {
  std::unique_ptr<AxisPipeline> pipeline;
  std::int64_t stored = 0;     ///< ns, when the last step went to the writer
  std::int64_t run_begun = 0;  ///< ns
  bool new_run_wanted = false;
  std::shared_ptr<const LiveModel> model;  ///< its next run goes by; what was promoted is of an axis
};

Result<std::shared_ptr<const LiveModel>> LoadLiveModel(const std::string& path) {
  auto model = std::make_shared<LiveModel>();
  auto text = ReadTextFile(path);
  if (!text)
    return BadInput("{}: cannot be read; give a machine file, for example machines/press_live.toml", path);
  model->text = std::move(*text);
  auto machine = TRY(ParseMachine(model->text, path));
  if (!machine.live)
    return BadInput(
        "{}: there is no [live] section, so nothing tells where live samples come from; "
        "machines/press_live.toml shows one",
        path);
  model->machine = std::move(machine);
  const auto structure = TRY(BuildModel(model->machine));
  model->columns = structure->ColumnNames();
  model->conditions = structure->ConditionNames();
  return std::shared_ptr<const LiveModel>(std::move(model));
}

namespace {

/// `model` with what was promoted for machine `id`; itself if nothing was.
Result<std::shared_ptr<const LiveModel>> WithPromoted(const std::shared_ptr<const LiveModel>& model,
                                                      const Database& database, const std::string& path,
                                                      std::int64_t id) {
  auto promoted = TRY(PromotedFor(database, path, id, model->machine, model->text));
  if (!promoted) return model;
  auto taken = std::make_shared<LiveModel>();
  taken->text = std::move(promoted->text);
  taken->machine = std::move(promoted->machine);
  const auto structure = TRY(BuildModel(taken->machine));
  taken->columns = structure->ColumnNames();
  taken->conditions = structure->ConditionNames();
  return std::shared_ptr<const LiveModel>(std::move(taken));
}

}  // namespace

Status OnlyLimitsDiffer(const Machine& before, const Machine& now) {
  if (WithoutLimits(before) == WithoutLimits(now)) return {};
  return BadInput(
      "more than limits changed (a reload takes over min, max, noise_std and stuck_time of signals, and "
      "monitors); restart the service to take over the rest");
}

LiveService::LiveService(const LiveOptions& options, std::shared_ptr<const LiveModel> model,
                         SourceFactory sources, Clock clock, Heartbeat heartbeat)
    : options_(options),
      first_model_(model),
      model_(std::move(model)),
      source_factory_(std::move(sources)),
      clock_(std::move(clock)),
      heartbeat_(std::move(heartbeat)),
      start_(clock_()),
      inbox_(options.inbox_values),
      aligner_(std::make_unique<Aligner>(first_model_->machine, AlignerOptions::For(first_model_->machine),
                                         start_)),
      live_channels_(LiveChannels(model_->machine)) {
  values_before_.resize(live_channels_.size());
  rates_.resize(live_channels_.size());
}

Result<std::unique_ptr<LiveService>> LiveService::Create(const LiveOptions& options, SourceFactory sources,
                                                         Clock clock, Heartbeat heartbeat,
                                                         LiveWriter::Acknowledged acknowledged) {
  const auto model = TRY(LoadLiveModel(options.machine_file));
  if (const auto older = Database::OlderFormat(options.database))
    LogInfo("database_upgrade", {{"from_format", std::to_string(*older)}});
  auto database = TRY(Database::Open(options.database));
  std::unique_ptr<LiveService> service(
      new LiveService(options, model, std::move(sources), clock, std::move(heartbeat)));
  std::vector<LiveWriter::Axis> axes;
  for (int a = 0; a < AxisCount(model->machine); ++a) {
    std::vector<std::uint8_t> marks;
    auto axis = TRY(service->OpenAxis(database, a, marks));
    const auto promoted = TRY(database.PromotedModel(axis.machine));
    service->promotions_[a] = promoted ? promoted->version : 0;
    axes.push_back(std::move(axis));
    service->aligner_->RestoreMarks(a, marks);
  }
  std::vector<std::string> signals;
  for (const SignalSpec& signal : model->machine.signals) signals.push_back(signal.name);
  service->writer_ =
      std::make_unique<LiveWriter>(std::move(database), options.database, std::move(signals), std::move(axes),
                                   options.writer, clock, std::move(acknowledged));
  return service;
}

/// Ends what a killed service left open and begins a run from the stored state.
Result<LiveWriter::Axis> LiveService::OpenAxis(Database& database, int axis,
                                               std::vector<std::uint8_t>& marks) {
  LiveWriter::Axis opened;
  opened.name = AxisMachineName(model_->machine, axis);
  const auto machine = TRY(database.MachineId(opened.name));
  opened.machine = machine;
  const auto promoted = WithPromoted(model_, database, options_.database, machine);
  if (!promoted) LogError("promoted_model_not_used", {{"axis", opened.name}, {"why", promoted.error().text}});
  opened.model = promoted.value_or(model_);
  auto pipeline = TRY(AxisPipeline::Create(axis, opened.model, packer_));
  const auto newest = TRY(database.NewestRun(machine));
  if (newest && IsLive(newest->run)) {
    marks = newest->sender_marks;
    if (!newest->run.complete) {
      std::vector<std::uint8_t> state = newest->pipeline_state;
      if (state.empty())
        if (const auto before = database.PipelineStateBefore(newest->run.id); before && *before)
          state = **before;
      if (state.empty()) state = pipeline->SaveState();
      RunSummary summary;
      summary.rows = newest->rows_taken;
      summary.stopped = "the service ended without notice; what was acknowledged is stored";
      TRY(database.FinishRun(newest->run.id, FormatRunSummary(summary), state));
      LogWarning("run_recovered", {{"axis", opened.name},
                                   {"run", std::to_string(newest->run.id)},
                                   {"strokes", std::to_string(newest->run.strokes)}});
    }
  }
  const auto version = TRY(VersionFor(
      database, machine, {1, opened.model->text, opened.model->columns, 0, opened.model->conditions}));
  const auto run = TRY(database.BeginRun(machine, version, kLiveSource,
                                         fmt::format("live/{}/{}", opened.name, start_.wall_ns)));
  opened.run = run.id;
  const auto state = TRY(database.PipelineStateBefore(run.id));
  if (state)
    if (const Status restored = pipeline->RestoreState(*state); !restored)
      LogWarning("estimator_starts_anew", {{"axis", opened.name}, {"why", restored.error().text}});
  auto made = std::make_unique<AxisState>();
  made->pipeline = std::move(pipeline);
  made->model = opened.model;
  made->run_begun = made->stored = start_.monotonic_ns;
  axes_.push_back(std::move(made));
  return opened;
}

LiveService::~LiveService() { Stop(); }

Status LiveService::Start() {
  sources_ = source_factory_(model_->machine, clock_);
  UpdateStatus(clock_());
  thread_ = std::thread([this] { Run(); });
  for (std::size_t i = 0; i < sources_.size(); ++i)
    TRY(sources_[i]->Start(
        [this, i](SampleBatch&& batch) { inbox_.Push(static_cast<int>(i), std::move(batch)); }));
  return {};
}

bool LiveService::Stop() {
  if (!thread_.joinable()) return true;
  for (const auto& source : sources_) source->Stop();
  stop_ = true;
  thread_.join();
  return writer_->Stop(options_.patient ? kDrainPatience : 0);
}

void LiveService::Run() {
  FetchMemory(BurstMemory(axes_.size()));
  std::int64_t status_at = 0;
  for (bool last = false; !last;) {
    last = stop_;
    const HostTime now = clock_();
    for (const Inbox::Entry& entry : inbox_.TakeAll(last ? 0 : kRound))
      aligner_->Add(entry.source, entry.batch);
    aligner_->Advance(now.monotonic_ns);
    for (const int axis : writer_->TakeBroken()) axes_[static_cast<std::size_t>(axis)]->new_run_wanted = true;
    {
      std::lock_guard lock(status_mutex_);
      if (reloaded_) model_ = std::exchange(reloaded_, nullptr);
      for (auto& [axis, model] : std::exchange(next_models_, {})) {
        axes_[static_cast<std::size_t>(axis)]->model = std::move(model);
        axes_[static_cast<std::size_t>(axis)]->new_run_wanted = true;
      }
    }
    int steps = kStepsPerRound;
    std::vector<WriteItem> items;
    for (std::size_t a = 0; a < axes_.size(); ++a)
      ProcessAxis(static_cast<int>(a), now.monotonic_ns, steps, items);
    writer_->Push(std::move(items));
    ++heartbeats_;
    if (heartbeat_) heartbeat_();
    if (status_wanted_.exchange(false) || Seconds(now.monotonic_ns - status_at) >= kStatusPeriod) {
      status_at = now.monotonic_ns;
      UpdateStatus(clock_());  // `now` lies before the batches that have just come
    }
  }
  for (std::size_t a = 0; a < axes_.size(); ++a)
    writer_->Push(axes_[a]->pipeline->Finish(aligner_->marks(static_cast<int>(a))));
  UpdateStatus(clock_());  // what is asked from now on hears of the last rows and strokes
}

/// `steps`: how many steps without a stroke may still be stored in this round; `items`: of the round, for the writer.
void LiveService::ProcessAxis(int a, std::int64_t now, int& steps, std::vector<WriteItem>& items) {
  AxisState& axis = *axes_[static_cast<std::size_t>(a)];
  SampleBlock block;
  bool stroke = false;
  while (aligner_->Take(a, block)) {
    if (tap_) tap_(a, block);
    stroke = axis.pipeline->Process(std::move(block)) || stroke;
  }
  // Axes one behind the other: they share transactions, and the pages of the database these touch.
  const auto turn = [&](std::int64_t at) {
    return std::floor(Seconds(at - start_.monotonic_ns) / options_.raw_period);
  };
  const bool due =
      axis.pipeline->pending_rows() > 0 && (turn(now) > turn(axis.stored) || axis.pipeline->StrokeEndsSoon());
  if (stroke || (due && steps-- > 0)) {
    WriteItem item = axis.pipeline->TakeStep(aligner_->marks(a));
    if (stroke) {
      item.taken = clock_().monotonic_ns;
      item.sent = aligner_->NewestSampled(a);
    }
    items.push_back(std::move(item));
    if (items.size() >= kItemsTogether) writer_->Push(std::move(items));
    axis.stored = now;
  }
  const double length = Seconds(now - axis.run_begun);
  const bool pause = stroke || length > 1.5 * options_.run_length || axis.pipeline->run_rows() == 0;
  if (pause && (axis.new_run_wanted || length > options_.run_length)) BeginNewRun(a, items);
}

void LiveService::BeginNewRun(int a, std::vector<WriteItem>& items) {
  AxisState& axis = *axes_[static_cast<std::size_t>(a)];
  axis.new_run_wanted = false;
  axis.run_begun = clock_().monotonic_ns;
  auto begun = axis.pipeline->BeginNewRun(axis.model, aligner_->marks(a));
  if (!begun) {
    LogError("run_goes_on", {{"axis", AxisMachineName(model_->machine, a)}, {"why", begun.error().text}});
    return;
  }
  for (WriteItem& item : *begun) items.push_back(std::move(item));
}

Status LiveService::Reload() {
  const auto told = [this](const Status& result) {
    std::lock_guard lock(status_mutex_);
    status_.limits = result ? Told("taken over", "übernommen") : ToldOf(result.error());
    return result;
  };
  auto model = LoadLiveModel(options_.machine_file);
  if (!model) return told(tl::unexpected(model.error()));
  std::shared_ptr<const LiveModel> present;
  {
    std::lock_guard lock(status_mutex_);
    present = reloaded_ ? reloaded_ : model_;
  }
  if (const Status fits = OnlyLimitsDiffer(present->machine, (*model)->machine); !fits) return told(fits);
  if (present->machine == (*model)->machine) return told({});  // runs go on
  {
    std::lock_guard lock(status_mutex_);
    reloaded_ = std::move(*model);
  }
  if (const auto taken = TakeModels(true); !taken) return told(tl::unexpected(taken.error()));
  return told({});
}

Result<bool> LiveService::TakeModels(bool limits_changed) {
  std::shared_ptr<const LiveModel> present;
  {
    std::lock_guard lock(status_mutex_);
    present = reloaded_ ? reloaded_ : model_;
  }
  auto database = TRY(Database::OpenReadOnly(options_.database));
  bool changed = false;
  for (int a = 0; a < AxisCount(present->machine); ++a) {
    const std::string name = AxisMachineName(present->machine, a);
    const auto id = TRY(database.MachineId(name));
    const auto promoted = TRY(database.PromotedModel(id));
    const int version = promoted ? promoted->version : 0;
    const bool promoted_anew = std::exchange(promotions_[a], version) != version;
    if (!promoted_anew && !limits_changed) continue;
    auto model = WithPromoted(present, database, options_.database, id);
    if (!model) {
      LogError("promoted_model_not_used", {{"axis", name}, {"why", model.error().text}});
      continue;
    }
    if (promoted_anew)
      LogInfo(
          "model_taken_over",
          {{"axis", name}, {"effects", fmt::format("{}", fmt::join((*model)->machine.added_effects, " "))}});
    std::lock_guard lock(status_mutex_);
    next_models_[a] = std::move(*model);
    changed = true;
  }
  return changed;
}

std::vector<ChannelStatus> LiveService::Channels(std::int64_t now) {
  const auto& states = aligner_->channels();
  const double since = Seconds(now - rates_since_);
  if (since >= kRatePeriod) {
    for (std::size_t c = 0; c < states.size(); ++c) {
      rates_[c] = rates_since_ == 0 ? 0 : static_cast<double>(states[c].values - values_before_[c]) / since;
      values_before_[c] = states[c].values;
    }
    rates_since_ = now;
  }
  std::vector<ChannelStatus> channels;
  for (std::size_t c = 0; c < states.size(); ++c) {
    const LiveChannel& live = live_channels_[c];
    const SignalSpec& spec = model_->machine.signals[static_cast<std::size_t>(live.signal)];
    if (!spec.origin) continue;
    const ChannelQuality& seen = axes_[static_cast<std::size_t>(live.axis)]
                                     ->pipeline->channels()[static_cast<std::size_t>(live.signal)];
    ChannelStatus channel;
    channel.name = live.name;
    channel.unit = FindUnit(spec.unit).value_or(Unit{}).si;
    channel.axis = live.axis;
    channel.required = spec.required;
    channel.rate = rates_[c];
    channel.age = states[c].last_received == 0 ? kNaN : Seconds(now - states[c].last_received);
    channel.value = states[c].last_value;
    channel.usable = std::isfinite(channel.value) && channel.value >= spec.min.value_or(channel.value) &&
                     channel.value <= spec.max.value_or(channel.value);
    channel.noise_std = seen.noise_std;
    for (const std::int64_t count : seen.flagged) channel.flagged += count;
    const Delivery delivery = DeliveryOf(model_->machine, spec);
    const double period = delivery.streamed ? kStreamPeriod : delivery.period;
    channel.stale = !(channel.age <= 2 * period);
    channel.senders = aligner_->senders_of(c, now);
    channels.push_back(std::move(channel));
  }
  return channels;
}

std::vector<SenderStatus> LiveService::Senders(std::int64_t now) const {
  std::vector<SenderStatus> senders;
  for (const LiveSender& live : aligner_->senders(now)) {
    SenderStatus sender{.id = live.id,
                        .name = {},
                        .age = Seconds(now - live.heard),
                        .rows = live.rows,
                        .refused_rows = live.refused_rows,
                        .channels = live.taken.size(),
                        .refused = {},
                        .axes = {},
                        .refused_axes = {}};
    for (const std::size_t channel : live.taken) sender.axes.insert(live_channels_[channel].axis);
    for (const std::size_t channel : live.refused) {
      sender.refused.push_back(live_channels_[channel].name);
      sender.refused_axes.insert(live_channels_[channel].axis);
    }
    senders.push_back(std::move(sender));
  }
  return senders;
}

void LiveService::UpdateStatus(HostTime now) {
  LiveStatus status;
  status.machine = model_->machine.name;
  status.counted = CountedWordsOf(model_->machine);
  status.kind = KindOf(model_->machine).id;
  status.database = options_.database;
  status.taken = now.monotonic_ns;
  status.state = stop_ ? "stopping" : "running";
  status.uptime = Seconds(now.monotonic_ns - start_.monotonic_ns);
  status.streams = aligner_->streams();
  status.senders = Senders(now.monotonic_ns);
  status.channels = Channels(now.monotonic_ns);
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const AxisPipeline& pipeline = *axes_[a]->pipeline;
    AxisStatus axis{.name = AxisMachineName(model_->machine, static_cast<int>(a)),
                    .counters = aligner_->counters(static_cast<int>(a)),
                    .strokes = pipeline.strokes(),
                    .last_stroke = kNaN,
                    .estimates = {},
                    .warnings = pipeline.doubts()};
    if (pipeline.strokes() > 0) {
      axis.last_stroke = pipeline.last_stroke().summary.end;
      axis.estimates = pipeline.last_stroke().estimates;
    }
    status.axes.push_back(std::move(axis));
  }
  status.malformed = aligner_->malformed();
  status.heartbeats = heartbeats_;
  std::lock_guard lock(status_mutex_);
  status.limits = std::move(status_.limits);
  status.valve_check = std::move(status_.valve_check);
  status_ = std::move(status);
  status_changed_.notify_all();
}

LiveStatus LiveService::status() const {
  LiveStatus status;
  const std::int64_t asked = clock_().monotonic_ns;
  {
    std::unique_lock lock(status_mutex_);
    status_wanted_ = true;
    status_changed_.wait_for(lock, kFreshStatus, [&] { return status_.taken >= asked; });
    status = status_;
  }
  for (const auto& source : sources_) {
    status.sources.push_back(source->status());
    const std::int64_t last = status.sources.back().last_received.monotonic_ns;
    status.source_ages.push_back(last == 0 ? kNaN : Seconds(clock_().monotonic_ns - last));
  }
  for (SenderStatus& sender : status.senders) {
    const auto& names = status.sources[static_cast<std::size_t>(sender.id.source)].senders;
    const auto name = names.find(sender.id.writer);
    sender.name =
        name != names.end() ? name->second : status.sources[static_cast<std::size_t>(sender.id.source)].name;
  }
  status.inbox = inbox_.counters();
  status.writer = writer_->status();
  const ProcessUse use = UseOf("self");
  status.cpu = use.cpu;
  status.memory = use.memory;
  status.descriptors = use.descriptors;
  return status;
}

}  // namespace hydroscope
