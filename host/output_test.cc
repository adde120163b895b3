#include "host/output.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(Output, ControlCharactersOfWhatWasReadAreWrittenOutAndLineEndsStay) {
  testing::internal::CaptureStderr();
  ReportError({ErrorKind::kBadInput, "columns found: '\x1b[31mt', 'p\a'\nexpected 't'"});
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "hydroscope: columns found: '\\x1b[31mt', 'p\\x07'\nexpected 't'\n");
  testing::internal::CaptureStdout();
  Say("column \x1b[2J\nnext\n");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "column \\x1b[2J\nnext\n");
}

}  // namespace
}  // namespace hydroscope
