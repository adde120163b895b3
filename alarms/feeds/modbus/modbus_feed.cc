#include <fmt/format.h>

#include <deque>
#include <mutex>

#include "alarms/feeds/feed_context.h"
#include "alarms/feeds/feed_loop.h"
#include "alarms/feeds/list.h"
#include "alarms/feeds/modbus/listener.h"
#include "alarms/feeds/modbus/register_image.h"
#include "alarms/feeds/modbus/register_map.h"
#include "alarms/feeds/modbus/settings.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMostWaiting = 64;  // acknowledgements
const char* const kUser = "modbus";

/// The register map of docs/register_map.md at a Modbus TCP port. One thread takes journal and trends into
/// the registers ten times a second and stores acknowledgements, another one answers clients; a port that is
/// taken is tried again every second.
class ModbusFeed : public Feed {
 public:
  ModbusFeed(ModbusFeedSpec spec, FeedReader reader, Clock clock)
      : spec_(std::move(spec)),
        reader_(std::move(reader)),
        clock_(std::move(clock)),
        loop_(kLookPeriod, [this] { return Round(); }) {}
  ~ModbusFeed() override {
    loop_.Stop();
    listener_.reset();  // while what it answers from is there
  }

  FeedStatus status() const override {
    FeedStatus status;
    status.errors = loop_.errors();
    status.state = loop_.problem();
    std::lock_guard lock(mutex_);
    status.name = fmt::format("modbus {}:{}", spec_.host, listener_ ? listener_->port() : spec_.port);
    status.connected = listener_ != nullptr;
    status.delivered = cursor_;
    status.behind = last_ - cursor_;
    if (!listener_) return status;
    status.registers = image_.Filled();
    const ModbusListener::Counters counters = listener_->counters();
    status.clients = counters.clients;
    status.refused = counters.refused + counters.malformed;
    status.refusal = counters.refusal;
    if (status.state.empty())
      status.state = Tell(
          "open; {} connections taken, {} refused, {} gave way because idle, {} ended as malformed",
          "offen; {} Verbindungen angenommen, {} abgelehnt, {} wichen, weil untätig, {} endeten als fehlerhaft",
          counters.accepted, counters.refused, counters.gave_way, counters.malformed);
    return status;
  }

 private:
  /// Health is shown whatever the journal says, and the heartbeat goes on.
  Status Round() {
    TRY(Open());
    Status done = StoreAcknowledgements();
    auto rows = reader_.Rows(cursor_, register_map::kRingRecords);
    if (!rows) done = tl::unexpected(rows.error());
    const HostTime now = clock_();
    std::vector<AxisPicture> axes;
    const bool news = !rows || !rows->empty() || now.monotonic_ns - pictured_ >= kPicturePeriod;
    if (news) {
      axes = TRY(reader_.Axes());
      pictured_ = now.monotonic_ns;
    }
    std::lock_guard lock(mutex_);
    if (rows)
      for (const JournalRow& row : *rows) Take(row);
    last_ = cursor_;
    const double wall = static_cast<double>(now.wall_ns) * 1e-9;
    // Strokes carry the service's own time, which follows its monotonic clock: so do their ages.
    const double own = static_cast<double>(begun_.wall_ns + now.monotonic_ns - begun_.monotonic_ns) * 1e-9;
    if (news) Show(axes, own);
    counts_.waiting = static_cast<int>(waiting_.size());
    counts_.trouble = reader_.trouble().reason;
    image_.ShowHead(counts_, wall);
    return done;
  }

  /// Once: numbers of the alarms the journal knows, the ring's newest rows, then the port.
  Status Open() {
    if (listener_) return {};
    const auto alarms = TRY(reader_.AlarmsByAppearance());
    const auto last = TRY(reader_.LastSequence());
    auto listener = TRY(ModbusListener::Open(
        spec_, [this](const std::string& client, const auto& answer) { Answer(client, answer); }, clock_));
    std::lock_guard lock(mutex_);
    for (const auto& [machine, alarm] : alarms) numbers_.Add(machine, alarm);
    cursor_ = std::max<std::int64_t>(0, last - register_map::kRingRecords);
    last_ = last;
    listener_ = std::move(listener);
    return {};
  }

  void Take(const JournalRow& row) {
    int number = 0;
    if (!row.event.alarm.empty()) {
      numbers_.Add(row.machine, row.event.alarm);
      number = numbers_.NumberOf(row.machine, row.event.alarm);
      newest_about_.resize(static_cast<std::size_t>(numbers_.size()) + 1);
      newest_about_[number] = row.sequence;
    }
    image_.ShowRow(row, number, reader_.AxisNumber(row.machine));
    cursor_ = row.sequence;
  }

  /// `time`: now, as strokes count it.
  void Show(const std::vector<AxisPicture>& axes, double time) {
    counts_ = {.axes = static_cast<int>(axes.size()), .alarms = numbers_.size()};
    newest_about_.resize(static_cast<std::size_t>(numbers_.size()) + 1);
    int number = 0;
    for (const AxisPicture& axis : axes) {
      image_.ShowAxis(++number, axis, time);
      for (const AlarmState& alarm : axis.alarms) {
        const int of_alarm = numbers_.NumberOf(axis.machine, alarm.id);
        if (of_alarm == 0) continue;
        counts_.standing += StateName(alarm) != register_map::kStateCodes[0];
        counts_.unacknowledged += !alarm.acknowledged;
        image_.ShowAlarm(of_alarm, number, alarm, newest_about_[of_alarm]);
      }
    }
  }

  /// On the listener's thread.
  void Answer(const std::string& client, const std::function<void(const ModbusRegisters&)>& answer) {
    std::lock_guard lock(mutex_);
    answer({image_.registers(),
            [&](int address, std::uint16_t value) { return Write(client, address, value); }});
  }

  std::optional<ModbusException> Write(const std::string& client, int address, std::uint16_t value) {
    if (!spec_.acknowledge || address != register_map::kAcknowledge) return ModbusException::kIllegalAddress;
    if (value == 0 || value > numbers_.size()) return ModbusException::kIllegalValue;
    if (waiting_.size() >= kMostWaiting) return ModbusException::kDeviceBusy;
    waiting_.push_back({value, client});
    image_.ShowAcknowledge(value, register_map::kAsked);
    loop_.Wake();
    return std::nullopt;
  }

  Status StoreAcknowledgements() {
    for (;;) {
      std::unique_lock lock(mutex_);
      if (waiting_.empty()) return {};
      const auto [number, client] = waiting_.front();
      waiting_.pop_front();
      const auto [machine, alarm] = numbers_[number];
      lock.unlock();
      const double wall = static_cast<double>(clock_().wall_ns) * 1e-9;
      const auto changed = reader_.Acknowledge(machine, alarm, {kUser, "from " + client}, wall);
      lock.lock();
      image_.ShowAcknowledge(number, !changed   ? register_map::kNotStored
                                     : *changed ? register_map::kAcknowledged
                                                : register_map::kNothingToAcknowledge);
      if (!changed) return tl::unexpected(changed.error());
    }
  }

  ModbusFeedSpec spec_;
  FeedReader reader_;
  Clock clock_;
  const HostTime begun_ = clock_();
  std::int64_t pictured_ = -kPicturePeriod;  // ns, monotonic, when the axes were looked at
  RegisterImage::Counts counts_;
  std::vector<std::int64_t> newest_about_;  // by number of the alarm

  mutable std::mutex mutex_;  // guards what follows: listener, loop and status come together here
  RegisterImage image_;
  AlarmNumbers numbers_;
  std::deque<std::pair<std::uint16_t, std::string>> waiting_;  // number of the alarm, address of the client
  std::int64_t cursor_ = 0, last_ = 0;
  std::unique_ptr<ModbusListener> listener_;
  FeedLoop loop_;
};

}  // namespace

std::unique_ptr<Feed> MakeModbusFeed(const FeedContext& context) {
  const auto* spec = context.machine.feeds->Of<ModbusFeedSpec>();
  if (spec == nullptr) return nullptr;
  return std::make_unique<ModbusFeed>(*spec, context.Reader(), context.clock);
}

}  // namespace hydroscope
