#include "workbench/explain/untested_text.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(UntestedText, EffectsWithOneReasonStandTogetherAndTheReasonOnce) {
  EXPECT_EQ(UntestedText({{"leak", "the pressure hardly moved"},
                          {"drag", "too slow"},
                          {"relief", "the pressure hardly moved"}},
                         "strokes"),
            "\nCannot be tested with these strokes (which does not mean absent)\n"
            "  leak, relief\n    the pressure hardly moved\n"
            "  drag                         too slow\n");
  EXPECT_EQ(UntestedText({}, "episodes"), "");
}

}  // namespace
}  // namespace hydroscope
