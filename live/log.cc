#include "live/log.h"

#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/json_text.h"

namespace hydroscope {
namespace {

constexpr std::size_t kLinesKept = 100;

bool as_json = false;

/// Holds the newest lines.
const std::shared_ptr<spdlog::sinks::ringbuffer_sink_mt>& Kept() {
  static const auto kept = std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(kLinesKept);
  return kept;
}

spdlog::logger& Log() {
  static const std::shared_ptr<spdlog::logger> log = [] {
    auto made = spdlog::stderr_logger_mt("hydroscope");
    made->sinks().push_back(Kept());
    made->set_level(spdlog::level::warn);  // libraries and tests; the service says what it wants
    return made;
  }();
  return *log;
}

/// key=value; a value with blanks or quotes is quoted.
std::string Line(const char* event, const LogFields& fields) {
  if (as_json) {
    nlohmann::json json = {{"event", event}};
    for (const auto& [key, value] : fields) json[key] = value;
    std::string text = JsonText(json);
    return text.substr(1, text.size() - 2);
  }
  std::string line = event;
  for (const auto& [key, value] : fields) {
    const bool plain = !value.empty() &&
                       std::none_of(value.begin(), value.end(), [](char c) { return c <= ' ' || c == '"'; });
    line += fmt::format(" {}={}", key, plain ? value : JsonText(value));
  }
  return line;
}

void Write(spdlog::level::level_enum level, const char* event, const LogFields& fields) {
  if (Log().should_log(level)) Log().log(level, Line(event, fields));
}

}  // namespace

Status ConfigureLog(const std::string& level, bool json) {
  const auto parsed = spdlog::level::from_str(level);
  if (parsed == spdlog::level::off && level != "off")
    return UsageError("log level \"{}\" is not known; expected debug, info, warning, error or off", level);
  as_json = json;
  Log().set_level(parsed);
  Log().flush_on(spdlog::level::debug);
  if (json)
    Log().set_pattern(R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%v})", spdlog::pattern_time_type::utc);
  else if (std::getenv("JOURNAL_STREAM") != nullptr)
    Log().set_pattern("%l %v");
  else
    Log().set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
  return {};
}

std::vector<LogLine> NewestLogLines() {
  std::vector<LogLine> lines;
  for (const spdlog::details::log_msg_buffer& line : Kept()->last_raw()) {
    const auto level = spdlog::level::to_string_view(line.level);
    lines.push_back({std::chrono::duration<double>(line.time.time_since_epoch()).count(),
                     std::string(level.begin(), level.end()),
                     std::string(line.payload.begin(), line.payload.end())});
  }
  return lines;
}

void LogInfo(const char* event, const LogFields& fields) { Write(spdlog::level::info, event, fields); }
void LogWarning(const char* event, const LogFields& fields) { Write(spdlog::level::warn, event, fields); }
void LogError(const char* event, const LogFields& fields) { Write(spdlog::level::err, event, fields); }

}  // namespace hydroscope
