#include "alarms/feeds/dds/alarm_listener.h"

#include <hydroscope_wire/hydroscope_alarmsPubSubTypes.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <mutex>
#include <thread>

#include "dds/participant.h"

namespace hydroscope {
namespace {

using namespace eprosima::fastdds::dds;

const eprosima::fastrtps::Duration_t kLook{0, 50'000'000};  // s, ns: how late the end of the thread is seen

class DdsListener : public AlarmListener {
 public:
  DdsListener(std::unique_ptr<DdsParticipant> participant, DataReader* reader)
      : participant_(std::move(participant)),
        reader_(reader),
        thread_([this](const std::stop_token& stop) { Run(stop); }) {}
  ~DdsListener() override {
    thread_.request_stop();
    thread_.join();
  }

  bool matched() const override {
    SubscriptionMatchedStatus status;
    reader_->get_subscription_matched_status(status);
    return status.current_count > 0;
  }
  std::vector<HeardRow> rows() const override {
    std::lock_guard lock(mutex_);
    return rows_;
  }

 private:
  void Run(const std::stop_token& stop) {
    using eprosima::fastrtps::types::ReturnCode_t;
    hydroscope_wire::AlarmEvent event;
    SampleInfo info;
    while (!stop.stop_requested()) {
      while (reader_->take_next_sample(&event, &info) == ReturnCode_t::RETCODE_OK) {
        if (!info.valid_data) continue;
        std::lock_guard lock(mutex_);
        rows_.push_back({event.journal_sequence(), event.alarm().c_str(), event.comment()});
      }
      reader_->wait_for_unread_message(kLook);
    }
  }

  std::unique_ptr<DdsParticipant> participant_;
  DataReader* reader_;
  mutable std::mutex mutex_;
  std::vector<HeardRow> rows_;  // guarded
  std::jthread thread_;
};

}  // namespace

Result<std::unique_ptr<AlarmListener>> AlarmListener::Create(int domain) {
  auto participant = DdsParticipant::Create({.domain = domain,
                                             .udp = true,
                                             .shared_memory = false,
                                             .interfaces = {"127.0.0.1"},
                                             .peers = {},
                                             .section = "feeds.dds"},
                                            "campaign");
  if (!participant) return tl::unexpected(participant.error());
  const auto topic = (*participant)
                         ->MakeTopic(std::string(kTopic) + "/alarms",
                                     TypeSupport(new hydroscope_wire::AlarmEventPubSubType()));
  if (!topic) return tl::unexpected(topic.error());
  Subscriber* subscriber = (*participant)->get()->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  DataReader* reader =
      subscriber != nullptr ? subscriber->create_datareader(*topic, AlarmEventReaderQos()) : nullptr;
  if (reader == nullptr) return InternalError("DDS gives no reader for topic {}/alarms", kTopic);
  return std::make_unique<DdsListener>(std::move(*participant), reader);
}

}  // namespace hydroscope
