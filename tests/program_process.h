#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <vector>

#include "tests/command_line_fixture.h"
#include "tests/live_fixture.h"

namespace hydroscope::command_line_test {

/// The program with its stdin in our hands and its stdout in a file.
class Program {
 public:
  Program(std::vector<std::string> words, const std::string& out) : out_(out) {
    int ends[2];
    EXPECT_EQ(pipe2(ends, O_CLOEXEC), 0);
    words.insert(words.begin(), HYDROSCOPE_BINARY);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    child_ = fork();
    if (child_ == 0) {
      dup2(ends[0], STDIN_FILENO);
      if (freopen(out.c_str(), "w", stdout) == nullptr) _exit(99);
      if (freopen((out + ".err").c_str(), "w", stderr) == nullptr) _exit(99);
      execv(HYDROSCOPE_BINARY, argv.data());
      _exit(99);
    }
    close(ends[0]);
    input_ = ends[1];
  }
  ~Program() {
    if (child_ > 0) Kill(SIGKILL);
    close(input_);
  }

  void Say(const std::string& line) {
    const std::string text = line + "\n";
    EXPECT_EQ(write(input_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  bool WaitFor(const std::string& answer) const {
    return WaitUntil([&] { return ReadText(out_).find(answer) != std::string::npos; });
  }
  int Wait() {
    int state = 0;
    waitpid(child_, &state, 0);
    child_ = 0;
    return WIFEXITED(state) ? WEXITSTATUS(state) : -1;
  }
  int Kill(int signal) {
    kill(child_, signal);
    return Wait();
  }

 private:
  std::string out_;
  pid_t child_ = 0;
  int input_ = -1;
};

}  // namespace hydroscope::command_line_test
