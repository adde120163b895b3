#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <fstream>
#include <map>
#include <mutex>
#include <set>

#include "alarms/feeds/feed_context.h"
#include "alarms/feeds/feed_loop.h"
#include "alarms/feeds/list.h"
#include "alarms/feeds/sparkplug/mqtt_connection.h"
#include "alarms/feeds/sparkplug/payload.h"
#include "alarms/feeds/sparkplug/primary_host.h"
#include "alarms/feeds/sparkplug/settings.h"
#include "core/secret_file.h"
#include "storage/outbox.h"

namespace hydroscope {
namespace {

/// Connections that the broker takes and soon ends, one after the other: another client has the same name, or may not do what
/// it does. From the third on the next one waits, and counts as one only when it has stood for a while. Times in ns, monotonic.
class ShortConnections {
 public:
  void Begun(std::int64_t now) { begun_ = now; }
  /// By the broker, not by us.
  void Ended(std::int64_t now) {
    ended_ = now;
    in_a_row_ = now - begun_ < kShort ? in_a_row_ + 1 : 0;
  }
  bool are_a_habit() const { return in_a_row_ >= kHabit; }
  bool MayBegin(std::int64_t now) const {
    return !are_a_habit() || now - ended_ >= std::min(in_a_row_ * kSecond, kLongestPause);
  }
  /// Whether the connection that stands may be told of.
  bool Stands(std::int64_t now) const { return !are_a_habit() || now - begun_ >= kProof; }

 private:
  static constexpr std::int64_t kSecond = 1'000'000'000;
  static constexpr std::int64_t kShort = 60 * kSecond, kLongestPause = 10 * kSecond, kProof = 3 * kSecond;
  static constexpr std::int64_t kHabit = 3;

  std::int64_t begun_ = 0, ended_ = 0, in_a_row_ = 0;
};

constexpr std::int64_t kJournalRowsAtOnce = 1000;
constexpr std::int64_t kMostInOutbox = 20'000;          // items in the outbox; the journal keeps the rest
constexpr std::int64_t kRebirthPeriod = 5'000'000'000;  // ns between births because somebody asked for them
constexpr std::int64_t kMostUnacknowledged = 400;       // messages the broker has not acknowledged

Result<std::string> FirstLine(const std::string& path) {
  std::string line;
  if (path.empty()) return line;
  TRY(CheckSecret(path, "[feeds.sparkplug] password_file"));
  std::ifstream file(path);
  if (!std::getline(file, line))
    return BadInput("[feeds.sparkplug] password_file = \"{}\" cannot be read, or is empty", path);
  return line;
}

/// What the births of a device have announced, and what its data said last.
struct Announced {
  std::set<std::string> alarms, parameters;
  std::int64_t strokes = 0;
  Health health;
};

/// An MQTT Sparkplug B 3.0 edge node (docs/sparkplug.md): the node is the machine, each axis a device. Rows
/// of the journal go through the outbox at `outbox_path` and leave it when the broker has acknowledged them;
/// state and parameters are told as they are now.
class SparkplugFeed : public Feed {
 public:
  SparkplugFeed(SparkplugFeedSpec spec, FeedReader reader, std::string outbox_path, Clock clock)
      : spec_(std::move(spec)),
        reader_(std::move(reader)),
        outbox_path_(std::move(outbox_path)),
        clock_(std::move(clock)),
        group_(sparkplug::TopicPart(spec_.group)),
        node_(sparkplug::TopicPart(spec_.node)),
        host_(spec_.primary_host),
        loop_(kLookPeriod, [this] { return Round(); }) {}
  ~SparkplugFeed() override {
    loop_.Stop();
    Disconnect();  // while what its callbacks use is there
  }

  FeedStatus status() const override {
    std::lock_guard lock(mutex_);
    FeedStatus status = status_;
    status.errors = loop_.errors();
    status.name = fmt::format("sparkplug {} {}/{}", spec_.broker, group_, node_);
    if (const Told problem = loop_.problem(); !problem.empty()) status.state = problem;
    return status;
  }

 private:
  Status Round() {
    if (const Status done = RoundSteps(); !done) {
      DropConnection();
      Report(false);
      return done;
    }
    Report(born_ && short_.Stands(Now()));
    return std::exchange(stored_, {});
  }

  /// Errors of the connection. What journal and outbox refuse is kept for the end of the round: health is
  /// told all the same.
  Status RoundSteps() {
    stored_ = Fill();
    if (!connection_ || !connection_->IsConnected()) {
      DropConnection();
      if (!short_.MayBegin(Now())) return {};
      TRY(Connect());
    }
    TakeHostState();
    if (!host_.online()) {
      if (born_) Disconnect();  // nobody hears us: what happens now waits in the outbox
      return {};
    }
    if (!born_) TRY(BeginSession());
    if (const std::int64_t now = Now(); rebirth_ && now - reborn_ >= kRebirthPeriod) {
      rebirth_ = false;
      reborn_ = now;
      TRY(Births());
    }
    TRY(TellAxes());
    TRY(SendItems());
    if (const Status removed = RemoveAcknowledged(); !removed) stored_ = removed;
    return {};
  }

  /// Journal -> outbox, with or without a broker.
  Status Fill() {
    if (!outbox_) {
      outbox_ = TRY(Outbox::Open(outbox_path_));
    }
    const auto cursor = TRY(outbox_->Cursor());
    const auto waiting = TRY(outbox_->Count());
    cursor_ = cursor;
    if (waiting >= kMostInOutbox) return {};
    const auto rows = TRY(reader_.Rows(cursor_, kJournalRowsAtOnce));
    if (rows.empty()) return {};
    std::vector<OutboxItem> items;
    for (const JournalRow& row : rows)
      if (const int axis = reader_.AxisNumber(row.machine); axis > 0) {
        items.push_back({row.sequence, DeviceTopic("DDATA", row.machine), sparkplug::Event(row)});
        if (!row.event.alarm.empty()) spoken_of_[row.machine].insert(row.event.alarm);
      }
    cursor_ = rows.back().sequence;
    return outbox_->Put(items, cursor_);
  }

  Status Connect() {
    if (!outbox_) return InternalError("{}: the outbox could not be opened", outbox_path_);
    const auto password = TRY(FirstLine(spec_.password_file));
    birth_death_ = TRY(outbox_->NextBirth());
    host_.Forget();
    {
      std::lock_guard lock(mutex_);
      acknowledged_.clear();
      host_states_.clear();
    }
    connection_ = TRY(MqttConnection::Open(
        {.broker = spec_.broker,
         .client_id = ClientId(),
         .user = spec_.user,
         .password = password,
         .will = Death(),
         .certificates = {.ca = spec_.ca_file, .certificate = spec_.certificate_file, .key = spec_.key_file}},
        {.acknowledged = [this](std::int64_t id) { Acknowledged(id); },
         .arrived = [this](MqttMessage message) { Arrived(message); },
         .lost = [this](const std::string& why) { Lost(why); }}));
    short_.Begun(Now());
    TRY(connection_->Subscribe(NodeTopic("NCMD")));
    return host_.is_waited_for() ? connection_->Subscribe(host_.Topic()) : Status{};
  }

  /// One that is over, or that failed; the next one begins with births.
  void DropConnection() {
    if (connection_) short_.Ended(Now());
    connection_.reset();
    born_ = false;
  }

  /// The end of the node's session as Sparkplug wants it: its death, then the connection.
  void Disconnect() {
    if (born_ && connection_ && connection_->IsConnected()) static_cast<void>(connection_->Publish(Death()));
    connection_.reset();
    born_ = false;
  }

  /// What the primary host has said since; one that began another session is told everything anew.
  void TakeHostState() {
    std::vector<std::string> states;
    {
      std::lock_guard lock(mutex_);
      states.swap(host_states_);
    }
    for (const std::string& state : states) {
      const std::int64_t session = host_.session();
      if (host_.Take(state) && born_ && session != host_.session()) rebirth_ = true;
    }
  }

  /// From here on somebody listens.
  Status BeginSession() {
    historical_up_to_ = cursor_;  // what was put before could not be told when it happened
    sent_ = 0;
    in_flight_ = 0;
    rebirth_ = false;
    born_ = true;
    return Births();
  }

  Status Births() {
    auto axes = TRY(reader_.Axes());
    const double wall = Wall();
    sequence_ = 0;
    TRY(Send(NodeTopic("NBIRTH"), sparkplug::NodeBirth(birth_death_, wall)));
    for (const AxisPicture& axis : axes) TRY(BirthOf(axis, wall));
    return {};
  }

  Status BirthOf(const AxisPicture& axis, double wall) {
    Announced& announced = announced_[axis.machine];
    announced = {.alarms = {}, .parameters = {}, .strokes = axis.strokes, .health = axis.health};
    for (const AlarmState& alarm : axis.alarms) announced.alarms.insert(alarm.id);
    for (const TrendPoint& point : axis.estimates) announced.parameters.insert(point.estimate.parameter);
    return Send(DeviceTopic("DBIRTH", axis.machine), sparkplug::DeviceBirth(axis, wall));
  }

  /// Tells axes that changed; one that has something its birth did not announce is born again.
  Status TellAxes() {
    const std::int64_t now = Now();
    const bool news = std::ranges::any_of(spoken_of_, [&](const auto& axis) {
      const auto& known = announced_[axis.first].alarms;
      return !std::includes(known.begin(), known.end(), axis.second.begin(), axis.second.end());
    });
    if (!news && now - pictured_ < kPicturePeriod) return {};
    pictured_ = now;
    const auto axes = TRY(reader_.Axes());
    for (const AxisPicture& axis : axes) {
      Announced& announced = announced_[axis.machine];
      const auto& spoken = spoken_of_[axis.machine];
      const bool unknown =
          std::ranges::any_of(
              axis.estimates,
              [&](const TrendPoint& p) { return !announced.parameters.contains(p.estimate.parameter); }) ||
          !std::includes(announced.alarms.begin(), announced.alarms.end(), spoken.begin(), spoken.end());
      if (unknown) {
        TRY(BirthOf(axis, Wall()));
      } else if (axis.strokes != announced.strokes || axis.health != announced.health) {
        announced.strokes = axis.strokes;
        announced.health = axis.health;
        TRY(Send(DeviceTopic("DDATA", axis.machine), sparkplug::DeviceData(axis, Wall())));
      }
    }
    return {};
  }

  /// Outbox -> broker in the order of the journal.
  Status SendItems() {
    if (in_flight_ >= kMostUnacknowledged) return {};
    const auto items = TRY(outbox_->Items(sent_, kMostUnacknowledged - in_flight_));
    for (const OutboxItem& item : items) {
      const bool historical = item.sequence <= historical_up_to_;
      TRY(Send(item.topic, item.payload, historical, item.sequence));
      sent_ = item.sequence;
      ++in_flight_;
    }
    return {};
  }

  Status RemoveAcknowledged() {
    std::vector<std::int64_t> taken;
    {
      std::lock_guard lock(mutex_);
      taken.swap(acknowledged_);
    }
    if (taken.empty()) return {};
    if (const Status removed = outbox_->Remove(taken); !removed) {
      std::lock_guard lock(mutex_);
      acknowledged_.insert(acknowledged_.begin(), taken.begin(), taken.end());
      return removed;
    }
    in_flight_ -= static_cast<std::int64_t>(taken.size());
    loop_.Wake();  // there is room for more
    return {};
  }

  /// `id` > 0: until the broker acknowledges it.
  Status Send(const std::string& topic, const std::string& payload, bool historical = false,
              std::int64_t id = 0) {
    const auto sealed = sparkplug::Sealed(payload, sequence_, historical);
    if (!sealed) return InternalError("{}: item {} is no Sparkplug payload", outbox_path_, id);
    ++sequence_;
    return connection_->Publish({topic, *sealed, id > 0 ? 1 : 0}, id);
  }

  void Report(bool heard) {
    std::int64_t first = 0, count = 0;
    if (outbox_) {
      if (const auto waiting = outbox_->Count()) count = *waiting;
      if (const auto items = outbox_->Items(0, 1); items && !items->empty()) first = items->front().sequence;
    }
    const auto last = reader_.LastSequence();
    std::lock_guard lock(mutex_);
    status_.connected = heard;
    status_.state = Tell("{} rows wait in the outbox", "{} Zeilen warten im Ausgang", count);
    if (heard) lost_ = {};
    if (!heard && short_.are_a_habit())
      lost_ = Tell(
          "the MQTT broker {} ends each connection soon after it began; does another client call itself {}, or does it not "
          "let this one publish or subscribe?",
          "der MQTT-Broker {} beendet jede Verbindung, kaum dass sie steht; nennt sich ein anderer Client {}, oder darf "
          "dieser hier nicht senden oder abonnieren?",
          spec_.broker, ClientId());
    if (!lost_.empty()) status_.state = Tell("{}; {}", "{}; {}", lost_, status_.state);
    if (!host_.online())
      status_.state = Tell("the primary host {} is offline; {}", "der Leitrechner {} ist nicht verbunden; {}",
                           host_.id(), status_.state);
    status_.delivered = first > 0 ? first - 1 : cursor_;
    status_.behind = count + (last ? *last - cursor_ : 0);
  }

  /// On the library's thread.
  void Acknowledged(std::int64_t id) {
    {
      std::lock_guard lock(mutex_);
      acknowledged_.push_back(id);
    }
    loop_.Wake();
  }
  void Lost(const std::string& why) {
    {
      std::lock_guard lock(mutex_);
      lost_ = why.empty() ? Told("the broker closed the connection or fell silent",
                                 "der Broker schloss die Verbindung oder verstummte")
                          : Told(why);
    }
    loop_.Wake();
  }
  void Arrived(const MqttMessage& message) {
    if (message.topic == host_.Topic()) {
      std::lock_guard lock(mutex_);
      host_states_.push_back(message.payload);
    } else if (message.topic == NodeTopic("NCMD") && sparkplug::AsksForRebirth(message.payload)) {
      rebirth_ = true;
    } else {
      return;
    }
    loop_.Wake();
  }

  MqttMessage Death() const { return {NodeTopic("NDEATH"), sparkplug::NodeDeath(birth_death_), 1}; }
  std::string NodeTopic(const char* kind) const {
    return fmt::format("spBv1.0/{}/{}/{}", group_, kind, node_);
  }
  std::string DeviceTopic(const char* kind, const std::string& machine) const {
    return fmt::format("{}/{}", NodeTopic(kind),
                       sparkplug::TopicPart(machine.substr(machine.rfind('/') + 1)));
  }
  std::string ClientId() const { return fmt::format("hydroscope-{}-{}", group_, node_); }
  std::int64_t Now() const { return clock_().monotonic_ns; }
  double Wall() const { return static_cast<double>(clock_().wall_ns) * 1e-9; }

  SparkplugFeedSpec spec_;
  FeedReader reader_;
  std::string outbox_path_;
  Clock clock_;
  std::string group_, node_;

  std::optional<Outbox> outbox_;
  std::int64_t cursor_ = 0;
  std::map<std::string, std::set<std::string>> spoken_of_;  // alarms of rows put by this life, by machine
  std::map<std::string, Announced> announced_;              // by machine
  std::uint8_t birth_death_ = 0, sequence_ = 0;
  std::int64_t historical_up_to_ = 0, sent_ = 0, in_flight_ = 0;
  std::int64_t pictured_ = 0;              // ns, monotonic
  std::int64_t reborn_ = -kRebirthPeriod;  // ns, monotonic, last births that somebody asked for
  std::unique_ptr<MqttConnection> connection_;
  ShortConnections short_;

  sparkplug::PrimaryHost host_;
  bool born_ = false;  // in this connection
  Status stored_;      // of this round: what journal or outbox refused

  std::atomic<bool> rebirth_ = false;
  mutable std::mutex mutex_;              // guards what follows
  Told lost_;                             // why the last connection ended; "" while there is one
  std::vector<std::string> host_states_;  // arrived, not yet taken
  std::vector<std::int64_t> acknowledged_;
  FeedStatus status_;
  FeedLoop loop_;
};

}  // namespace

std::unique_ptr<Feed> MakeSparkplugFeed(const FeedContext& context) {
  const auto* asked = context.machine.feeds->Of<SparkplugFeedSpec>();
  if (asked == nullptr) return nullptr;
  SparkplugFeedSpec spec = *asked;
  if (spec.node.empty()) spec.node = context.machine.name;
  return std::make_unique<SparkplugFeed>(std::move(spec), context.Reader(), Outbox::PathFor(context.database),
                                         context.clock);
}

}  // namespace hydroscope
