#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/bode_plot.h"
#include "cli/command_answer.h"
#include "cli/commands.h"
#include "host/output.h"
#include "host/text_sink.h"
#include "workbench/frequency_response/loop_output.h"
#include "workbench/frequency_response/valve_output.h"

namespace hydroscope {
namespace {

struct FrfArguments {
  std::string log, machine, json, svg, method = "auto";
  double settle = -1;
  FrequencyResponseOptions options;
};

FrequencyResponseMethod MethodOf(const std::string& name) {
  if (name == "sine") return FrequencyResponseMethod::kSine;
  return name == "welch" ? FrequencyResponseMethod::kWelch : FrequencyResponseMethod::kAuto;
}

/// A machine that is measured in closed loop.
Result<ExitCode> RunClosedLoop(const FrfArguments& a, const Machine& machine) {
  if (a.method == "sine" || a.settle >= 0)
    return UsageError(
        "{}: a machine in closed loop is measured with noise on its set point; "
        "--method sine and --settle are for valves",
        a.machine);
  LoopOptions options{a.options.segment_length, a.options.min_coherence, a.options.lowest, a.options.highest};
  const auto measured = TRY(MeasureLoopLog(a.log, machine, options));
  TRY(Answer(LoopText(measured, machine), LoopJson(measured, machine), a.json));
  if (!a.svg.empty()) TRY(WriteTextFile(a.svg, LoopBodePlot(measured, machine.name)));
  return measured.response.fit && measured.log.left_out == 0 ? kDone : kPartlyDone;
}

Result<ExitCode> RunFrf(const FrfArguments& a) {
  const auto machine = TRY(LoadMachine(a.machine));
  if (ClosedLoopOf(machine) != nullptr) return RunClosedLoop(a, machine);
  FrequencyResponseOptions options = a.options;
  options.method = MethodOf(a.method);
  if (a.settle >= 0) options.settle_time = a.settle;
  const auto measured = TRY(MeasureValveLog(a.log, machine, options));
  TRY(Answer(ValveText(measured, machine), ValveJson(measured, machine), a.json));
  if (!a.svg.empty()) {
    const std::string title =
        fmt::format("{}: {} to {}", machine.name, machine.valve.input, machine.valve.output);
    TRY(WriteTextFile(a.svg, ValveBodePlot(measured, title)));
  }
  return measured.Complete() ? kDone : kPartlyDone;
}

}  // namespace

void AddFrfCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<FrfArguments>();
  CLI::App* command =
      app.add_subcommand("frf",
                         "Frequency response of the valve from a sweep, chirp or noise and its "
                         "second-order model, or of a test cylinder in closed loop");
  command->add_option("LOG", a->log, "Log with command and response (CSV, CSV.gz or MAT)")->required();
  command
      ->add_option("--machine,-m", a->machine,
                   "Machine file (TOML); of a valve its [valve] table names command and response")
      ->required();
  AddJsonOption(*command, a->json);
  command->add_option("--svg", a->svg, "Write a Bode plot to this file");
  command
      ->add_option(
          "--method", a->method,
          "auto: look at the command; sine: frequencies held one after the other; welch: chirp or noise")
      ->check(CLI::IsMember({"auto", "sine", "welch"}))
      ->capture_default_str();
  command->add_option("--segment", a->options.segment_length,
                      "welch: samples per segment, even; longer: finer in frequency, fewer averages "
                      "(default: 1/8 of the log)");
  command
      ->add_option("--min-coherence", a->options.min_coherence, "welch: points below are left out of the fit")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--from", a->options.lowest, "Hz: points below are left out of the fit")
      ->check(CLI::Range(0.0, 1e5));
  command->add_option("--to", a->options.highest, "Hz: points above are left out of the fit")
      ->check(CLI::Range(1e-4, 1e5));
  command
      ->add_option("--settle", a->settle,
                   "sine: s to leave out after each change of frequency (default: found from the response)")
      ->check(CLI::Range(0.0, 1e5));
  command->footer(
      "Exit code 4: some frequencies or rows had to be left out, or there are too few "
      "for a model; they are listed.\n"
      "Examples:\n"
      "  hydroscope simulate valve --out sweep.csv\n"
      "  hydroscope frf sweep.csv --machine machines/valve_sweep.toml\n"
      "  hydroscope frf sweep.csv -m machines/valve_sweep.toml --json valve.json --svg bode.svg\n"
      "  hydroscope frf sweep.csv -m machines/valve_sweep.toml --from 20 --to 120\n"
      "  hydroscope frf cylinder.csv -m machines/test_cylinder.toml --json cylinder.json --svg bode.svg\n"
      "  hydroscope frf chirp_0A.txt -m machines/servo_press_chirp.toml --method welch --segment 4096");
  RunsAs(*command, exit_code, [a] { return RunFrf(*a); });
}

}  // namespace hydroscope
