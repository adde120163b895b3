#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace hydroscope {

/// A line on stderr that says what is being done and for how long, where nobody knows how much there is to do. Silent where
/// ProgressBar is: when stderr is no terminal, and after BeQuiet.
class WorkLine {
 public:
  /// `task` stands before what is being done.
  explicit WorkLine(std::string task);
  ~WorkLine();
  WorkLine(const WorkLine&) = delete;
  WorkLine& operator=(const WorkLine&) = delete;
  /// What is being done from now on. Any thread may tell.
  void Tell(std::string what);
  /// Tells it what it hears; this line must outlive it.
  auto Listener() {
    return [this](const std::string& what) { Tell(what); };
  }

 private:
  void Draw() const;

  const std::string task_;
  const std::chrono::steady_clock::time_point start_;
  std::mutex mutex_;
  std::condition_variable_any told_;
  std::string what_;
  std::jthread clock_;  ///< draws the line again each second
};

}  // namespace hydroscope
