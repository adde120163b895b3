#include "host/work_line.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>

namespace hydroscope {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

/// A terminal in place of stderr while it lives.
class TerminalForStderr {
 public:
  TerminalForStderr() : terminal_(posix_openpt(O_RDWR | O_NOCTTY)), stderr_(dup(STDERR_FILENO)) {
    EXPECT_EQ(grantpt(terminal_), 0);
    EXPECT_EQ(unlockpt(terminal_), 0);
    const int shown = open(ptsname(terminal_), O_RDWR | O_NOCTTY);
    dup2(shown, STDERR_FILENO);
    close(shown);
  }
  ~TerminalForStderr() {
    dup2(stderr_, STDERR_FILENO);
    close(stderr_);
    close(terminal_);
  }
  /// What was written so far.
  std::string Shown() const {
    std::array<char, 4096> text{};
    const ssize_t size = read(terminal_, text.data(), text.size());
    return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
  }

 private:
  int terminal_, stderr_;
};

TEST(WorkLine, SaysOnATerminalWhatIsBeingDoneAndLeavesNothing) {
  const TerminalForStderr terminal;
  {
    WorkLine line("explain");
    line.Tell("all effects: 2 of 6");
  }
  const std::string shown = terminal.Shown();
  EXPECT_THAT(shown, HasSubstr("explain: all effects: 2 of 6  0 s"));
  EXPECT_THAT(shown, EndsWith("\r\033[K"));
}

TEST(WorkLine, IsSilentWhereStderrIsNoTerminal) {
  testing::internal::CaptureStderr();
  {
    WorkLine line("explain");
    line.Tell("all effects: 2 of 6");
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace hydroscope
