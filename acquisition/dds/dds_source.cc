#include "acquisition/dds/dds_source.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <mutex>
#include <thread>

#include "acquisition/batch_assembler.h"
#include "acquisition/dds/messages.h"
#include "acquisition/list.h"
#include "dds/participant.h"
#include "models/ipv4_range.h"

namespace hydroscope {
namespace {

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

constexpr double kLongestDeaf = 60;  // s between two rebuilds
constexpr std::size_t kSendersKept = 64;

/// What the library's threads and the watchdog share.
class Receiver {
 public:
  Receiver(const DdsSourceOptions& options, Clock clock, Source::Sink sink)
      : assembler_(options.wanted), clock_(std::move(clock)), sink_(std::move(sink)) {
    for (const std::string& range : options.spec.senders)
      if (const auto parsed = ParseIpv4Range(range)) allowed_.push_back(*parsed);
  }

  void Take(DataReader& reader, hydroscope_wire::Layout& buffer) {
    SampleInfo info;
    std::lock_guard lock(mutex_);
    while (reader.take_next_sample(&buffer, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data || !MaySend(info)) continue;
      LayoutMessage message = ToMessage(buffer);
      message.writer = DdsPeerId(info);
      assembler_.Receive(message, sink_);
    }
  }
  void Take(DataReader& reader, hydroscope_wire::Batch& buffer) {
    SampleInfo info;
    std::lock_guard lock(mutex_);
    while (reader.take_next_sample(&buffer, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data || !MaySend(info)) continue;
      late_ = false;
      BatchMessage message = ToMessage(std::move(buffer));
      message.writer = DdsPeerId(info);
      assembler_.Receive(std::move(message), clock_(), sink_);
    }
  }
  void Matched(int senders) {
    std::lock_guard lock(mutex_);
    matched_ = senders;
  }
  void Alive(int senders) {
    std::lock_guard lock(mutex_);
    alive_ = senders;
  }
  void Late() {
    std::lock_guard lock(mutex_);
    late_ = true;
  }
  void Incompatible() {
    std::lock_guard lock(mutex_);
    incompatible_ = true;
  }
  /// `participant`: what the readers belong to; nullptr while there is none.
  void BeginAnew(const DdsParticipant* participant) {
    std::lock_guard lock(mutex_);
    matched_ = alive_ = 0;
    incompatible_ = false;
    problem_.clear();
    participant_ = participant;
    senders_.clear();
  }
  void CannotListen(const std::string& why) {
    std::lock_guard lock(mutex_);
    problem_ = why;
  }
  void WithoutSharedMemory(const std::string& why) {
    std::lock_guard lock(mutex_);
    without_shared_memory_ = why;
  }
  SourceStatus status() const {
    std::lock_guard lock(mutex_);
    SourceStatus status = assembler_.counters();
    status.connected = matched_ > 0 && alive_ > 0;
    status.state = Describe();
    status.refused = refused_;
    for (const auto& [id, sender] : senders_) status.senders[id] = sender.name;
    return status;
  }

 private:
  struct Sender {
    std::string name;  ///< "simulated press at 192.168.0.7"
    bool allowed = true;
  };

  /// Notes who sent the message; false if it comes from a computer that may not.
  bool MaySend(const SampleInfo& info) {
    const std::uint64_t id = DdsPeerId(info);
    auto sender = senders_.find(id);
    if (sender == senders_.end()) {
      const auto peer = participant_ ? participant_->peer(id) : std::nullopt;
      if (!peer) return allowed_.empty();  // it is going, or we are
      if (senders_.size() == kSendersKept) senders_.erase(senders_.begin());
      const std::string address = peer->address.empty() ? "this computer" : peer->address;
      sender =
          senders_.emplace(id, Sender{fmt::format("\"{}\" at {}", peer->name, address), IsAllowed(*peer)})
              .first;
    }
    refused_ += !sender->second.allowed;
    if (!sender->second.allowed) refused_sender_ = sender->second.name;
    return sender->second.allowed;
  }
  /// One that announces no address can only be reached by shared memory.
  bool IsAllowed(const DdsPeer& peer) const {
    in_addr address{};
    inet_pton(AF_INET, peer.address.empty() ? "127.0.0.1" : peer.address.c_str(), &address);
    return allowed_.empty() || std::any_of(allowed_.begin(), allowed_.end(), [&](const Ipv4Range& range) {
             return range.Contains(ntohl(address.s_addr));
           });
  }

  Told Describe() const {
    if (!problem_.empty()) return {problem_};
    if (incompatible_)
      return {
          "a sender offers another quality of service; it must be reliable with a deadline of 0.1 s",
          "ein Sender bietet eine andere Dienstgüte an; sie muss zuverlässig sein, mit einer Frist von 0,1 s"};
    if (matched_ == 0)
      return {"waiting for a sender; check domain, topic and interfaces if one is running",
              "wartet auf einen Sender; läuft einer, sind Domäne, Thema und Netzanschlüsse zu prüfen"};
    if (alive_ == 0)
      return {"the sender stopped giving signs of life", "der Sender gibt kein Lebenszeichen mehr"};
    if (senders_.empty() || std::none_of(senders_.begin(), senders_.end(),
                                         [](const auto& sender) { return sender.second.allowed; }))
      if (refused_ > 0)
        return Tell("{} sends, and is not among [live.dds] senders",
                    "{} sendet und steht nicht unter [live.dds] senders", refused_sender_);
    if (!assembler_.complaint().empty()) return {assembler_.complaint()};
    if (late_)
      return {"the sender is there but sends no batches in time",
              "der Sender ist da, schickt aber nicht rechtzeitig"};
    const std::string& without = participant_ && without_shared_memory_.empty()
                                     ? participant_->without_shared_memory()
                                     : without_shared_memory_;
    return without.empty() ? Told("receiving", "empfängt")
                           : Tell("receiving by UDP: {}", "empfängt über UDP: {}", without);
  }

  mutable std::mutex mutex_;
  BatchAssembler assembler_;
  Clock clock_;
  Source::Sink sink_;
  int matched_ = 0, alive_ = 0;
  bool late_ = false, incompatible_ = false;
  std::string problem_;                ///< why there is no reader at all
  std::string without_shared_memory_;  ///< why no shared memory, as the watchdog found
  const DdsParticipant* participant_ = nullptr;
  std::vector<Ipv4Range> allowed_;  ///< empty: all
  std::map<std::uint64_t, Sender> senders_;
  std::int64_t refused_ = 0;
  std::string refused_sender_;  ///< the last one
};

/// Hands what arrives at one reader to the receiver.
template <typename Message>
class Listener : public DataReaderListener {
 public:
  explicit Listener(Receiver& receiver) : receiver_(receiver) {}
  void on_data_available(DataReader* reader) override { receiver_.Take(*reader, buffer_); }

 protected:
  Receiver& receiver_;

 private:
  Message buffer_;
};

class BatchListener : public Listener<hydroscope_wire::Batch> {
 public:
  using Listener::Listener;
  void on_subscription_matched(DataReader*, const SubscriptionMatchedStatus& s) override {
    receiver_.Matched(s.current_count);
  }
  void on_liveliness_changed(DataReader*, const LivelinessChangedStatus& s) override {
    receiver_.Alive(s.alive_count);
  }
  void on_requested_deadline_missed(DataReader*, const RequestedDeadlineMissedStatus&) override {
    receiver_.Late();
  }
  void on_requested_incompatible_qos(DataReader*, const RequestedIncompatibleQosStatus&) override {
    receiver_.Incompatible();
  }
};

/// Participant and readers; everything that the watchdog throws away and builds anew.
class Subscription {
 public:
  static Result<std::unique_ptr<Subscription>> Create(const DdsSpec& spec, bool shared_memory,
                                                      Receiver& receiver) {
    DdsNetwork network = NetworkOf(spec);
    network.shared_memory = network.shared_memory && shared_memory;
    auto participant = TRY(DdsParticipant::Create(network, "hydroscope"));
    receiver.BeginAnew(participant.get());
    auto made = std::unique_ptr<Subscription>(new Subscription(std::move(participant), receiver));
    TRY(made->Open(spec));
    return made;
  }

 private:
  Subscription(std::unique_ptr<DdsParticipant> participant, Receiver& receiver)
      : layouts_(receiver), batches_(receiver), participant_(std::move(participant)) {}

  Status Open(const DdsSpec& spec) {
    const auto layouts = TRY(participant_->MakeTopic(
        LayoutTopic(spec.topic), TypeSupport(new Tolerant<hydroscope_wire::LayoutPubSubType>())));
    const auto samples = TRY(
        participant_->MakeTopic(spec.topic, TypeSupport(new Tolerant<hydroscope_wire::BatchPubSubType>())));
    Subscriber* subscriber = participant_->get()->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
    if (subscriber == nullptr ||
        subscriber->create_datareader(layouts, LayoutReaderQos(), &layouts_) == nullptr ||
        subscriber->create_datareader(samples, SampleReaderQos(spec.deadline, spec.backlog), &batches_) ==
            nullptr)
      return InternalError("DDS gives no reader for topic {}", spec.topic);
    return {};
  }

  Listener<hydroscope_wire::Layout> layouts_;
  BatchListener batches_;
  std::unique_ptr<DdsParticipant> participant_;  // deleted first: afterwards no listener is called
};

class DdsSource : public Source {
 public:
  DdsSource(DdsSourceOptions options, Clock clock) : options_(std::move(options)), clock_(std::move(clock)) {}
  ~DdsSource() override { Stop(); }

  Status Start(Sink sink) override {
    receiver_ = std::make_unique<Receiver>(options_, clock_, std::move(sink));
    auto subscription = Subscription::Create(options_.spec, shared_memory_, *receiver_);
    if (!subscription && subscription.error().kind == ErrorKind::kBadInput)
      return tl::unexpected(subscription.error());
    if (subscription)
      subscription_ = std::move(*subscription);
    else
      receiver_->CannotListen(subscription.error().text);  // a port that is taken may be free soon
    watchdog_ = std::jthread([this](std::stop_token stop) { Watch(stop); });
    return {};
  }

  SourceStatus status() const override {
    SourceStatus status;
    if (receiver_) status = receiver_->status();
    status.name = "dds " + options_.spec.topic;
    status.reconnects = reconnects_;
    return status;
  }

  void Stop() override {
    watchdog_ = {};  // asks it to stop and waits
    End();
  }

 private:
  /// Nothing came for the time that is allowed: whatever the library believes, begin anew. Where a sender was
  /// there all the same, its shared memory may be out of reach (another user's, another container's): then by
  /// UDP alone.
  void Watch(const std::stop_token& stop) {
    const double step = options_.deaf_after;
    double patience = step, silent = 0;
    bool there = false;  // somebody, since the last time
    SourceStatus seen = receiver_->status();
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, stop, std::chrono::duration<double>(step), [] { return false; })) {
      if (stop.stop_requested()) return;
      const SourceStatus now = receiver_->status();
      const bool heard = now.batches != seen.batches, found = now.connected && !seen.connected;
      seen = now;
      there = there || now.connected || heard;
      silent = heard || found ? 0 : silent + step;
      if (heard || found) patience = step;
      if (silent < patience) continue;
      patience = std::min(2 * patience, std::max(kLongestDeaf, step));
      silent = 0;
      if (now.connected && options_.spec.transport == DdsTransport::kDefault && shared_memory_) {
        shared_memory_ = false;
        receiver_->WithoutSharedMemory("a sender was there, but nothing came from it by shared memory");
      }
      Rebuild();
      reconnects_ += there;  // where nobody was there is nothing to connect again
      there = seen.connected = false;
    }
  }

  void End() {
    if (receiver_) receiver_->BeginAnew(nullptr);  // before its participant goes
    subscription_.reset();
  }

  void Rebuild() {
    End();
    // A refusal (network card gone) is tried again after the next, longer patience.
    auto subscription = Subscription::Create(options_.spec, shared_memory_, *receiver_);
    if (subscription)
      subscription_ = std::move(*subscription);
    else
      receiver_->CannotListen(subscription.error().text);
  }

  DdsSourceOptions options_;
  Clock clock_;
  std::unique_ptr<Receiver> receiver_;
  std::unique_ptr<Subscription> subscription_;
  bool shared_memory_ = true;  ///< nothing says yet that it cannot work
  std::atomic<std::int64_t> reconnects_ = 0;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread watchdog_;
};

}  // namespace

DdsNetwork NetworkOf(const DdsSpec& spec) {
  return {.domain = spec.domain,
          .udp = spec.transport != DdsTransport::kSharedMemory,
          .shared_memory = spec.transport != DdsTransport::kUdp,
          .interfaces = spec.interfaces,
          .peers = spec.peers,
          .security = spec.security};
}

DdsSourceOptions DdsOptionsFor(const Machine& machine) {
  DdsSourceOptions options;
  if (const auto* spec = machine.Source<DdsSpec>()) options.spec = *spec;
  for (const LiveChannel& channel : LiveChannels(machine))
    options.wanted.push_back(DdsChannelName(machine, channel.signal, channel.axis));
  return options;
}

std::unique_ptr<Source> MakeDdsSource(DdsSourceOptions options, Clock clock) {
  return std::make_unique<DdsSource>(std::move(options), std::move(clock));
}

std::vector<std::unique_ptr<Source>> MakeDdsSources(const Machine& machine, const Clock& clock,
                                                    std::uint64_t) {
  std::vector<std::unique_ptr<Source>> sources;
  if (std::any_of(machine.signals.begin(), machine.signals.end(),
                  [](const SignalSpec& signal) { return signal.From<DdsOrigin>() != nullptr; }))
    sources.push_back(MakeDdsSource(DdsOptionsFor(machine), clock));
  return sources;
}

}  // namespace hydroscope
