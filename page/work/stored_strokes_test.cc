#include "page/work/stored_strokes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(KeptStrokes, OfNoDatabaseAreAnError) {
  const auto none = FindKeptStrokes(testing::TempDir() + "no_such.db", {"a", 0, 1});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text, testing::HasSubstr("no_such.db"));
}

}  // namespace
}  // namespace hydroscope
