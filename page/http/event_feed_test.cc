#include "page/http/event_feed.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

/// A reader and how often it was told to wait and woken.
struct Reader {
  std::uint64_t position = 0;
  int waits = 0, wakes = 0;
  EventFeed::Piece Read(EventFeed& feed, std::size_t most = 1000) {
    return feed.Read(
        position, most, [this] { ++waits; }, [this] { ++wakes; });
  }
};

TEST(EventFeed, GivesEveryReaderAllEvents) {
  EventFeed feed;
  Reader a, b;
  feed.Publish("1");
  EXPECT_EQ(a.Read(feed).text, "data: 1\n\n");
  feed.Publish("2");
  EXPECT_EQ(a.Read(feed).text, "data: 2\n\n");
  EXPECT_EQ(b.Read(feed).text, "data: 1\n\n");
  EXPECT_EQ(b.Read(feed).text, "data: 2\n\n");
}

TEST(EventFeed, WakesAReaderThatWaits) {
  EventFeed feed;
  Reader reader;
  EXPECT_EQ(reader.Read(feed).text, "");
  EXPECT_EQ(reader.waits, 1);
  EXPECT_EQ(reader.wakes, 0);
  feed.Publish("1");
  EXPECT_EQ(reader.wakes, 1);
  EXPECT_EQ(reader.Read(feed).text, "data: 1\n\n");
}

TEST(EventFeed, GivesNoMoreThanAskedFor) {
  EventFeed feed;
  Reader reader;
  feed.Publish("12345");
  EXPECT_EQ(reader.Read(feed, 8).text, "data: 12");
  EXPECT_EQ(reader.Read(feed, 8).text, "345\n\n");
}

TEST(EventFeed, KeepsABoundedAmountForAReaderThatStalls) {
  EventFeed feed(100);
  Reader stalled;
  for (int k = 0; k < 1000; ++k) feed.Publish(std::to_string(k));
  EXPECT_EQ(stalled.Read(feed).text, "\n\n");  // ends what it had of an event that is gone
  std::string rest;
  for (EventFeed::Piece piece = stalled.Read(feed); !piece.text.empty(); piece = stalled.Read(feed))
    rest += piece.text;
  EXPECT_LE(rest.size(), 100u);
  EXPECT_TRUE(rest.ends_with("data: 999\n\n"));
  EXPECT_TRUE(rest.starts_with("data: "));
}

TEST(EventFeed, EndsAfterTheLastEvent) {
  EventFeed feed;
  Reader reader;
  feed.Publish("1");
  feed.Close();
  EXPECT_FALSE(reader.Read(feed).ended);
  EXPECT_TRUE(reader.Read(feed).ended);
}

}  // namespace
}  // namespace hydroscope
