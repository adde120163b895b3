#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "core/finite_number.h"
#include "estimation/linear_form/trajectory.h"
#include "host/output.h"
#include "host/text_sink.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

struct DesignArguments {
  std::string machine, out, json;
  std::vector<std::string> ranges;
  double speed = 0.5, acceleration = 1, row = 0.01;
  TrajectoryOptions options;
};

/// "q_1=-0.2:0.9": signal and range, SI.
Result<TrajectoryLimits> LimitsOf(const std::string& text, const DesignArguments& a) {
  const std::size_t equals = text.find('='), colon = text.find(':');
  if (equals != text.npos && colon != text.npos && equals < colon) {
    const auto low = FiniteNumber(text.substr(equals + 1, colon - equals - 1)),
               high = FiniteNumber(text.substr(colon + 1));
    if (low && high) return TrajectoryLimits{text.substr(0, equals), *low, *high, a.speed, a.acceleration};
  }
  return UsageError("--range '{}': write SIGNAL=LOW:HIGH in SI, e.g. q_1=-0.2:0.9", text);
}

std::string DesignText(const Trajectory& t) {
  std::string text = fmt::format(
      "Condition number of the scaled regressor {:.2f} (the first one drawn: {:.2f}).\nIt tells apart: {}.\n\n"
      "Each signal is its centre plus these sines and cosines, repeated every {:g} s:\n",
      t.condition, t.first_condition, fmt::join(t.shown, ", "), t.period);
  for (const SignalSeries& s : t.signals) {
    text += fmt::format("\n{:<8} centre {:>8.4f}\n  frequency       sine     cosine\n", s.signal, s.centre);
    for (std::size_t k = 0; k < s.sine.size(); ++k)
      text += fmt::format("  {:>6.3f} Hz   {:>8.4f}   {:>8.4f}\n", static_cast<double>(k + 1) / t.period,
                          s.sine[k], s.cosine[k]);
  }
  return text;
}

nlohmann::json DesignJson(const Trajectory& t) {
  nlohmann::json signals;
  for (const SignalSeries& s : t.signals)
    signals[s.signal] = {{"centre", s.centre}, {"sine", s.sine}, {"cosine", s.cosine}};
  return {{"period", t.period},
          {"condition", t.condition},
          {"first_condition", t.first_condition},
          {"tells_apart", t.shown},
          {"signals", signals}};
}

Status WriteTrajectory(const Trajectory& t, const std::string& path, double row) {
  std::string text = "t";
  for (const SignalSeries& s : t.signals) text += "," + s.signal;
  text += "\n";
  for (int k = 0; k * row < t.period; ++k) {
    text += fmt::format("{:.4f}", k * row);
    for (const SignalSeries& s : t.signals) text += fmt::format(",{:.6f}", s.Value(k * row, t.period));
    text += "\n";
  }
  return WriteTextFile(path, text);
}

Status RunDesign(const DesignArguments& a) {
  const auto machine = TRY(LoadMachine(a.machine));
  const LinearForm form = LinearFormOf(machine);
  if (form.equations.empty())
    return UsageError(
        "machine '{}': no trajectory is designed for machines of model \"{}\"; 'explain' says what to record of one",
        machine.name, KindOf(machine).id);
  std::vector<TrajectoryLimits> limits;
  for (const std::string& text : a.ranges) {
    const auto one = TRY(LimitsOf(text, a));
    limits.push_back(one);
  }
  const auto trajectory = TRY(DesignTrajectory(form, machine, limits, a.options));
  if (a.json != "-") Say(DesignText(trajectory));
  if (!a.out.empty()) TRY(WriteTrajectory(trajectory, a.out, a.row));
  return a.json.empty() ? Status{} : WriteJson(a.json, DesignJson(trajectory));
}

}  // namespace

void AddDesignCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<DesignArguments>();
  CLI::App* command = app.add_subcommand(
      "design", "What to record: a trajectory that tells the parameters of a machine apart best");
  command->add_option("--machine,-m", a->machine, "Machine file (TOML)")->required();
  command
      ->add_option("--range", a->ranges,
                   "Signal that is driven and its range SIGNAL=LOW:HIGH in SI, repeatable")
      ->required()
      ->type_name("RANGE")
      ->allow_extra_args(false);
  command->add_option("--speed", a->speed, "Largest speed, SI")
      ->check(CLI::Range(1e-4, 1e5))
      ->capture_default_str();
  command->add_option("--acceleration", a->acceleration, "Largest acceleration, SI")
      ->check(CLI::Range(1e-4, 1e5))
      ->capture_default_str();
  command->add_option("--period", a->options.period, "s after which it repeats")
      ->check(CLI::Range(2.0, 600.0))
      ->capture_default_str();
  command->add_option("--terms", a->options.terms, "Frequencies of each signal")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command->add_option("--row", a->row, "s between rows of --out")
      ->check(CLI::Range(1e-3, 1.0))
      ->capture_default_str();
  command->add_option("--seed", a->options.seed, "Seed of the search")->capture_default_str();
  command->add_option("--out", a->out, "Write one period as CSV; - is stdout")->type_name("FILE");
  AddJsonOption(*command, a->json);
  command->footer(
      "Example:\n"
      "  hydroscope design -m machines/manipulator.toml --range q_1=-0.15:0.85 --range q_2=-2.2:-1 --out plan.csv");
  RunsAs(*command, exit_code, [a] { return RunDesign(*a); });
}

}  // namespace hydroscope
