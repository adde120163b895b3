#include "host/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/cannot_write.h"
#include "core/json_text.h"
#include "core/printable.h"
#include "host/progress_listener.h"
#include "host/text_sink.h"
#include "host/wrapped_text.h"

namespace hydroscope {
namespace {

constexpr int kUsualWidth = 80, kLeastWidth = 40;  // characters

bool quiet = false;

ProgressListener& Listener() {
  static ProgressListener listener;
  return listener;
}

}  // namespace

int ReportError(const Error& error) {
  // Lines that begin with a blank quote a file, with a mark below a character of it.
  std::istringstream lines("hydroscope: " + PrintableLines(error.text));
  for (std::string line; std::getline(lines, line);)
    std::cerr << (line.starts_with(' ') ? line : WrappedText(line, LineWidth())) << "\n";
  switch (error.kind) {
    case ErrorKind::kUsage:
      return kWrongUse;
    case ErrorKind::kBadInput:
      return kWrongInput;
    case ErrorKind::kInternal:
      return kOwnFault;
  }
  return kOwnFault;
}

Status WriteJson(const std::string& path, nlohmann::json document) {
  const auto number = [](nlohmann::json& object) {
    if (object.is_object() && !object.contains("schema")) object["schema"] = kJsonSchema;
  };
  if (document.is_array())  // of several machines
    for (nlohmann::json& machine : document) number(machine);
  number(document);
  if (path == "-") {
    std::cout << JsonText(document, 2) << "\n";
    return {};
  }
  return WriteTextFile(path, JsonText(document, 2) + "\n");
}

Status FinishStandardOutput() {
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::cout && std::ferror(stdout) == 0) return {};
  // What failed may have failed long ago: one more byte tells why.
  if (errno == 0 && write(STDOUT_FILENO, "\n", 1) == 1) errno = EIO;
  return CannotWrite("to standard output", errno);
}

std::size_t LineWidth() {
  winsize window{};
  int width = kUsualWidth;
  if (isatty(STDOUT_FILENO) != 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0)
    width = window.ws_col;
  else if (const char* columns = std::getenv("COLUMNS"); columns != nullptr && std::atoi(columns) > 0)
    width = std::atoi(columns);
  return static_cast<std::size_t>(std::max(width, kLeastWidth));
}

void BeQuiet() { quiet = true; }
bool IsQuiet() { return quiet; }

DroppedOutput::DroppedOutput() {
  if (!quiet) return;
  std::cout.flush();
  std::fflush(stdout);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere < 0) return;
  stdout_ = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
  if (stdout_ >= 0) dup2(nowhere, STDOUT_FILENO);
  close(nowhere);
}

DroppedOutput::~DroppedOutput() {
  if (stdout_ < 0) return;
  std::cout.flush();
  std::fflush(stdout);
  dup2(stdout_, STDOUT_FILENO);
  close(stdout_);
}

void ListenToProgress(ProgressListener listener) { Listener() = std::move(listener); }

void Say(const std::string& text) {
  if (!quiet) std::cout << WrappedText(PrintableLines(text), LineWidth()) << std::flush;
}

void SayBeside(const std::string& text) { std::cerr << WrappedText(PrintableLines(text), LineWidth()); }

ProgressBar::ProgressBar(std::string what, std::string unit)
    : what_(std::move(what)),
      unit_(std::move(unit)),
      terminal_(!quiet && isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      last_draw_(start_) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::Update(double share, std::int64_t count) {
  if (!terminal_ && !Listener()) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_draw_ < std::chrono::milliseconds(100)) return;
  last_draw_ = now;
  if (Listener()) Listener()(what_, share);
  if (!terminal_) return;
  drawn_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double rate = static_cast<double>(count) / elapsed;
  const double left = share > 0 ? elapsed * (1 - share) / share : 0;
  const int full = static_cast<int>(share * 30);
  const std::string line = fmt::format("\r{} [{:=<{}}{: <{}}] {:3.0f} %  {:.3g} {}/s  {:.0f} s left\033[K",
                                       what_, "", full, "", 30 - full, share * 100, rate, unit_, left);
  std::fputs(line.c_str(), stderr);
}

}  // namespace hydroscope
