#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace hydroscope::command_line_test {

inline const std::string kMachine = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/die_cushion.toml";

inline std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}
inline void WriteText(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A folder of its own for every test, removed afterwards.
class CommandLine : public testing::Test {
 protected:
  struct Ran {
    int exit_code = -1;
    std::string out, err;
    nlohmann::json Json() const { return nlohmann::json::parse(out, nullptr, false); }
  };

  void SetUp() override {
    std::string name = testing::TempDir() + "hydroscope_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name + "/";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string columns_ = "1000";  ///< of the terminal that the program believes in: lines stay whole

  std::string File(const std::string& name) const { return folder_ + name; }

  /// Starts the built program; stdout and stderr go to files of the test's folder.
  pid_t Start(const std::vector<std::string>& words) {
    const pid_t child = fork();
    if (child != 0) return child;
    setenv("COLUMNS", columns_.c_str(), 1);
    if (freopen(File("stdout").c_str(), "w", stdout) == nullptr) _exit(99);
    if (freopen(File("stderr").c_str(), "w", stderr) == nullptr) _exit(99);
    std::vector<std::string> kept = words;
    std::vector<char*> argv = {const_cast<char*>(HYDROSCOPE_BINARY)};
    for (std::string& word : kept) argv.push_back(word.data());
    argv.push_back(nullptr);
    execv(HYDROSCOPE_BINARY, argv.data());
    _exit(99);
  }
  Ran Run(const std::vector<std::string>& words) {
    int state = 0;
    waitpid(Start(words), &state, 0);
    return {WIFEXITED(state) ? WEXITSTATUS(state) : -1, ReadText(File("stdout")), ReadText(File("stderr"))};
  }

  /// A simulated press log in the test's folder; `more` are further options of `simulate press`.
  std::string Simulate(const std::string& name, int seconds, int seed,
                       const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {
        "simulate",          "press", "--out", File(name), "--seconds", std::to_string(seconds), "--seed",
        std::to_string(seed)};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = Run(words);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return File(name);
  }

 private:
  std::string folder_;
};

}  // namespace hydroscope::command_line_test
