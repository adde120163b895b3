#include "alarms/feeds/sparkplug/primary_host.h"

#include <gtest/gtest.h>

namespace hydroscope::sparkplug {
namespace {

TEST(PrimaryHost, WithoutAnIdNobodyIsWaitedFor) { EXPECT_TRUE(PrimaryHost("").online()); }

TEST(PrimaryHost, IsThereFromItsOnlineToItsWill) {
  PrimaryHost host("scada");
  EXPECT_EQ(host.Topic(), "spBv1.0/STATE/scada");
  EXPECT_FALSE(host.online());
  EXPECT_TRUE(host.Take(R"({"online": true, "timestamp": 1000})"));
  EXPECT_TRUE(host.online());
  EXPECT_TRUE(host.Take(R"({"online": false, "timestamp": 1000})"))
      << "a will carries the time of its session";
  EXPECT_FALSE(host.online());
}

TEST(PrimaryHost, AWillOfAnEarlierSessionSaysNothing) {
  PrimaryHost host("scada");
  host.Take(R"({"online": true, "timestamp": 2000})");
  EXPECT_FALSE(host.Take(R"({"online": false, "timestamp": 1999})"));
  EXPECT_TRUE(host.online());
  host.Forget();
  EXPECT_FALSE(host.online()) << "a new connection knows nothing yet";
  EXPECT_TRUE(host.Take(R"({"online": false, "timestamp": 1999})"));
}

TEST(PrimaryHost, WhatIsNoStateChangesNothing) {
  PrimaryHost host("scada");
  host.Take(R"({"online": true, "timestamp": 1})");
  for (const char* payload :
       {"", "OFFLINE", "null", "[]", "{}", R"({"online": false})", R"({"timestamp": 2})",
        R"({"online": 0, "timestamp": 2})", R"({"online": false, "timestamp": "2"})",
        R"({"online": false, "timestamp": 2)"})
    EXPECT_FALSE(host.Take(payload)) << payload;
  EXPECT_TRUE(host.online());
}

}  // namespace
}  // namespace hydroscope::sparkplug
