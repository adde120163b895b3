#include "alarms/feeds/dds/alarm_listener.h"

#include <hydroscope_wire/hydroscope_alarmsPubSubTypes.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <mutex>
#include <thread>

#include "dds/participant.h"

namespace hydroscope {
namespace {

using namespace eprosima::fastdds::dds;

const eprosima::fastrtps::Duration_t kLook{0, 50'000'000};  // s, ns: how late the end of the thread is seen

class DdsListener : public AlarmListener {
 public:
  DdsListener(std::unique_ptr<DdsParticipant> participant, DataReader* events, DataReader* findings)
      : participant_(std::move(participant)),
        reader_(events),
        findings_(findings),
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
  char HealthOf(const std::string& machine) const override {
    std::lock_guard lock(mutex_);
    const auto found = health_.find(machine);
    return found == health_.end() ? ' ' : found->second;
  }

 private:
  void TakeFindings() {
    using eprosima::fastrtps::types::ReturnCode_t;
    hydroscope_wire::Finding finding;
    SampleInfo info;
    while (findings_->take_next_sample(&finding, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data || finding.alarm().size() > 0) continue;
      std::lock_guard lock(mutex_);
      health_[finding.machine().c_str()] = finding.health();
    }
  }

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
      TakeFindings();
      reader_->wait_for_unread_message(kLook);
    }
  }

  std::unique_ptr<DdsParticipant> participant_;
  DataReader *reader_, *findings_;
  mutable std::mutex mutex_;
  std::vector<HeardRow> rows_;          // guarded, as what follows
  std::map<std::string, char> health_;  // by machine
  std::jthread thread_;
};

}  // namespace

Result<std::unique_ptr<AlarmListener>> AlarmListener::Create(int domain) {
  auto participant = TRY(DdsParticipant::Create({.domain = domain,
                                                 .udp = true,
                                                 .shared_memory = false,
                                                 .interfaces = {"127.0.0.1"},
                                                 .peers = {},
                                                 .section = "feeds.dds"},
                                                "campaign"));
  const auto topic = TRY((participant)
                             ->MakeTopic(std::string(kTopic) + "/alarms",
                                         TypeSupport(new hydroscope_wire::AlarmEventPubSubType())));
  const auto findings_topic = TRY((participant)
                                      ->MakeTopic(std::string(kTopic) + "/findings",
                                                  TypeSupport(new hydroscope_wire::FindingPubSubType())));
  Subscriber* subscriber = participant->get()->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  DataReader* reader =
      subscriber != nullptr ? subscriber->create_datareader(topic, AlarmEventReaderQos()) : nullptr;
  DataReader* findings =
      reader != nullptr ? subscriber->create_datareader(findings_topic, FindingReaderQos()) : nullptr;
  if (findings == nullptr) return InternalError("DDS gives no reader for topic {}/alarms", kTopic);
  return std::make_unique<DdsListener>(std::move(participant), reader, findings);
}

}  // namespace hydroscope
