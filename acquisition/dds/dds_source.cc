#include "acquisition/dds/dds_source.h"

#include <condition_variable>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <mutex>
#include <thread>

#include "acquisition/batch_assembler.h"
#include "acquisition/dds/messages.h"
#include "dds/participant.h"

namespace hydroscope {
namespace {

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

constexpr double kLongestDeaf = 60;  // s between two rebuilds

DdsNetwork NetworkOf(const DdsSpec& spec) {
  return {.domain = spec.domain,
          .udp = spec.transport != DdsTransport::kSharedMemory,
          .shared_memory = spec.transport != DdsTransport::kUdp,
          .interfaces = spec.interfaces,
          .peers = spec.peers};
}

/// What the library's threads and the watchdog share.
class Receiver {
 public:
  Receiver(const DdsSourceOptions& options, Clock clock, Source::Sink sink)
      : assembler_(options.wanted), clock_(std::move(clock)), sink_(std::move(sink)) {}

  void Take(DataReader& reader, hydroscope_wire::Layout& buffer) {
    SampleInfo info;
    std::lock_guard lock(mutex_);
    while (reader.take_next_sample(&buffer, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data) assembler_.Receive(ToMessage(buffer), sink_);
  }
  void Take(DataReader& reader, hydroscope_wire::Batch& buffer) {
    SampleInfo info;
    std::lock_guard lock(mutex_);
    while (reader.take_next_sample(&buffer, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      late_ = false;
      assembler_.Receive(ToMessage(std::move(buffer)), clock_(), sink_);
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
  void BeginAnew() {
    std::lock_guard lock(mutex_);
    matched_ = alive_ = 0;
    incompatible_ = false;
  }
  SourceStatus status() const {
    std::lock_guard lock(mutex_);
    SourceStatus status = assembler_.counters();
    status.connected = matched_ > 0 && alive_ > 0;
    status.state = Describe();
    return status;
  }

 private:
  std::string Describe() const {
    if (incompatible_)
      return "a sender offers another quality of service; it must be reliable with a deadline of 0.1 s";
    if (matched_ == 0) return "waiting for a sender; check domain, topic and interfaces if one is running";
    if (alive_ == 0) return "the sender stopped giving signs of life";
    if (!assembler_.complaint().empty()) return assembler_.complaint();
    if (late_) return "the sender is there but sends no batches in time";
    return "receiving";
  }

  mutable std::mutex mutex_;
  BatchAssembler assembler_;
  Clock clock_;
  Source::Sink sink_;
  int matched_ = 0, alive_ = 0;
  bool late_ = false, incompatible_ = false;
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
  static Result<std::unique_ptr<Subscription>> Create(const DdsSpec& spec, Receiver& receiver) {
    auto participant = DdsParticipant::Create(NetworkOf(spec), "hydroscope");
    if (!participant) return tl::unexpected(participant.error());
    auto made = std::unique_ptr<Subscription>(new Subscription(std::move(*participant), receiver));
    if (const Status status = made->Open(spec); !status) return tl::unexpected(status.error());
    return made;
  }

 private:
  Subscription(std::unique_ptr<DdsParticipant> participant, Receiver& receiver)
      : layouts_(receiver), batches_(receiver), participant_(std::move(participant)) {}

  Status Open(const DdsSpec& spec) {
    const auto layouts = participant_->MakeTopic(
        LayoutTopic(spec.topic), TypeSupport(new Tolerant<hydroscope_wire::LayoutPubSubType>()));
    if (!layouts) return tl::unexpected(layouts.error());
    const auto samples =
        participant_->MakeTopic(spec.topic, TypeSupport(new Tolerant<hydroscope_wire::BatchPubSubType>()));
    if (!samples) return tl::unexpected(samples.error());
    Subscriber* subscriber = participant_->get()->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
    if (subscriber == nullptr ||
        subscriber->create_datareader(*layouts, LayoutReaderQos(), &layouts_) == nullptr ||
        subscriber->create_datareader(*samples, SampleReaderQos(spec.deadline, spec.backlog), &batches_) ==
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
    auto subscription = Subscription::Create(options_.spec, *receiver_);
    if (!subscription) return tl::unexpected(subscription.error());
    subscription_ = std::move(*subscription);
    watchdog_ = std::jthread([this](std::stop_token stop) { Watch(stop); });
    return {};
  }

  SourceStatus status() const override {
    SourceStatus status;
    if (receiver_) status = receiver_->status();
    status.name = "dds " + options_.spec.topic;
    status.reconnects = rebuilds_;
    return status;
  }

  void Stop() override {
    watchdog_ = {};  // asks it to stop and waits
    subscription_.reset();
  }

 private:
  /// Nothing came for the time that is allowed: whatever the library believes, begin anew.
  void Watch(const std::stop_token& stop) {
    const double step = options_.deaf_after;
    double patience = step, silent = 0;
    SourceStatus seen = receiver_->status();
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, stop, std::chrono::duration<double>(step), [] { return false; })) {
      if (stop.stop_requested()) return;
      const SourceStatus now = receiver_->status();
      const bool heard = now.batches != seen.batches, found = now.connected && !seen.connected;
      seen = now;
      silent = heard || found ? 0 : silent + step;
      if (heard || found) patience = step;
      if (silent < patience) continue;
      patience = std::min(2 * patience, std::max(kLongestDeaf, step));
      silent = 0;
      Rebuild();
      seen.connected = false;
    }
  }

  void Rebuild() {
    subscription_.reset();
    receiver_->BeginAnew();
    // A refusal (network card gone) is tried again after the next, longer patience.
    if (auto subscription = Subscription::Create(options_.spec, *receiver_))
      subscription_ = std::move(*subscription);
    ++rebuilds_;
  }

  DdsSourceOptions options_;
  Clock clock_;
  std::unique_ptr<Receiver> receiver_;
  std::unique_ptr<Subscription> subscription_;
  std::atomic<std::int64_t> rebuilds_ = 0;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread watchdog_;
};

}  // namespace

DdsSourceOptions DdsOptionsFor(const Machine& machine) {
  DdsSourceOptions options;
  if (machine.live && machine.live->dds) options.spec = *machine.live->dds;
  for (const LiveChannel& channel : LiveChannels(machine))
    options.wanted.push_back(DdsChannelName(machine, channel.signal, channel.axis));
  return options;
}

std::unique_ptr<Source> MakeDdsSource(DdsSourceOptions options, Clock clock) {
  return std::make_unique<DdsSource>(std::move(options), std::move(clock));
}

}  // namespace hydroscope
