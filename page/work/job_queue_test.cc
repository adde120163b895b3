#include "page/work/job_queue.h"

#include <gtest/gtest.h>

#include <future>
#include <nlohmann/json.hpp>

namespace hydroscope {
namespace {

TEST(JobQueue, WhatIsDoneInAMomentDoesNotWaitForLongWork) {
  EventFeed feed;
  std::promise<void> leave, began, promoted;
  JobQueue jobs(feed);
  const auto explain = jobs.Add("explain", "", [&]() -> Status {
    began.set_value();
    leave.get_future().wait();
    return {};
  });
  ASSERT_TRUE(explain);
  began.get_future().wait();
  const auto promote = jobs.Add(
      "promote", "",
      [&]() -> Status {
        promoted.set_value();
        return {};
      },
      JobQueue::Length::kShort);
  ASSERT_TRUE(promote);
  EXPECT_EQ(promoted.get_future().wait_for(std::chrono::seconds(60)), std::future_status::ready);
  EXPECT_EQ(jobs.Json()[0]["state"], "running");
  leave.set_value();
}

}  // namespace
}  // namespace hydroscope
