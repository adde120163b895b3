// With whom the node speaks: a primary host that comes and goes, a broker behind TLS.
#include <gmock/gmock.h>

#include "storage/outbox.h"
#include "tests/certificates_fixture.h"
#include "tests/sparkplug_fixture.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

class SparkplugHostTest : public SparkplugFeedTest {
 protected:
  void StartWaitingFeed() {
    SparkplugFeedSpec spec = Spec();
    spec.primary_host = "scada";
    StartFeed(spec);
  }
  /// The host says this of itself, retained as Sparkplug wants it.
  void Say(bool online, std::int64_t timestamp) {
    ASSERT_TRUE(host().SendText(
        broker().port(), "spBv1.0/STATE/scada",
        fmt::format(R"({{"online": {}, "timestamp": {}}})", online ? "true" : "false", timestamp), true));
  }
  std::int64_t Waiting() { return *Outbox::Open(Outbox::PathFor(database()))->Count(); }
};

TEST_F(SparkplugHostTest, WaitsForThePrimaryHostAndThenTellsWhatWasStored) {
  StartBroker();
  StartWaitingFeed();
  Raise("left", 1, 50);
  ASSERT_TRUE(WaitUntil([&] { return Waiting() == 50; }));
  ASSERT_TRUE(WaitUntil([&] { return status().state.english.find("scada is offline") != std::string::npos; }))
      << status().state.english;
  EXPECT_FALSE(status().connected);
  EXPECT_EQ(host().Count("press"), 0u) << "neither birth nor data before the host is there";
  Say(true, 1000);
  ASSERT_TRUE(WaitUntil([&] { return status().behind == 0 && host().Count("DDATA") >= 50; }))
      << status().state.english;
  EXPECT_TRUE(status().connected);
  EXPECT_EQ(host().Count("NBIRTH"), 1u);
  const auto events = Events();
  ASSERT_EQ(events.size(), 50u);
  EXPECT_TRUE(std::is_sorted(events.begin(), events.end()));
  for (const Json& message : Decoded("DDATA"))
    EXPECT_TRUE(message["payload"]["metrics"][0].value("isHistorical", false));
}

TEST_F(SparkplugHostTest, DiesWithTheHostAndIsBornAgainWithWhatHappenedMeanwhile) {
  StartBroker();
  Say(true, 1000);
  StartWaitingFeed();
  Raise("left", 1);
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DDATA/press/left") == 1; })) << status().state.english;
  Say(false, 1000);  // its will
  ASSERT_TRUE(WaitUntil([&] { return host().Count("NDEATH") == 1; })) << status().state.english;
  Raise("right", 1, 20);
  ASSERT_TRUE(WaitUntil([&] { return Waiting() == 20; }));
  EXPECT_EQ(host().Count("DDATA/press/right"), 0u);
  EXPECT_EQ(host().Count("NBIRTH"), 1u);
  Say(true, 2000);
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DDATA/press/right") >= 20; })) << status().state.english;
  const auto births = Decoded("NBIRTH");
  ASSERT_EQ(births.size(), 2u);
  EXPECT_EQ(births[1]["payload"]["seq"], 0);
  EXPECT_EQ(Metric(Decoded("NDEATH")[0], "bdSeq"), Metric(births[0], "bdSeq"));
  EXPECT_NE(Metric(births[1], "bdSeq"), Metric(births[0], "bdSeq"));
  const auto events = Events();
  ASSERT_EQ(events.size(), 21u) << "each once";
  for (std::size_t k = 0; k < events.size(); ++k) EXPECT_EQ(events[k], static_cast<std::int64_t>(k + 1));
  ASSERT_TRUE(WaitUntil([&] { return Waiting() == 0; }));
}

TEST_F(SparkplugHostTest, AnOldWillAndAnotherHostChangeNothing) {
  StartBroker();
  Say(true, 2000);
  StartWaitingFeed();
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DBIRTH") == 2; })) << status().state.english;
  Say(false, 1999);  // of the host's session before
  ASSERT_TRUE(host().SendText(broker().port(), "spBv1.0/STATE/other",
                              R"({"online": false, "timestamp": 9999})", false));
  ASSERT_TRUE(host().SendText(broker().port(), "spBv1.0/STATE/scada", "OFFLINE", false));
  Raise("left", 1);
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DDATA/press/left") == 1; })) << status().state.english;
  EXPECT_EQ(host().Count("NDEATH"), 0u);
  Say(true, 3000);  // a new session of the host that was not seen to end: everything is told anew
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DBIRTH") >= 4; }));
  EXPECT_EQ(host().Count("NBIRTH"), 2u);
}

TEST_F(SparkplugFeedTest, AlarmsOfThePressItselfAreThoseOfADeviceOfItsOwn) {
  StartBroker();
  StartFeed();
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DBIRTH") == 2; }));
  RaiseOfPress("supply_or_oil");
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DDATA/press/press") == 1; })) << status().state.english;
  const Json birth = Decoded("DBIRTH/press/press").back();
  EXPECT_EQ(Metric(birth, "Alarms/supply_or_oil"), "UNACK");
  EXPECT_EQ(Metric(birth, "Health"), "C");  // no axis has been judged
  EXPECT_EQ(Metric(Decoded("DDATA/press/press")[0], "Event/Alarm"), "supply_or_oil");
}

class SparkplugTlsTest : public SparkplugFeedTest {
 protected:
  void SetUp() override {
    SparkplugFeedTest::SetUp();
    if (IsSkipped()) return;
    if (Program::Find("openssl").empty())
      GTEST_SKIP() << "openssl is not installed; scripts/setup.sh installs it";
    files_.MakeAuthority("authority");
    files_.MakeAuthority("stranger");
    files_.Make("node", "authority", "DNS:press_7");
    files_.Make("nobody", "stranger", "DNS:press_7");
  }
  /// A listener that shows the certificate `broker` and asks for one of the authority.
  void StartTlsBroker(const std::string& alternative = "IP:127.0.0.1", bool expired = false) {
    files_.Make("broker", "authority", alternative);
    if (expired) files_.Expire("broker", "authority", alternative);
    StartBroker(fmt::format(
        "listener {} 127.0.0.1\ncafile {}\ncertfile {}\nkeyfile {}\nrequire_certificate true\n", port_,
        files_.Certificate("authority"), files_.Certificate("broker"), files_.Key("broker")));
  }
  SparkplugFeedSpec Encrypted(const std::string& authority, const std::string& own) const {
    SparkplugFeedSpec spec;
    spec.broker = fmt::format("ssl://127.0.0.1:{}", port_);
    if (!authority.empty()) spec.ca_file = files_.Certificate(authority);
    if (own.empty()) return spec;
    spec.certificate_file = files_.Certificate(own);
    spec.key_file = files_.Key(own);
    return spec;
  }
  bool IsRefused() {
    const bool tried = WaitUntil([&] { return status().errors >= 1; });
    return tried && !status().connected && host().Count("NBIRTH") == 0;
  }

  Certificates files_{File("")};
  int port_ = Broker::FreePort();
};

TEST_F(SparkplugTlsTest, TellsThroughAnEncryptedConnectionWithCertificatesOfBothSides) {
  StartTlsBroker();
  StartFeed(Encrypted("authority", "node"));
  Raise("left", 1);
  ASSERT_TRUE(WaitUntil([&] { return host().Count("DDATA/press/left") == 1; })) << status().state.english;
  EXPECT_TRUE(status().connected);
}

TEST_F(SparkplugTlsTest, ABrokerOfAStrangeAuthorityIsNotTrusted) {
  StartTlsBroker();
  StartFeed(Encrypted("stranger", "node"));
  EXPECT_TRUE(IsRefused()) << status().state.english;
}

TEST_F(SparkplugTlsTest, WithoutAnAuthorityThoseOfTheSystemCount) {
  StartTlsBroker();
  StartFeed(Encrypted("", "node"));
  EXPECT_TRUE(IsRefused()) << status().state.english;
}

TEST_F(SparkplugTlsTest, ACertificateOfAnotherHostIsNotTrusted) {
  StartTlsBroker("DNS:elsewhere.example");
  StartFeed(Encrypted("authority", "node"));
  EXPECT_TRUE(IsRefused()) << status().state.english;
}

TEST_F(SparkplugTlsTest, TheBrokerRefusesANodeWithoutACertificateItTrusts) {
  StartTlsBroker();
  StartFeed(Encrypted("authority", ""));
  EXPECT_TRUE(IsRefused()) << status().state.english;
  StartFeed(Encrypted("authority", "nobody"));
  EXPECT_TRUE(IsRefused()) << status().state.english;
}

TEST_F(SparkplugTlsTest, SaysWhyABrokerIsNotTrusted) {
  const auto reason = [&](const std::string& authority, const std::string& own) {
    StartFeed(Encrypted(authority, own));
    EXPECT_TRUE(WaitUntil([&] { return status().errors >= 1; }));
    return status().state.english;
  };
  EXPECT_THAT(reason("authority", "node"), HasSubstr("nobody listens at 127.0.0.1"));
  StartTlsBroker();
  EXPECT_THAT(reason("stranger", "node"), HasSubstr("of another authority than ca_file"));
  EXPECT_THAT(reason("authority", ""), HasSubstr("refuses our certificate"));
}

TEST_F(SparkplugTlsTest, SaysThatTheCertificateIsOfAnotherName) {
  StartTlsBroker("DNS:elsewhere.example");
  StartFeed(Encrypted("authority", "node"));
  ASSERT_TRUE(WaitUntil([&] { return status().errors >= 1; }));
  EXPECT_THAT(status().state.english, HasSubstr("it was made for another name"));
}

TEST_F(SparkplugTlsTest, SaysThatTheCertificateHasExpired) {
  StartTlsBroker("IP:127.0.0.1", true);
  StartFeed(Encrypted("authority", "node"));
  ASSERT_TRUE(WaitUntil([&] { return status().errors >= 1; }));
  EXPECT_THAT(status().state.english, HasSubstr("has expired"));
}

TEST_F(SparkplugTlsTest, AKeyThatEverybodyMayReadIsRefused) {
  StartTlsBroker();
  std::filesystem::permissions(files_.Key("node"), std::filesystem::perms(0644));
  StartFeed(Encrypted("authority", "node"));
  ASSERT_TRUE(WaitUntil([&] { return status().errors >= 1; }));
  EXPECT_THAT(status().state.english, HasSubstr("may be read by every user"));
}

TEST_F(SparkplugTlsTest, AFileThatIsNotThereIsNamed) {
  SparkplugFeedSpec spec = Encrypted("authority", "node");
  spec.key_file = File("lost.key");
  StartFeed(spec);
  ASSERT_TRUE(WaitUntil([&] { return status().errors >= 1; }));
  EXPECT_THAT(status().state.english, HasSubstr("lost.key cannot be read"));
}

TEST_F(SparkplugFeedTest, AnotherClientOfTheSameNameIsToldAndNotFoughtWith) {
  StartBroker();
  Program rival;  // it connects anew a second after it was put out
  rival.Start("mosquitto_sub",
              {"-h", "127.0.0.1", "-p", broker().port(), "-i", "hydroscope-hydroscope-press", "-t", "any"},
              File("rival"));
  StartFeed();
  ASSERT_TRUE(WaitUntil(
      [&] {
        return status().state.english.find("call itself hydroscope-hydroscope-press") != std::string::npos;
      },
      20))
      << status().state.english;
  EXPECT_FALSE(status().connected);
  const std::size_t births = host().Count("NBIRTH");
  EXPECT_LT(births, 8u);
  rival.Kill();
  EXPECT_TRUE(WaitUntil([&] { return status().connected; }, 20)) << status().state.english;
}

TEST_F(SparkplugFeedTest, ARefusalOfTheBrokerIsToldInWords) {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{
      .sin_family = AF_INET, .sin_port = 0, .sin_addr = {htonl(INADDR_LOOPBACK)}, .sin_zero = {}};
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(listener, 8), 0);
  getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size);
  std::thread broker([listener] {
    for (int client = 0; (client = accept(listener, nullptr, nullptr)) >= 0; close(client)) {
      char connect[256];
      if (read(client, connect, sizeof connect) <= 0) continue;
      constexpr char kNotAuthorised[] = {0x20, 2, 0, 5};
      static_cast<void>(write(client, kNotAuthorised, sizeof kNotAuthorised));
    }
  });
  SparkplugFeedSpec spec = Spec();
  spec.broker = fmt::format("tcp://127.0.0.1:{}", ntohs(address.sin_port));
  StartFeed(spec);
  EXPECT_TRUE(WaitUntil([&] {
    return status().state.english.find("does not let this client in") != std::string::npos;
  })) << status().state.english;
  StopFeed();
  shutdown(listener, SHUT_RDWR);
  broker.join();
  close(listener);
}

}  // namespace
}  // namespace hydroscope
