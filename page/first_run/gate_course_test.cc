#include "page/first_run/gate_course.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace hydroscope {
namespace {

constexpr double kPeriod = 0.01;  // s
constexpr int kBlock = 4, kReach = 2;

TEST(GateCourse, OfASignalIsTheMeanOfItsBlocks) {
  GateCourse course({"z", false, 1.5, std::nullopt}, 0, kBlock, kReach, kPeriod);
  for (int row = 0; row < 3 * kBlock; ++row) course.Add(row);
  const nlohmann::json json = course.Json("m");
  EXPECT_EQ(json["low"], nlohmann::json({1.5, 5.5, 9.5}));
  EXPECT_EQ(json["low"], json["high"]);
  EXPECT_EQ(json["min"], 1.5);
  EXPECT_TRUE(json["max"].is_null());
  EXPECT_DOUBLE_EQ(json["step"], kBlock * kPeriod);
}

TEST(GateCourse, OfARateIsItsSlopeAndNotKnownAtTheBegin) {
  GateCourse course({"z", true, std::nullopt, 0.0, true}, 0, kBlock, kReach, kPeriod);
  for (int row = 0; row < 10 * kBlock; ++row) course.Add(-3.0 * row * kPeriod);
  const nlohmann::json json = course.Json("m");
  ASSERT_EQ(json["low"].size(), 8u);
  EXPECT_TRUE(std::isnan(json["low"][0].get<double>()) && std::isnan(json["low"][1].get<double>()));
  for (std::size_t block = 2; block < 8; ++block)
    EXPECT_NEAR(json["low"][block].get<double>(), 3, 1e-9) << "the size of the slope";
}

}  // namespace
}  // namespace hydroscope
