#include <gmock/gmock.h>

#include "alarms/feeds/modbus/settings.h"
#include "alarms/feeds/sparkplug/settings.h"
#include "storage/database.h"
#include "storage/outbox.h"
#include "tests/sparkplug_fixture.h"

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST_F(SparkplugFeedTest, AnAxisThatIsBeingLearnedIsNotGood) {
  StartBroker();
  BeginLearning("left");
  StartFeed();
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DBIRTH/press/left") == 1; })) << status().state.english;
  const Json birth = Decoded("DBIRTH/press/left").front();
  EXPECT_EQ(Metric(birth, "Health"), "C");
  EXPECT_EQ(Metric(birth, "Health/Reason"), "learning");
}

TEST_F(SparkplugFeedTest, IsBornWithItsAxesAndTellsEachEventWithAcknowledgement) {
  StartBroker();
  Raise("left", 1);
  StartFeed();
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DDATA/press/left") == 1; })) << status().state.english;
  Raise("right", 7);
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DDATA/press/right") == 1; }));
  const auto messages = Decoded();
  ASSERT_GE(messages.size(), 5u);
  EXPECT_EQ(messages[0]["topic"], "spBv1.0/hydroscope/NBIRTH/press");
  EXPECT_EQ(messages[0]["quality"], 0);
  EXPECT_EQ(Metric(messages[0], "bdSeq"), 0);
  EXPECT_EQ(Metric(messages[0], "Node Control/Rebirth"), false);
  EXPECT_EQ(messages[1]["topic"], "spBv1.0/hydroscope/DBIRTH/press/left");
  EXPECT_EQ(messages[2]["topic"], "spBv1.0/hydroscope/DBIRTH/press/right");
  EXPECT_EQ(Metric(messages[1], "Alarms/alarm_1"), "UNACK");
  EXPECT_EQ(Metric(messages[1], "Health"), "S");
  for (std::size_t k = 0; k < messages.size(); ++k)
    EXPECT_EQ(messages[k]["payload"]["seq"], k) << "not in order";
  const Json event = Decoded("DDATA/press/right").front();
  EXPECT_EQ(event["quality"], 1);
  EXPECT_EQ(Metric(event, "Event/Sequence"), 2);
  EXPECT_EQ(Metric(event, "Event/Alarm"), "alarm_7");
  EXPECT_EQ(Metric(event, "Event/Event"), "raised");
  EXPECT_EQ(Metric(event, "Event/State"), "UNACK");
  EXPECT_EQ(Metric(event, "Event/Value"), 14);
  EXPECT_EQ(Metric(event, "Event/Text"), "a \"seal\" leaks");
  EXPECT_EQ(Metric(event, "Alarms/alarm_7"), "UNACK");
  EXPECT_TRUE(WaitUntil([&] { return status().behind == 0; }));
  EXPECT_EQ(status().delivered, 2);
}

TEST_F(SparkplugFeedTest, EverythingThatDataSpeaksOfWasAnnouncedByABirth) {
  StartBroker();
  StartFeed();
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DBIRTH") == 2; }));
  Raise("left", 1);
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DDATA") > 0; }));
  std::map<std::string, std::set<std::string>> announced;
  for (const Json& message : Decoded()) {
    const auto topic = message["topic"].get<std::string>();
    const std::string device = topic.substr(topic.rfind('/') + 1);
    for (const Json& metric : message["payload"]["metrics"]) {
      const auto name = metric["name"].get<std::string>();
      if (topic.find("DBIRTH") != std::string::npos) announced[device].insert(name);
      const bool data = topic.find("DDATA") != std::string::npos;
      EXPECT_TRUE(!data || announced[device].contains(name)) << device << ": " << name;
    }
  }
}

TEST_F(SparkplugFeedTest, IsBornAgainOnCommand) {
  StartBroker();
  StartFeed();
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DBIRTH") == 2; }));
  ASSERT_TRUE(host().Send(broker().port(), "spBv1.0/hydroscope/NCMD/press", "ffff"));
  // One metric: name "Node Control/Rebirth", boolean_value true.
  ASSERT_TRUE(host().Send(broker().port(), "spBv1.0/hydroscope/NCMD/press",
                          "12180a144e6f646520436f6e74726f6c2f526562697274687001"));
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DBIRTH") == 4; }));
  const auto births = Decoded("NBIRTH");
  ASSERT_EQ(births.size(), 2u);
  EXPECT_EQ(births[1]["payload"]["seq"], 0);
  EXPECT_EQ(Metric(births[0], "bdSeq"), Metric(births[1], "bdSeq"));
}

TEST_F(SparkplugFeedTest, ManyRequestsForBirthsAreAnsweredOnce) {
  StartBroker();
  StartFeed();
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DBIRTH") == 2; }));
  for (int k = 0; k < 20; ++k)
    ASSERT_TRUE(host().Send(broker().port(), "spBv1.0/hydroscope/NCMD/press",
                            "12180a144e6f646520436f6e74726f6c2f526562697274687001"));
  ASSERT_TRUE(WaitUntil([&] { return host().Count("NBIRTH") >= 2; }));
  Raise("left", 1);
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DDATA/press/left") == 1; }));
  EXPECT_LE(host().Count("NBIRTH"), 3) << "20 requests within a second or two";
}

TEST_F(SparkplugFeedTest, DiesWithTheNumberOfItsBirthAndIsBornWithTheNext) {
  StartBroker();
  StartFeed();
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DBIRTH") == 2; }));
  StopFeed();
  ASSERT_TRUE(WaitUntil([&] { return host().Count("NDEATH") == 1; }));
  StartFeed();
  ASSERT_TRUE(WaitUntil([&] { return host().Count("NBIRTH") == 2; }));
  EXPECT_EQ(Metric(Decoded("NDEATH")[0], "bdSeq"), 0);
  EXPECT_FALSE(Decoded("NDEATH")[0]["payload"].contains("seq"));
  EXPECT_EQ(Metric(Decoded("NBIRTH")[1], "bdSeq"), 1);
}

TEST_F(SparkplugFeedTest, WhatHappensWithoutABrokerIsToldLaterAsHistorical) {
  StartFeed();
  Raise("left", 1, 300);
  ASSERT_TRUE(WaitUntil([&] { return status().behind == 300 && status().errors > 0; }));
  EXPECT_FALSE(status().connected);
  EXPECT_THAT(status().state.english, HasSubstr("MQTT broker"));
  const auto outbox = Outbox::Open(Outbox::PathFor(database()));
  ASSERT_TRUE(WaitUntil([&] { return *outbox->Count() == 300; }));
  StopFeed();
  StartBroker();  // and the host, before the feed can tell anything
  StartFeed();
  ASSERT_TRUE(WaitUntil([&] { return status().behind == 0; }, 20)) << status().state.english;
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DDATA") >= 300; }));
  const auto events = Events();
  ASSERT_EQ(events.size(), 300u);
  for (std::size_t k = 0; k < events.size(); ++k) ASSERT_EQ(events[k], static_cast<std::int64_t>(k + 1));
  std::size_t historical = 0;
  for (const Json& message : Decoded("DDATA"))
    historical += message["payload"]["metrics"][0].value("isHistorical", false);
  EXPECT_EQ(historical, 300u);
  EXPECT_EQ(*outbox->Count(), 0);
}

TEST_F(SparkplugFeedTest, ABrokerThatDiesAndComesBackGetsWhatItDidNotAcknowledge) {
  StartBroker();
  StartFeed();
  ASSERT_TRUE(WaitUntil([&] { return status().connected; }));
  Raise("left", 1, 20);
  ASSERT_TRUE(WaitUntil([&] { return status().delivered == 20 && host().Count("DDATA") >= 20; }));
  broker().Kill();
  Raise("right", 1, 20);
  ASSERT_TRUE(WaitUntil([&] { return !status().connected && status().behind == 20; }));
  StartBroker();
  // What the broker acknowledges before the host is there again, the host never sees.
  ASSERT_TRUE(WaitUntil([&] { return status().delivered == 40; }, 20)) << status().state.english;
  Raise("left", 50);
  ASSERT_TRUE(WaitUntil([&] {
    const auto events = Events();
    return !events.empty() && events.back() == 41;
  }));
  const auto events = Events();
  EXPECT_TRUE(std::is_sorted(events.begin(), events.end()));
  EXPECT_EQ(events[19], 20);
}

TEST_F(SparkplugFeedTest, AHangingBrokerDelaysNeitherTheJournalNorAnotherFeed) {
  const int listening = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(listening, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(listening, 8), 0);
  getsockname(listening, reinterpret_cast<sockaddr*>(&address), &size);
  PartsSpec spec;
  spec.Add<ModbusFeedSpec>().port = 0;
  spec.Add<SparkplugFeedSpec>().broker = "tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  const Feeds feeds = Feeds::Start(Press(spec), database(), RealTime);
  ASSERT_TRUE(WaitUntil([&] { return feeds.status()[0].connected; }));
  const double begin = Now();
  for (int k = 1; k <= 20; ++k) Raise("left", k);
  EXPECT_TRUE(WaitUntil([&] { return feeds.status()[0].delivered == 20; }, 5));
  EXPECT_LT(Now() - begin, 5);
  EXPECT_FALSE(feeds.status()[1].connected);
  close(listening);
}

}  // namespace
}  // namespace hydroscope
