#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "core/result.h"
#include "host/output.h"

namespace hydroscope {

/// The exit code of what a command did; an error is told on stderr.
inline int ExitCodeOf(const Status& done) { return done ? kDone : ReportError(done.error()); }
inline int ExitCodeOf(const Result<ExitCode>& done) { return done ? *done : ReportError(done.error()); }

/// `run()` is what the command does: a Status, or an exit code where it may be done in part.
template <typename Run>
void RunsAs(CLI::App& command, int& exit_code, Run run) {
  command.callback([run = std::move(run), &exit_code] { exit_code = ExitCodeOf(run()); });
}

inline void AddJsonOption(CLI::App& command, std::string& path) {
  command.add_option("--json", path, "Write the result as JSON to this file; - is stdout");
}

/// The result for people, unless stdout is wanted for JSON, and as JSON where `json_path` is not "".
inline Status Answer(const std::string& text, const nlohmann::json& document, const std::string& json_path) {
  if (json_path != "-") Say(text);
  return json_path.empty() ? Status() : WriteJson(json_path, document);
}

}  // namespace hydroscope
