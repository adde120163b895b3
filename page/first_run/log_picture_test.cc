#include "page/first_run/log_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

TEST(Envelope, KeepsEverySpikeOfALongRow) {
  Envelope envelope(100);
  for (int k = 0; k < 1'000'000; ++k)
    envelope.Add(k == 654'321 ? 50.0 : k == 12'345 ? -50.0 : std::sin(0.01 * k));
  EXPECT_LE(envelope.low().size(), 100u);
  EXPECT_EQ(*std::min_element(envelope.low().begin(), envelope.low().end()), -50.0);
  EXPECT_EQ(*std::max_element(envelope.high().begin(), envelope.high().end()), 50.0);
  const std::size_t at =
      std::max_element(envelope.high().begin(), envelope.high().end()) - envelope.high().begin();
  EXPECT_EQ(at, 654'321 / envelope.rows_per_stretch());
}

TEST(Envelope, IsTheRowItselfWhereItIsShort) {
  Envelope envelope(4);
  for (const double value : {3.0, 1.0, 2.0}) envelope.Add(value);
  EXPECT_EQ(envelope.low(), (std::vector<double>{3, 1, 2}));
  EXPECT_EQ(envelope.rows_per_stretch(), 1u);
}

TEST(Envelope, ShowsStretchesWithoutAnyValueAsGaps) {
  Envelope envelope(4);
  for (int k = 0; k < 8; ++k) envelope.Add(k >= 2 && k < 4 ? NAN : 1.0 * k);
  ASSERT_EQ(envelope.low().size(), 4u);
  EXPECT_TRUE(std::isnan(envelope.low()[1]));
  EXPECT_EQ(envelope.high()[0], 1.0);
  EXPECT_EQ(envelope.low()[3], 6.0);
}

}  // namespace
}  // namespace hydroscope
