// What only the DDS source does: late joiners, deadline, watchdog, settings that can never work.
#include "acquisition/dds/dds_source.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "dds/taken_port_fixture.h"
#include "tests/live_fixture.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

class DdsSourceTest : public ::testing::Test {
 protected:
  DdsSourceTest() {
    options_.spec.domain = OwnDomain();
    options_.spec.transport = DdsTransport::kUdp;
    options_.spec.interfaces = {"127.0.0.1"};
    options_.wanted = {"left/p_A", "right/z"};
  }
  ~DdsSourceTest() override {
    if (source_) source_->Stop();
  }
  void Live() {
    press_.Live(DdsNetwork{.domain = OwnDomain(),
                           .udp = true,
                           .shared_memory = false,
                           .interfaces = {"127.0.0.1"},
                           .peers = {}});
  }
  Status Start() {
    source_ = MakeDdsSource(options_, RealTime);
    return source_->Start(sink_.sink());
  }
  bool Tells(const std::string& state) {
    return WaitUntil([&] { return source_->status().state.english.find(state) != std::string::npos; });
  }

  TestPress press_;
  TestSink sink_;
  DdsSourceOptions options_;
  std::unique_ptr<Source> source_;
};

TEST_F(DdsSourceTest, ALateJoinerGetsOnlyWhatIsNew) {
  Live();
  ASSERT_TRUE(WaitUntil([&] { return press_.server().counters().batches >= 30; }));
  ASSERT_TRUE(Start());
  ASSERT_TRUE(sink_.WaitForMore(50));
  EXPECT_GE(sink_.batches().front().first_sequence, 200u);
}

TEST_F(DdsSourceTest, ALateJoinerMayAskForTheBacklog) {
  Live();
  ASSERT_TRUE(WaitUntil([&] { return press_.server().counters().batches >= 30; }));
  options_.spec.backlog = true;
  ASSERT_TRUE(Start());
  ASSERT_TRUE(sink_.WaitForMore(350));
  EXPECT_EQ(sink_.batches().front().first_sequence, 0u);
  EXPECT_EQ(source_->status().lost_rows, 0);
}

TEST_F(DdsSourceTest, APortThatAnotherProgramHasIsToldAndTriedAgain) {
  std::optional<TakenPort> other(OwnDomain());
  ASSERT_TRUE(Start());
  EXPECT_TRUE(Tells("is taken by another program")) << source_->status().state.english;
  other.reset();
  Live();
  EXPECT_TRUE(sink_.WaitForMore(50));
}

TEST_F(DdsSourceTest, ASenderThatFallsSilentIsLateAndIsHeardAgain) {
  Live();
  ASSERT_TRUE(Start());
  ASSERT_TRUE(sink_.WaitForMore(50));
  ASSERT_TRUE(press_.server().Do(MuteCommand{true}));
  EXPECT_TRUE(Tells("no batches in time")) << source_->status().state.english;
  ASSERT_TRUE(press_.server().Do(MuteCommand{false}));
  EXPECT_TRUE(sink_.WaitForMore(50));
  EXPECT_TRUE(Tells("receiving"));
  EXPECT_GT(source_->status().lost_rows, 0) << "what was not sent is told by the numbers";
}

TEST_F(DdsSourceTest, TheWatchdogBuildsItAnewAndItStillHears) {
  options_.deaf_after = 0.1;
  ASSERT_TRUE(Start());
  std::this_thread::sleep_for(std::chrono::seconds(1));  // built anew three times
  EXPECT_EQ(source_->status().reconnects, 0) << "nobody was there";
  Live();
  EXPECT_TRUE(sink_.WaitForMore(50)) << source_->status().state.english;
  ASSERT_TRUE(press_.server().Do(MuteCommand{true}));
  EXPECT_TRUE(WaitUntil([&] { return source_->status().reconnects > 0; }));
}

TEST_F(DdsSourceTest, AChannelThatIsNotAnnouncedIsNamed) {
  options_.wanted.push_back("middle/p_A");
  Live();
  ASSERT_TRUE(Start());
  EXPECT_TRUE(sink_.WaitForMore(20)) << "the others come all the same";
  EXPECT_TRUE(Tells("but not middle/p_A")) << source_->status().state.english;
}

TEST_F(DdsSourceTest, AnAddressThatIsNotOursIsRefused) {
  options_.spec.interfaces = {"203.0.113.7"};
  const Status status = Start();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().text, HasSubstr("203.0.113.7"));
  EXPECT_THAT(status.error().text, HasSubstr("127.0.0.1")) << "what there is";
}

TEST_F(DdsSourceTest, TheSenderIsToldByNameAndAddress) {
  Live();
  ASSERT_TRUE(Start());
  ASSERT_TRUE(sink_.WaitForMore(50));
  const auto senders = source_->status().senders;
  ASSERT_EQ(senders.size(), 1u);
  EXPECT_EQ(senders.begin()->second, "\"simulated press\" at 127.0.0.1");
  EXPECT_EQ(senders.begin()->first, sink_.batches().back().writer);
}

TEST_F(DdsSourceTest, ASenderThatIsNotInTheListIsNotHeard) {
  options_.spec.senders = {"192.168.0.0/24"};
  Live();
  ASSERT_TRUE(Start());
  EXPECT_TRUE(Tells("is not among [live.dds] senders")) << source_->status().state.english;
  EXPECT_GT(source_->status().refused, 0);
  EXPECT_EQ(sink_.rows(), 0);
}

/// With certificates as scripts/dds_certificates.sh makes them.
class SecureDdsTest : public DdsSourceTest {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    for (const char* authority : {"ours", "strange"}) {
      const std::string command =
          fmt::format("'{}/scripts/dds_certificates.sh' '{}/{}' press service > /dev/null 2>&1",
                      HYDROSCOPE_SOURCE_DIR, folder_.string(), authority);
      if (std::system(command.c_str()) != 0)
        GTEST_SKIP() << "openssl is not installed; scripts/setup.sh installs it";
    }
    options_.spec.security = Folder("ours/service");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string Folder(const std::string& name) const { return (folder_ / name).string(); }
  void LiveWith(const std::string& security) {
    press_.Live(DdsNetwork{.domain = OwnDomain(),
                           .udp = true,
                           .shared_memory = false,
                           .interfaces = {"127.0.0.1"},
                           .peers = {},
                           .security = security});
  }
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / fmt::format("dds-security-{}", getpid());
};

TEST_F(SecureDdsTest, SendersOfTheSameAuthorityAreHeard) {
  LiveWith(Folder("ours/press"));
  ASSERT_TRUE(Start());
  EXPECT_TRUE(sink_.WaitForMore(50)) << source_->status().state.english;
}

TEST_F(SecureDdsTest, NeitherAStrangerNorSomebodyWithoutACertificateIsHeard) {
  for (const char* security : {"strange/press", ""}) {
    LiveWith(*security == 0 ? "" : Folder(security));
    ASSERT_TRUE(Start());
    EXPECT_FALSE(sink_.WaitForMore(1, 3)) << security;
    source_->Stop();
    press_.Kill();
  }
}

TEST_F(SecureDdsTest, AKeyThatEverybodyMayReadIsRefused) {
  std::filesystem::permissions(Folder("ours/service/key.pem"), std::filesystem::perms(0644));
  const Status status = Start();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().text, HasSubstr("may be read by every user"));
}

TEST_F(SecureDdsTest, AFileThatIsLackingIsNamed) {
  std::filesystem::remove(Folder("ours/service/permissions.smime"));
  const Status status = Start();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().text, HasSubstr("permissions.smime cannot be read"));
}

TEST_F(DdsSourceTest, APeerThatIsNoAddressIsRefused) {
  options_.spec.peers = {"press"};
  const Status status = Start();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().text, HasSubstr("\"press\" is no IPv4 address"));
}

}  // namespace
}  // namespace hydroscope
