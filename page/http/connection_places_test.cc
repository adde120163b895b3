#include "page/http/connection_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace hydroscope {
namespace {

using Use = ConnectionPlaces::Use;
using testing::ElementsAre;
using testing::IsEmpty;

class ConnectionPlacesTest : public testing::Test {
 protected:
  /// The n-th connection, counted from 1; `left_` has those that had to leave.
  ConnectionPlaces::Id Open(Use use = Use::kNothing, const std::string& address = "10.0.0.1") {
    const int n = ++opened_;
    const auto id = places_.Opened(address, [this, n] { left_.push_back(n); });
    places_.Uses(id, use);
    return id;
  }
  ConnectionPlaces places_{{8, 8}};
  int opened_ = 0;
  std::vector<int> left_;
};

TEST_F(ConnectionPlacesTest, WhoAsksNothingGivesWayTheOldestFirst) {
  Open(Use::kUser);
  Open(Use::kGuest);
  for (int k = 0; k < 6; ++k) Open();
  EXPECT_THAT(left_, IsEmpty());
  Open();
  Open();
  EXPECT_THAT(left_, ElementsAre(3, 4));
}

TEST_F(ConnectionPlacesTest, AUserNeverGivesWayAndWhoComesLastIsSentAwayThen) {
  for (int k = 0; k < 8; ++k) Open(Use::kUser);
  Open();
  EXPECT_THAT(left_, ElementsAre(9));
}

TEST_F(ConnectionPlacesTest, GuestsGiveWayBeforeWhoHasJustCome) {
  for (int k = 0; k < 5; ++k) Open(Use::kGuest);
  Open(Use::kRests);
  Open(Use::kUserRests);
  Open();
  Open();
  EXPECT_THAT(left_, ElementsAre(6)) << "between two requests";
  Open();
  EXPECT_THAT(left_, ElementsAre(6, 8)) << "three that ask nothing are too many";
}

TEST_F(ConnectionPlacesTest, OnesThatLeftOrAreClosedTakeNoPlace) {
  std::vector<ConnectionPlaces::Id> ids;
  for (int k = 0; k < 9; ++k) ids.push_back(Open());
  EXPECT_THAT(left_, ElementsAre(1));
  places_.Closed(ids[1]);
  Open();
  EXPECT_THAT(left_, ElementsAre(1)) << "the second one made room";
  Open();
  EXPECT_THAT(left_, ElementsAre(1, 3));
}

TEST(ConnectionPlacesOfAnAddress, GiveWayAmongThemselves) {
  ConnectionPlaces places({100, 4});
  std::vector<int> left;
  for (int k = 0; k < 3; ++k) places.Opened("10.0.0.2", [&] { left.push_back(-1); });
  for (int k = 0; k < 6; ++k) places.Opened("10.0.0.1", [&left, k] { left.push_back(k); });
  EXPECT_THAT(left, ElementsAre(0, 1));
}

}  // namespace
}  // namespace hydroscope
