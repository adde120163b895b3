#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <tuple>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "core/constants.h"
#include "core/interval_text.h"
#include "core/json_value.h"
#include "core/printable.h"
#include "host/output.h"
#include "live/live_status.h"
#include "live/service_socket.h"
#include "live/verify_live.h"
#include "storage/database.h"

namespace hydroscope {
namespace {

struct StatusArguments {
  std::string database, json, valve_check;
  bool valve_checks = false;
};

/// A value with its 95 % interval; "-" if there is none.
std::string Interval(const ValueWithStd& f) {
  return std::isfinite(f.value) ? WithInterval(f.value, kNormal95 * f.std) : "-";
}

/// The history of valve checks, from the database; no service is needed.
Result<ExitCode> RunValveChecks(const StatusArguments& a) {
  auto database = TRY(Database::OpenReadOnly(a.database));
  const auto names = TRY(database.MachineNames());
  nlohmann::json list = nlohmann::json::array();
  std::string text = fmt::format("{:<22} {:>13} {:<10} {:>18} {:>18} {:>20} {:>18}  {}\n", "axis", "time s",
                                 "outcome", "bandwidth Hz", "damping", "gain", "dead time ms", "");
  for (const std::string& name : names) {
    const auto machine = TRY(database.MachineId(name));
    const auto checks = TRY(database.ValveChecks(machine));
    for (const ValveCheckRecord& record : checks) {
      const ValveCheck& c = record.check;
      std::string conditions = record.detail;
      if (std::isfinite(c.supply_pressure))
        conditions = fmt::format("amplitude {:.3g}, supply {:.1f} bar, oil {:.1f} degC; {}", c.amplitude,
                                 c.supply_pressure * 1e-5, c.oil_temperature - 273.15, record.detail);
      const ValueWithStd milliseconds{c.dead_time.value * 1e3, c.dead_time.std * 1e3};
      text += fmt::format("{:<22} {:>13.1f} {:<10} {:>18} {:>18} {:>20} {:>18}  {}\n", name, c.time,
                          record.outcome, Interval(c.bandwidth), Interval(c.damping), Interval(c.gain),
                          Interval(milliseconds), conditions);
      nlohmann::json check = {
          {"axis", name}, {"time_s", c.time}, {"outcome", record.outcome}, {"detail", record.detail}};
      const auto put = [&](const std::string& key, double value) { check[key] = JsonNumber(value); };
      for (const auto& [figure, unit, value] : {std::tuple("f0", "_hz", c.natural_frequency),
                                                {"damping", "", c.damping},
                                                {"gain", "", c.gain},
                                                {"dead_time", "_s", c.dead_time},
                                                {"bandwidth", "_hz", c.bandwidth}}) {
        put(fmt::format("{}{}", figure, unit), value.value);
        put(fmt::format("{}_std{}", figure, unit), value.std);
      }
      put("amplitude", c.amplitude);
      put("supply_pressure", c.supply_pressure);
      put("oil_temperature", c.oil_temperature);
      list.push_back(std::move(check));
    }
  }
  TRY(Answer(text, {{"valve_checks", list}}, a.json));
  return kDone;
}

Result<ExitCode> RunStatus(const StatusArguments& a) {
  if (a.valve_checks) return RunValveChecks(a);
  const std::string socket = SocketOf(a.database);
  if (!a.valve_check.empty()) {
    const auto asked = TRY(AskService(socket, "POST", "/valve_check?axis=" + a.valve_check));
    Say("The controller will be asked for a valve sweep of " + Printable(a.valve_check) +
        "; `hydroscope status --valve-checks` shows what comes of it.\n");
    return kDone;
  }
  const auto answer = TRY(AskService(socket, "GET", "/status"));
  const auto status = nlohmann::json::parse(answer, nullptr, false);
  if (!status.is_object())
    return InternalError("the service's answer is no JSON; is it another version of the program?");
  TRY(Answer(StatusText(status), status, a.json));
  return status.at("writer").at("state") == "writing" ? kDone : kPartlyDone;
}

Result<ExitCode> RunVerify(const std::string& database, const std::string& json) {
  const auto runs = TRY(VerifyLive(database));
  nlohmann::json list = nlohmann::json::array();
  std::string text = fmt::format("{:<28} {:>5} {:>10} {:>8}  {}\n", "axis", "run", "rows", "stored",
                                 "replay of the raw window");
  std::int64_t same = 0, different = 0;
  for (const VerifiedRun& run : runs) {
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
  if (runs.empty())
    text = fmt::format("{} holds no run of a service: nothing to compare\n", database);
  else
    text += fmt::format("{} runs are the same to the last bit, {} differ, {} were not compared\n", same,
                        different, static_cast<std::int64_t>(runs.size()) - same - different);
  TRY(Answer(text, {{"runs", list}, {"same", same}, {"different", different}}, json));
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
  command->add_flag("--valve-checks", a->valve_checks, "History of valve checks, from the database");
  command->footer(
      "Exit code 4: the service runs but cannot write at present.\n"
      "Examples:\n"
      "  hydroscope status --db press.db\n"
      "  hydroscope status -d press.db --json - | jq .writer.state\n"
      "  hydroscope status -d press.db --request-valve-check cushion_1");
  RunsAs(*command, exit_code, [a] { return RunStatus(*a); });
}

void AddVerifyLiveCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<std::pair<std::string, std::string>>();
  CLI::App* command = app.add_subcommand(
      "verify-live",
      "Replays the raw window of live runs and compares with what the service stored, bit by bit");
  command->add_option("--db,-d", a->first, "Trend database of `hydroscope serve`")->required();
  AddJsonOption(*command, a->second);
  command->footer(
      "Exit code 1: a run differs; 4: there was nothing to compare.\n"
      "Example:\n  hydroscope verify-live --db press.db");
  RunsAs(*command, exit_code, [a] { return RunVerify(a->first, a->second); });
}

}  // namespace hydroscope
