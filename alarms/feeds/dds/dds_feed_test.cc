#include <gmock/gmock.h>
#include <hydroscope_wire/hydroscope_alarmsPubSubTypes.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include "alarms/feeds/dds/settings.h"
#include "dds/domains.h"
#include "dds/participant.h"
#include "dds/taken_port_fixture.h"
#include "tests/feed_fixture.h"

namespace hydroscope {
namespace {

using namespace eprosima::fastdds::dds;
using ::testing::HasSubstr;

int OwnDomain() {
  static const int domain = FreeDomain();
  return domain;
}

/// A reader that is not of the feed.
class Listening {
 public:
  Listening() {
    auto participant = DdsParticipant::Create({.domain = OwnDomain(),
                                               .udp = true,
                                               .shared_memory = false,
                                               .interfaces = {"127.0.0.1"},
                                               .peers = {}},
                                              "reader");
    EXPECT_TRUE(participant) << participant.error().text;
    participant_ = std::move(*participant);
    events_ = Reader("plant/alarms", TypeSupport(new hydroscope_wire::AlarmEventPubSubType()),
                     AlarmEventReaderQos());
    findings_ =
        Reader("plant/findings", TypeSupport(new hydroscope_wire::FindingPubSubType()), FindingReaderQos());
  }
  /// Everything that came since the last call.
  std::vector<hydroscope_wire::AlarmEvent> Events() { return Take<hydroscope_wire::AlarmEvent>(events_); }
  std::vector<hydroscope_wire::Finding> Findings() { return Take<hydroscope_wire::Finding>(findings_); }

 private:
  DataReader* Reader(const std::string& name, const TypeSupport& type, const DataReaderQos& qos) {
    const auto topic = participant_->MakeTopic(name, type);
    EXPECT_TRUE(topic);
    return participant_->get()->create_subscriber(SUBSCRIBER_QOS_DEFAULT)->create_datareader(*topic, qos);
  }
  template <typename Message>
  std::vector<Message> Take(DataReader* reader) {
    std::vector<Message> all;
    Message message;
    SampleInfo info;
    while (reader->take_next_sample(&message, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK)
      if (info.valid_data) all.push_back(message);
    return all;
  }

  std::unique_ptr<DdsParticipant> participant_;
  DataReader* events_;
  DataReader* findings_;
};

class DdsFeedTest : public FeedTest {
 protected:
  void Start() {
    PartsSpec feeds;
    auto& dds = feeds.Add<DdsFeedSpec>();
    dds.domain = OwnDomain();
    dds.topic = "plant";
    dds.transport = DdsTransport::kUdp;
    feeds_.emplace(Feeds::Start(Press(feeds), database(), RealTime));
    ASSERT_TRUE(WaitUntil([&] { return status().connected; })) << status().state.english;
  }
  FeedStatus status() const { return feeds_->status().front(); }

 private:
  std::optional<Feeds> feeds_;
};

TEST_F(DdsFeedTest, AReaderGetsEveryEventInOrder) {
  Start();
  Listening reader;
  ASSERT_TRUE(WaitUntil([&] { return status().clients == 1; }));
  for (int k = 0; k < 10; ++k) Raise(k % 2 == 0 ? "left" : "right", 1 + 50 * k, 100);
  std::vector<hydroscope_wire::AlarmEvent> events;
  std::int64_t wanted = 0;
  ASSERT_TRUE(journal().LastSequence());
  wanted = *journal().LastSequence();
  ASSERT_GE(wanted, 500);
  ASSERT_TRUE(WaitUntil([&] {
    for (auto& event : reader.Events()) events.push_back(std::move(event));
    return static_cast<std::int64_t>(events.size()) >= wanted;
  }));
  for (std::size_t k = 0; k < events.size(); ++k)
    ASSERT_EQ(events[k].journal_sequence(), static_cast<std::int64_t>(k + 1));
  EXPECT_EQ(std::string(events[0].machine().c_str()), "press/left");
  EXPECT_EQ(std::string(events[0].alarm().c_str()), "alarm_1");
  EXPECT_EQ(std::string(events[0].event().c_str()), "raised");
  EXPECT_EQ(events[0].value(), 2);
  EXPECT_EQ(events[0].text(), "a \"seal\" leaks");
  EXPECT_TRUE(WaitUntil([&] { return status().behind == 0; }));
}

TEST_F(DdsFeedTest, ALateReaderGetsThePresentStateOfEveryAlarm) {
  Raise("left", 1, 2);
  Start();
  Raise("right", 3);
  ASSERT_TRUE(WaitUntil([&] { return status().delivered == 3; }));
  Listening reader;
  std::map<std::string, hydroscope_wire::Finding> findings;
  ASSERT_TRUE(WaitUntil([&] {
    for (const auto& f : reader.Findings()) findings[f.alarm().c_str()] = f;
    return findings.size() == 4;  // with that of the axes as a whole
  }));
  EXPECT_THAT(findings[""].text(), HasSubstr("(alarm)"));
  EXPECT_EQ(std::string(findings["alarm_3"].machine().c_str()), "press/right");
  EXPECT_EQ(std::string(findings["alarm_3"].state().c_str()), "UNACK");
  EXPECT_EQ(findings["alarm_3"].health(), 'S');
  EXPECT_EQ(findings["alarm_3"].value(), 6);
  EXPECT_EQ(findings["alarm_3"].text(), "a \"seal\" leaks");
  std::size_t events = 0;
  EXPECT_TRUE(WaitUntil([&] { return (events += reader.Events().size()) == 3; }));
}

TEST_F(DdsFeedTest, APortThatAnotherProgramHasIsToldAndTriedAgain) {
  std::optional<TakenPort> other(OwnDomain());
  PartsSpec spec;
  spec.Add<DdsFeedSpec>().domain = OwnDomain();
  const Feeds feeds = Feeds::Start(Press(spec), database(), RealTime);
  ASSERT_TRUE(WaitUntil([&] { return feeds.status()[0].errors > 0; }));
  EXPECT_FALSE(feeds.status()[0].connected);
  EXPECT_THAT(feeds.status()[0].state.english, HasSubstr("is taken by another program"));
  other.reset();
  EXPECT_TRUE(WaitUntil([&] { return feeds.status()[0].connected; }));
}

TEST_F(DdsFeedTest, AnAddressThatThisComputerDoesNotHaveIsTold) {
  PartsSpec spec;
  spec.Add<DdsFeedSpec>().interfaces = {"203.0.113.1"};
  const Feeds feeds = Feeds::Start(Press(spec), database(), RealTime);
  ASSERT_TRUE(WaitUntil([&] { return feeds.status()[0].errors > 0; }));
  EXPECT_FALSE(feeds.status()[0].connected);
  EXPECT_THAT(feeds.status()[0].state.english, HasSubstr("[feeds.dds] interfaces"));
}

}  // namespace
}  // namespace hydroscope
