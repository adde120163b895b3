// What only the DDS source does: late joiners, deadline, watchdog, settings that can never work.
#include "acquisition/dds/dds_source.h"

#include <gmock/gmock.h>

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
    return WaitUntil([&] { return source_->status().state.find(state) != std::string::npos; });
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

TEST_F(DdsSourceTest, ASenderThatFallsSilentIsLateAndIsHeardAgain) {
  Live();
  ASSERT_TRUE(Start());
  ASSERT_TRUE(sink_.WaitForMore(50));
  ASSERT_TRUE(press_.server().Do(MuteCommand{true}));
  EXPECT_TRUE(Tells("no batches in time")) << source_->status().state;
  ASSERT_TRUE(press_.server().Do(MuteCommand{false}));
  EXPECT_TRUE(sink_.WaitForMore(50));
  EXPECT_TRUE(Tells("receiving"));
  EXPECT_GT(source_->status().lost_rows, 0) << "what was not sent is told by the numbers";
}

TEST_F(DdsSourceTest, TheWatchdogBuildsItAnewAndItStillHears) {
  options_.deaf_after = 0.1;
  ASSERT_TRUE(Start());
  ASSERT_TRUE(WaitUntil([&] { return source_->status().reconnects >= 3; }));
  Live();
  EXPECT_TRUE(sink_.WaitForMore(50)) << source_->status().state;
}

TEST_F(DdsSourceTest, AChannelThatIsNotAnnouncedIsNamed) {
  options_.wanted.push_back("middle/p_A");
  Live();
  ASSERT_TRUE(Start());
  EXPECT_TRUE(sink_.WaitForMore(20)) << "the others come all the same";
  EXPECT_TRUE(Tells("but not middle/p_A")) << source_->status().state;
}

TEST_F(DdsSourceTest, AnAddressThatIsNotOursIsRefused) {
  options_.spec.interfaces = {"203.0.113.7"};
  const Status status = Start();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().text, HasSubstr("203.0.113.7"));
  EXPECT_THAT(status.error().text, HasSubstr("127.0.0.1")) << "what there is";
}

TEST_F(DdsSourceTest, APeerThatIsNoAddressIsRefused) {
  options_.spec.peers = {"press"};
  const Status status = Start();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().text, HasSubstr("\"press\" is no IPv4 address"));
}

}  // namespace
}  // namespace hydroscope
