#include "workbench/check_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/counted_words.h"
#include "core/interval_text.h"
#include "core/json_value.h"
#include "core/relative_change.h"
#include "core/shell_word.h"
#include "core/short_number.h"
#include "core/shown_width.h"
#include "core/units.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "models/parameter_unit.h"
#include "workbench/explain/headline.h"
#include "workbench/fit_output.h"
#include "workbench/identifiability.h"
#include "workbench/model/model_record.h"

namespace hydroscope {
namespace {

constexpr double kLeastJitter = 1e-7;  // s; less is rounding of the time stamps

std::string Dash(std::string_view unit) { return unit == "1" || unit.empty() ? "-" : std::string(unit); }

/// Flags of the time stamp are the same in every signal; they are told once.
constexpr Quality kTimeFlags =
    quality::kGap | quality::kTimeBackwards | quality::kClockJump | quality::kDuplicate | quality::kLate;

std::string FlagText(const SignalRange& range, Quality which) {
  std::string text;
  for (const auto& [flag, name] : quality::kFlagNames)
    for (std::size_t bit = 0; bit < range.flagged.size(); ++bit)
      if (flag == 1u << bit && (flag & which) != 0 && range.flagged[bit] > 0)
        text += fmt::format("{}{} x {}, first at {:.4g} s", text.empty() ? "" : "; ", range.flagged[bit],
                            name, range.first[bit]);
  return text;
}

std::string SignalFlags(const CheckedSignal& signal) {
  if (!signal.present) return "not in this log (optional)";
  const std::string text = FlagText(signal.range, static_cast<Quality>(~kTimeFlags));
  return text.empty() ? "" : "flagged: " + text;
}

std::string Sampling(const CheckResult& check) {
  const TimeSurvey& t = check.time;
  std::string text = fmt::format("{}: {} rows, {:.4g} s of data at {:.4g} ms ({:.4g} Hz)", check.log, t.rows,
                                 static_cast<double>(t.rows) * check.sample_period, check.sample_period * 1e3,
                                 1 / check.sample_period);
  text += t.jitter > kLeastJitter ? fmt::format(", jitter {:.2g} ms", t.jitter * 1e3) : ", no jitter";
  text += t.gaps > 0 ? fmt::format(", gaps: {}, the longest {:.4g} s", t.gaps, t.longest_gap) : ", no gaps";
  if (t.not_forward > 0) text += fmt::format(", steps not forward in time: {}", t.not_forward);
  text += "\n";
  if (!check.time_base.empty()) text += check.time_base.english + "\n";
  for (const CheckedSignal& signal : check.signals) {
    const std::string flags = FlagText(signal.range, kTimeFlags);
    if (!signal.present || flags.empty()) continue;
    text += fmt::format("time stamps: {}\n", flags);
    break;
  }
  const RunSummary& s = check.pass.summary;
  if (s.rejected_rows > 0) text += Counted(s.rejected_rows, "row") + " could not be read\n";
  if (!s.stopped.empty()) text += fmt::format("read up to row {}, then: {}\n", s.rows, s.stopped);
  for (const LogFinding& finding : s.findings) text += "  " + FindingText(finding) + "\n";
  return text;
}

/// A cell of a table, and what did not fit it as a line below.
std::string Cell(const std::string& text, std::size_t width, const char* what, std::string& below) {
  const std::size_t shown = ShownWidth(text);
  if (shown > width) below += fmt::format("    {}: {}\n", what, text);
  return shown > width ? std::string(width, '.') : text + std::string(width - shown, ' ');
}

/// Widths of the columns of names: together what the numbers leave of a line.
struct NameWidths {
  std::size_t signal = 6, column = 6;
};

NameWidths WidthsOf(const std::vector<CheckedSignal>& signals, std::size_t numbers) {
  NameWidths widest;
  for (const CheckedSignal& s : signals) {
    widest.signal = std::max(widest.signal, ShownWidth(s.spec.name));
    widest.column = std::max(widest.column, ShownWidth(s.spec.column));
  }
  const std::size_t left = kLineWidth - std::min(numbers, kLineWidth);
  widest.signal = std::min(widest.signal, left / 2);
  widest.column = std::min(widest.column, left - widest.signal);
  return widest;
}

std::string Signals(const CheckResult& check) {
  constexpr std::size_t kNumbers = 48;  // characters of a row but its names and its unit
  std::size_t unit_width = 4;
  for (const CheckedSignal& s : check.signals)
    unit_width = std::max(unit_width, ShownWidth(Dash(ShownUnit(check.machine, s.spec.name).name)));
  const NameWidths width = WidthsOf(check.signals, kNumbers + unit_width);
  std::string text =
      fmt::format("\n{:<{}} {:<{}} {:>10} {:>10} {:>10}  {:<{}} {:>8}\n", "signal", width.signal, "column",
                  width.column, "lowest", "highest", "noise std", "unit", unit_width, "good");
  for (const CheckedSignal& s : check.signals) {
    const DisplayUnit unit = ShownUnit(check.machine, s.spec.name);
    const auto number = [&](double si, double offset) {
      return std::isfinite(si) ? ShortNumber(si * unit.factor + offset, 4) : std::string("-");
    };
    const double good = 100.0 * static_cast<double>(s.range.good) /
                        static_cast<double>(std::max<std::int64_t>(1, check.time.rows));
    std::string below;
    const std::string signal = Cell(s.spec.name, width.signal, "signal", below);
    const std::string column = Cell(s.spec.column, width.column, "column", below);
    text += fmt::format("{} {} {:>10} {:>10} {:>10}  {:<{}} {:>8}\n", signal, column,
                        number(s.range.min, unit.offset), number(s.range.max, unit.offset),
                        s.present ? number(s.noise_std, 0) : "-", Dash(unit.name), unit_width,
                        s.present ? fmt::format("{:.4g} %", std::floor(good * 100) / 100) : "-");
    text += below;
    if (const std::string flags = SignalFlags(s); !flags.empty()) text += fmt::format("    {}\n", flags);
  }
  return text;
}

std::string Gate(const CheckResult& check) {
  const Driving& d = check.driving;
  const RunSummary& s = check.pass.summary;
  std::string text = fmt::format(
      "\ngate: {} of {} rows inside ({:.1f} %), {}", s.gated, s.rows,
      100.0 * static_cast<double>(s.gated) / static_cast<double>(std::max<std::int64_t>(1, s.rows)),
      Counted(d.strokes, "stroke"));
  if (d.too_short > 0)
    text += fmt::format(", {} more shorter than {:g} s", d.too_short, check.machine.gate.min_stroke);
  text += "\n";
  for (const ConditionSurvey& c : check.conditions)
    text += fmt::format("  {:<34} holds in {:5.1f} % of the log\n", c.condition, 100 * c.share);
  if (d.strokes > 0) {
    for (const ConditionRange& range : d.ranges)
      text += fmt::format("  {:<34} {}\n", range.condition.title.english, range.Text().english);
    if (std::isfinite(d.oil_min))
      text += fmt::format("  oil temperature                    {:.1f} to {:.1f} °C\n",
                          d.oil_min - kZeroCelsius, d.oil_max - kZeroCelsius);
  }
  return text;
}

DisplayUnit UnitOf(const CheckResult& check, const CheckedParameter& p) {
  return ParameterUnit(KindOf(check.machine), p.estimate.parameter, p.estimate.unit);
}

/// What makes the figures impossible; of a model with states its warnings say that.
Told ImpossibleOf(const CheckResult& check) {
  return KindOf(check.machine).has_states ? Told{} : ImpossibleFigures(check.figures);
}

std::string Identification(const CheckResult& check) {
  if (KindOf(check.machine).has_states && check.parameters.empty())
    return fmt::format("\nno fit: {}\n", check.no_fit);
  if (MeasuredByResponse(KindOf(check.machine)) && !check.no_fit.empty())
    return fmt::format("\nno response: {}\n", check.no_fit);
  if (MeasuredByResponse(KindOf(check.machine)))
    return fmt::format("\n{}: command and response only; measure it with 'hydroscope frf'\n",
                       KindOf(check.machine).title);
  std::string text = "\nwhat this log can tell";
  if (!check.machine.added_effects.empty())
    text +=
        fmt::format(" of the model, version {}, {}", check.machine.model_version, ModelName(check.machine));
  text += "\n";
  const auto with_interval = KindOf(check.machine).has_states ? FoundWithInterval : WithInterval;
  std::size_t width = 8, unit_width = 6;
  for (const CheckedParameter& p : check.parameters) {
    width = std::max(width, p.estimate.parameter.size());
    unit_width = std::max(unit_width, ShownWidth(UnitOf(check, p).name) + 1);
  }
  for (const CheckedParameter& p : check.parameters) {
    const DisplayUnit unit = UnitOf(check, p);
    const double half = kNormal95 * p.estimate.std * unit.factor;
    const char* mark = p.verdict == Identifiability::kGood   ? "yes"
                       : p.verdict == Identifiability::kWeak ? "weak"
                                                             : "NO";
    text += fmt::format("  {:<{}} {:<5}", p.estimate.parameter, width, mark);
    if (std::isfinite(half))
      text += fmt::format("{:>21} {:<{}}", with_interval(p.estimate.value * unit.factor + unit.offset, half),
                          unit.name, unit_width);
    if (p.estimate.unit != "1" && HalfWidth(p.estimate) <= kMostRelative)  // nor of a value near zero
      text += fmt::format("(± {} %)", ShortNumber(100 * HalfWidth(p.estimate), 2));
    text += "\n";
    if (!p.reason.empty()) text += fmt::format("           why:    {}\n", p.reason.english);
    if (!p.advice.empty())
      text += fmt::format("           advice: {}{}\n", p.advice.english,
                          p.explain_first ? ": see 'hydroscope explain'" : "");
  }
  if (check.figures.noise_floor > 0) {
    const DisplayUnit unit = UnitOfErrors(check.machine);
    text +=
        fmt::format("  model error on {} left out {} {}, sensor noise {} {} {}\n",
                    CountedWordsOf(check.machine).many, ShortNumber(check.figures.rms_holdout * unit.factor),
                    unit.name, check.noise_at_most ? "at most" : "alone would cause",
                    ShortNumber(check.figures.noise_floor * unit.factor), unit.name);
    if (const Told impossible = ImpossibleOf(check); !impossible.empty())
      text += fmt::format("  {}\n", impossible.english);
  }
  return text;
}

std::string Next(const CheckResult& check, const std::string& machine_file) {
  std::string text;
  if (const std::string suspicion = SuspicionText(check.suspicion); !suspicion.empty())
    text += "\n" + suspicion;
  if (!check.hints.empty()) text += "\nlook at this first\n";
  for (const std::string& hint : InEnglish(check.hints)) text += "  * " + hint + "\n";
  if (!check.Clean()) text += "\nSome values are bad; they are left out, never interpolated.\n";
  const MachineKind& kind = KindOf(check.machine);
  const bool fits = check.driving.strokes > 0 && !check.NothingIdentified();
  const char* next = MeasuredByResponse(kind)            ? (check.no_fit.empty() ? "frf" : nullptr)
                     : check.suspicion.ExplainSaysMore() ? "explain"
                     : fits                              ? "fit"
                                                         : nullptr;
  if (next != nullptr)
    text += fmt::format("\nnext: hydroscope {} {} --machine {}\n", next, ShellWord(check.log),
                        ShellWord(machine_file));
  return text;
}

nlohmann::json SignalJson(const CheckedSignal& s) {
  const auto unit = FindUnit(s.spec.unit);
  nlohmann::json flags = nlohmann::json::object();
  for (const auto& [flag, name] : quality::kFlagNames)
    for (std::size_t bit = 0; bit < s.range.flagged.size(); ++bit)
      if (s.present && flag == 1u << bit && s.range.flagged[bit] > 0)
        flags[std::string(name)] = {{"count", s.range.flagged[bit]}, {"first_s", s.range.first[bit]}};
  return {{"signal", s.spec.name}, {"column", s.spec.column},  {"unit", unit ? unit->si : "1"},
          {"present", s.present},  {"min", s.range.min},       {"max", s.range.max},
          {"good", s.range.good},  {"noise_std", s.noise_std}, {"flags", flags}};
}

/// "speed_m_s"
std::string JsonKey(const Condition& condition) {
  std::string key = condition.name + "_" + condition.unit;
  std::ranges::replace_if(
      key, [](char c) { return c == '/' || c == ' '; }, '_');
  return key;
}

nlohmann::json GateJson(const CheckResult& check) {
  nlohmann::json conditions = nlohmann::json::array();
  for (const ConditionSurvey& c : check.conditions)
    conditions.push_back({{"condition", c.condition}, {"share", c.share}});
  const Driving& d = check.driving;
  nlohmann::json json = {{"rows", check.pass.summary.gated},
                         {"used_rows", check.pass.summary.used},
                         {"share", static_cast<double>(check.pass.summary.gated) /
                                       static_cast<double>(std::max<std::int64_t>(1, check.time.rows))},
                         {"conditions", conditions},
                         {"strokes", d.strokes},
                         {"too_short", d.too_short},
                         {"oil_temperature_K", {d.oil_min, d.oil_max}}};
  for (const ConditionRange& range : d.ranges) json[JsonKey(range.condition)] = {range.low, range.high};
  return json;
}

nlohmann::json ParametersCheckJson(const CheckResult& check) {
  nlohmann::json out = nlohmann::json::object();
  for (const CheckedParameter& p : check.parameters) {
    nlohmann::json one = ParametersJson({p.estimate})[p.estimate.parameter];
    one["verdict"] = IdentifiabilityName(p.verdict);
    one["half_width"] = HalfWidth(p.estimate);
    one["why"] = p.reason.english;
    one["advice"] = p.advice.english;
    one["german"] = {{"why", p.reason.german}, {"advice", p.advice.german}};
    if (!p.confounded_with.empty()) {
      one["confounded_with"] = p.confounded_with;
      one["confounded_bias"] = p.confounded_bias;
    }
    out[p.estimate.parameter] = one;
  }
  return out;
}

std::vector<Told> Warnings(const CheckResult& check) {
  if (!(check.figures.noise_floor > 0)) return {};
  const Told impossible = ImpossibleOf(check);
  return impossible.empty() ? std::vector<Told>{} : std::vector{impossible};
}

}  // namespace

std::string CheckText(const CheckResult& check, const std::string& machine_file) {
  std::string text = Sampling(check) + Signals(check);
  if (KindOf(check.machine).build != nullptr) text += Gate(check);
  return text + Identification(check) + Next(check, machine_file);
}

nlohmann::json CheckJson(const CheckResult& check) {
  const TimeSurvey& t = check.time;
  const RunSummary& s = check.pass.summary;
  const DisplayUnit unit = OutputUnit(check.machine);
  const bool fitted = check.figures.noise_floor > 0;
  nlohmann::json signals = nlohmann::json::array(), findings = nlohmann::json::array();
  for (const CheckedSignal& signal : check.signals) signals.push_back(SignalJson(signal));
  for (const LogFinding& f : s.findings)
    findings.push_back(
        {{"line", f.line}, {"column", f.column}, {"found", f.found}, {"expected", f.expected}});
  nlohmann::json out = {
      {"log", check.log},
      {"machine", check.machine.name},
      {"rows", s.rows},
      {"rejected_rows", s.rejected_rows},
      {"stopped", JsonOrNull(s.stopped)},
      {"findings", findings},
      {"clean", check.Clean()},
      {"duration_s", t.last - t.first},
      {"data_s", static_cast<double>(t.rows) * check.sample_period},
      {"sampling",
       {{"period_s", check.sample_period},
        {"rate_hz", 1 / check.sample_period},
        {"jitter_std_s", t.jitter},
        {"gaps", t.gaps},
        {"longest_gap_s", t.longest_gap},
        {"not_forward", t.not_forward},
        {"time_base", check.time_base.english},
        {"fast_enough", check.trust.rate.fast_enough},
        {"needed_period_s", check.trust.rate.needed_period}}},
      {"noise", NoiseJson(check.trust.floor)},
      {"signals", signals},
      {"gate", GateJson(check)},
      // A machine measured by its response has none, and no error of a model.
      {"strokes",
       MeasuredByResponse(KindOf(check.machine)) ? nlohmann::json() : nlohmann::json(check.driving.strokes)},
      {"parameters", ParametersCheckJson(check)},
      {"rms_holdout", fitted ? nlohmann::json(check.figures.rms_holdout * unit.factor) : nlohmann::json()},
      {"noise_floor", fitted ? nlohmann::json(check.figures.noise_floor * unit.factor) : nlohmann::json()},
      {"unit", unit.name},
      {"model_version", check.machine.model_version},
      {"effects", check.machine.added_effects},
      {"warnings", InEnglish(Warnings(check))},
      {"hints", InEnglish(check.hints)},
      {"german",
       {{"hints", InGerman(check.hints)},
        {"warnings", InGerman(Warnings(check))},
        {"time_base", check.time_base.german}}}};
  AddSuspicion(check.suspicion, out);
  return out;
}

}  // namespace hydroscope
