#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "service/commands.h"
#include "service/live/http_endpoint.h"
#include "service/live/live_status.h"
#include "service/live/verify_live.h"
#include "service/output.h"

namespace hydroscope {
namespace {

struct StatusArguments {
  std::string database, json, valve_check;
};

int RunStatus(const StatusArguments& a) {
  const std::string socket = SocketOf(a.database);
  if (!a.valve_check.empty()) {
    const auto asked = AskService(socket, "POST", "/valve_check?axis=" + a.valve_check);
    if (!asked) return ReportError(asked.error());
    std::cout << "The controller will be asked for a valve sweep of " << a.valve_check
              << "; `hydroscope status` and `hydroscope trends` show what comes of it.\n";
    return kDone;
  }
  const auto answer = AskService(socket, "GET", "/status");
  if (!answer) return ReportError(answer.error());
  const auto status = nlohmann::json::parse(*answer, nullptr, false);
  if (!status.is_object())
    return ReportError(
        {ErrorKind::kInternal, "the service's answer is no JSON; is it another version of the program?"});
  if (a.json != "-") std::cout << StatusText(status);
  if (!a.json.empty())
    if (const Status written = WriteJson(a.json, status); !written) return ReportError(written.error());
  return status.at("writer").at("state") == "writing" ? kDone : kPartlyDone;
}

int RunVerify(const std::string& database, const std::string& json) {
  const auto runs = VerifyLive(database);
  if (!runs) return ReportError(runs.error());
  nlohmann::json list = nlohmann::json::array();
  std::string text = fmt::format("{:<28} {:>5} {:>10} {:>8}  {}\n", "axis", "run", "rows", "strokes",
                                 "replay of the raw window");
  std::int64_t same = 0, different = 0;
  for (const VerifiedRun& run : *runs) {
    using enum VerifiedRun::Outcome;
    const std::string outcome = run.outcome == kSame      ? "the same to the last bit"
                                : run.outcome == kDiffers ? "DIFFERS: " + run.detail
                                                          : "not compared: " + run.detail;
    same += run.outcome == kSame;
    different += run.outcome == kDiffers;
    text += fmt::format("{:<28} {:>5} {:>10} {:>8}  {}\n", run.axis, run.run, run.rows, run.strokes, outcome);
    list.push_back({{"axis", run.axis},
                    {"run", run.run},
                    {"rows", run.rows},
                    {"strokes", run.strokes},
                    {"same", run.outcome == kSame},
                    {"compared", run.outcome != kNotKept},
                    {"detail", run.detail}});
  }
  text += fmt::format("{} runs are the same to the last bit, {} differ, {} were not compared\n", same,
                      different, static_cast<std::int64_t>(runs->size()) - same - different);
  if (json != "-") std::cout << text;
  if (!json.empty())
    if (const Status written = WriteJson(json, {{"runs", list}, {"same", same}, {"different", different}});
        !written)
      return ReportError(written.error());
  if (different > 0) return kOwnFault;
  return same > 0 ? kDone : kPartlyDone;
}

}  // namespace

void AddStatusCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<StatusArguments>();
  CLI::App* command = app.add_subcommand(
      "status", "What a running `hydroscope serve` does: sources, rates, ages, queues, disk");
  command->add_option("--db,-d", a->database, "Database the service writes")->required();
  command->add_option("--json", a->json, "Write everything as JSON to this file; - is stdout");
  command->add_option("--request-valve-check", a->valve_check,
                      "Ask the controller for a valve sweep of this axis");
  command->footer(
      "Exit code 4: the service runs but cannot write at present.\n"
      "Examples:\n"
      "  hydroscope status --db press.db\n"
      "  hydroscope status -d press.db --json - | jq .writer.state\n"
      "  hydroscope status -d press.db --request-valve-check cushion_1");
  command->callback([a, &exit_code] { exit_code = RunStatus(*a); });
}

void AddVerifyLiveCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<std::pair<std::string, std::string>>();
  CLI::App* command = app.add_subcommand(
      "verify-live",
      "Replays the raw window of live runs and compares with what the service stored, bit by bit");
  command->add_option("--db,-d", a->first, "Trend database of `hydroscope serve`")->required();
  command->add_option("--json", a->second, "Write the result as JSON to this file; - is stdout");
  command->footer(
      "Exit code 1: a run differs; 4: there was nothing to compare.\n"
      "Example:\n  hydroscope verify-live --db press.db");
  command->callback([a, &exit_code] { exit_code = RunVerify(a->first, a->second); });
}

}  // namespace hydroscope
