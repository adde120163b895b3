#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/result.h"

namespace hydroscope {

/// Exit codes scripts rely on (docs/command_line.md).
enum ExitCode { kDone = 0, kOwnFault = 1, kWrongUse = 2, kWrongInput = 3, kPartlyDone = 4 };

/// Prints the error to stderr and returns the exit code that belongs to its kind.
int ReportError(const Error& error);

/// Version of the JSON that commands write: grows when a key is renamed or taken away, not when one is added.
inline constexpr int kJsonSchema = 1;

/// Writes `document` to `path` ("-" is stdout), indented, with a final newline. Objects without a "schema" get kJsonSchema.
Status WriteJson(const std::string& path, nlohmann::json document);

/// Writes out what stdout still holds. Error: some of what was to stand there could not be written.
Status FinishStandardOutput();

/// Characters in a line for people: of the terminal, elsewhere COLUMNS of the environment, else 80.
std::size_t LineWidth();
/// The text for people, on stdout; longer lines are broken at blanks. Silent after BeQuiet.
void Say(const std::string& text);
/// The same on stderr, for what is said beside a result, and never silent.
void SayBeside(const std::string& text);
/// From now on Say and ProgressBar are silent; errors still go to stderr.
void BeQuiet();
bool IsQuiet();

/// While it lives, whatever is written to stdout is dropped after BeQuiet: of what prints tables without Say.
class DroppedOutput {
 public:
  DroppedOutput();
  ~DroppedOutput();
  DroppedOutput(const DroppedOutput&) = delete;
  DroppedOutput& operator=(const DroppedOutput&) = delete;

 private:
  int stdout_ = -1;  ///< where it goes to otherwise
};

/// Progress on stderr with rate and time left; silent when stderr is no terminal, and after BeQuiet.
class ProgressBar {
 public:
  /// `what` stands before the bar; `unit` is what the rate counts ("rows").
  ProgressBar(std::string what, std::string unit);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  /// `share` done 0...1, `count` units so far. Redraws at most ten times a second.
  void Update(double share, std::int64_t count);

 private:
  std::string what_, unit_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_, last_draw_;
};

}  // namespace hydroscope
