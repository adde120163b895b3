#include "workbench/frequency_response/valve_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/interval_text.h"
#include "core/units.h"
#include "workbench/frequency_response/frequency_points.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMostRows = 40;  // of the table for people

std::string WithUnit(ValueWithStd v, double factor, const char* unit) {
  return WithInterval(v.value * factor, kNormal95 * v.std * factor) + " " + unit;
}

/// Rows of the table: all points, or of many the one nearest to each of equal steps of log frequency.
std::vector<const FrequencyPoint*> RowsToShow(const ValveLog& measured) {
  std::vector<const FrequencyPoint*> rows = measured.Used();
  if (measured.response.method == FrequencyResponseMethod::kSine) {
    rows.clear();
    for (const FrequencyPoint& p : measured.response.points) rows.push_back(&p);
  }
  return ThinnedPoints(std::move(rows), kMostRows);
}

double Decibels(const FrequencyPoint& p) { return 20 * std::log10(p.gain()); }

std::string Percent(double share) { return std::isnan(share) ? "-" : fmt::format("{:.2f}", 100 * share); }

const char* Note(PointReason reason) {
  switch (reason) {
    case PointReason::kUsed:
      return "";
    case PointReason::kTooShort:
      return "          left out: held too short\n";
    case PointReason::kNoResponse:
      return "          left out: no response\n";
    case PointReason::kLowCoherence:
      return "          left out: low coherence\n";
    case PointReason::kClipped:
      return "          left out: clipped\n";
    case PointReason::kNoPower:
      return "          left out: no power\n";
    case PointReason::kDisturbed:
      return "          left out: disturbed\n";
    case PointReason::kOffTheOthers:
      return "          left out: off the others\n";
    case PointReason::kOutsideRange:
      return "          left out: outside the range\n";
  }
  return "";
}

/// The command's amplitude as the machine file writes it, e.g. "0.5 V".
struct CommandUnit {
  double factor = 1;  ///< shown = share of full command * factor
  std::string name;
};
CommandUnit UnitOfCommand(const Machine& machine) {
  const int index = machine.SignalIndex(machine.valve.input);
  const std::string name = index < 0 ? "1" : machine.signals[index].unit;
  const auto unit = FindUnit(name);
  return {machine.valve.full_scale / (unit ? unit->scale : 1.0), name};
}

std::string SineTable(const ValveLog& measured, const CommandUnit& unit) {
  std::string text =
      fmt::format("{:>9} {:>9} {:>8} {:>8} {:>9} {:>8} {:>7} {:>7} {:>7}\n", "f Hz", "gain", "± 95 %", "dB",
                  "phase °", "± 95 %", "U0 " + unit.name, "harm. %", "periods");
  for (const FrequencyPoint* p : RowsToShow(measured)) {
    if (p->reason == PointReason::kTooShort) {
      text += fmt::format("{:>9.4g} {:>9} {:>8} {:>8} {:>9} {:>8} {:>7.4g}\n{}", p->frequency, "-", "-", "-",
                          "-", "-", p->amplitude * unit.factor, Note(p->reason));
      continue;
    }
    text += fmt::format("{:>9.5g} {:>9.5f} {:>8.2g} {:>8.3f} {:>9.3f} {:>8.2g} {:>7.4g} {:>7} {:>7.0f}\n{}",
                        p->frequency, p->gain(), kNormal95 * p->GainStd(), Decibels(*p), p->phase * kDegrees,
                        kNormal95 * p->PhaseStd() * kDegrees, p->amplitude * unit.factor,
                        Percent(p->output_distortion), p->periods, Note(p->reason));
  }
  return text;
}

std::string WelchTable(const ValveLog& measured) {
  std::string text = fmt::format("{:>10} {:>10} {:>9} {:>8} {:>9} {:>8} {:>10}\n", "f Hz", "gain", "± 95 %",
                                 "dB", "phase °", "± 95 %", "coherence");
  for (const FrequencyPoint* p : RowsToShow(measured)) {
    text += fmt::format("{:>10.5g} {:>10.5f} {:>9.2g} {:>8.3f} {:>9.3f} {:>8.2g} {:>10.4f}\n", p->frequency,
                        p->gain(), kNormal95 * p->GainStd(), Decibels(*p), p->phase * kDegrees,
                        kNormal95 * p->PhaseStd() * kDegrees, p->coherence);
  }
  return text;
}

std::string ValveModelText(const ValveModel& m) {
  const auto beyond = [&](double f) { return f > m.highest ? "  (beyond the measured frequencies)" : ""; };
  std::string text = "Model: second order with dead time, 95 % intervals\n";
  text += fmt::format("  natural frequency f0   {}\n", WithUnit(m.natural_frequency, 1, "Hz"));
  text += fmt::format("  damping D              {}\n", WithUnit(m.damping, 1, ""));
  text += fmt::format("  gain K_v               {}\n", WithUnit(m.gain, 1, ""));
  text += fmt::format("  dead time T_dead       {}\n", WithUnit(m.dead_time, 1e3, "ms"));
  text += fmt::format("  -3 dB at               {}{}\n", WithUnit(m.bandwidth, 1, "Hz"),
                      beyond(m.bandwidth.value));
  text +=
      fmt::format("  -90 degrees at         {}{}\n", WithUnit(m.phase_90, 1, "Hz"), beyond(m.phase_90.value));
  text += fmt::format("  step reaches 90 % in   {}\n", WithUnit(m.rise_time_90, 1e3, "ms"));
  text += fmt::format("  misfit {:.3g} times the noise at {} degrees of freedom\n",
                      std::sqrt(m.chi_squared / std::max(1, m.degrees_of_freedom)), m.degrees_of_freedom);
  return text;
}

nlohmann::json ValueJson(const ValueWithStd& v) { return {{"value", v.value}, {"std", v.std}}; }

double MedianAmplitude(const ValveLog& measured) {
  std::vector<double> amplitudes;
  for (const FrequencyPoint* p : measured.Used()) amplitudes.push_back(p->amplitude);
  std::ranges::sort(amplitudes);
  return amplitudes.empty() ? 0 : amplitudes[amplitudes.size() / 2];
}

std::vector<Told> ValveWarnings(const ValveLog& measured) {
  std::vector<Told> warnings = measured.response.warnings;
  const FrfRecord& log = measured.log;
  for (const Told& text : {log.time_base, log.twins})
    if (!text.empty()) warnings.push_back(text);
  warnings.insert(warnings.end(), log.outside_declared.begin(), log.outside_declared.end());
  if (log.left_out > 0)
    warnings.push_back(Tell("{} of {} rows left out ({})", "{} von {} Zeilen ausgelassen ({})", log.left_out,
                            log.rows, log.left_out_why));
  return warnings;
}

/// What to record next where the valve met a limit; nothing where it did not.
Told HintOf(const ValveLog& measured, const CommandUnit& unit) {
  const double worst = WorstDistortion(measured.response.points);
  if (worst <= kNotableDistortion) return {};
  return Tell(
      "up to {:.1f} % harmonics in the response that the command does not have: the valve ran into a limit (spool speed, "
      "stroke) or has a dead band or play, so that the model holds for this amplitude only. Repeat with half of {:.3g} {} and "
      "with twice as much: a gain that rises with the amplitude is that of a dead band or play, one that falls that of a limit",
      "bis zu {:.1f} % Oberschwingungen in der Antwort, die der Befehl nicht hat: das Ventil lief an eine Grenze "
      "(Schiebergeschwindigkeit, Hub) oder hat eine tote Zone oder Spiel, sodass das Modell nur für diese Amplitude gilt. Mit der "
      "Hälfte von {:.3g} {} und mit dem Doppelten wiederholen: eine Verstärkung, die mit der Amplitude steigt, ist die einer toten "
      "Zone oder von Spiel, eine, die fällt, die einer Grenze",
      100 * worst, MedianAmplitude(measured) * unit.factor, unit.name);
}

nlohmann::json ValveModelJson(const ValveModel& m) {
  return {{"model",
           {{"f0_hz", ValueJson(m.natural_frequency)},
            {"D", ValueJson(m.damping)},
            {"K_v", ValueJson(m.gain)},
            {"T_dead_s", ValueJson(m.dead_time)}}},
          {"bandwidth_3db_hz", m.bandwidth.value},
          {"bandwidth_3db_std_hz", m.bandwidth.std},
          {"bandwidth_3db_extrapolated", m.bandwidth.value > m.highest},
          {"phase_90_hz", m.phase_90.value},
          {"phase_90_std_hz", m.phase_90.std},
          {"phase_90_extrapolated", m.phase_90.value > m.highest},
          {"t90_s", m.rise_time_90.value},
          {"t90_std_s", m.rise_time_90.std},
          {"first_order", m.first_order},
          {"command_hold_s", m.command_hold},
          {"chi_squared", m.chi_squared},
          {"degrees_of_freedom", m.degrees_of_freedom},
          {"inflation", m.inflation}};
}

}  // namespace

std::string ValveText(const ValveLog& measured, const Machine& machine) {
  const FrequencyResponse& response = measured.response;
  const FrfRecord& log = measured.log;
  const CommandUnit unit = UnitOfCommand(machine);
  std::string text = fmt::format("Frequency response {} -> {}, {}\n", machine.valve.input,
                                 machine.valve.output, measured.name);
  if (response.method == FrequencyResponseMethod::kSine) {
    text += fmt::format("{} held frequencies, orthogonal correlation over whole periods, {:g} samples/s\n\n",
                        response.points.size(), 1 / log.record.sample_period);
    text += SineTable(measured, unit);
  } else {
    text += fmt::format(
        "averaged cross spectra, segments of {} samples, {:g} samples/s; {} of {} frequencies coherent\n\n",
        response.segment_length, 1 / log.record.sample_period, measured.Used().size(),
        response.points.size());
    text += WelchTable(measured);
  }
  text += "\n";
  text += response.model ? ValveModelText(*response.model)
                         : fmt::format("No model: {}\n", response.model_reason.english);
  if (!std::isnan(log.supply_pressure))
    text += fmt::format("  supply pressure {:.1f} bar\n", log.supply_pressure / 1e5);
  if (!std::isnan(log.oil_temperature))
    text += fmt::format("  oil temperature {:.1f} °C\n", log.oil_temperature - kZeroCelsius);
  for (const Told& warning : ValveWarnings(measured)) text += fmt::format("Note: {}\n", warning.english);
  if (const Told hint = HintOf(measured, unit); !hint.empty())
    text += fmt::format("Hint: {}\n", hint.english);
  return text;
}

nlohmann::json ValveJson(const ValveLog& measured, const Machine& machine) {
  const FrequencyResponse& response = measured.response;
  const FrfRecord& log = measured.log;
  const std::vector<Told> warnings = ValveWarnings(measured);
  const Told hint = HintOf(measured, UnitOfCommand(machine));
  nlohmann::json json = {{"method", MethodName(response.method)},
                         {"points", nlohmann::json::array()},
                         {"left_out", LeftOutPointsJson(response.points)},
                         {"input", machine.valve.input},
                         {"output", machine.valve.output},
                         {"amplitude", MedianAmplitude(measured)},
                         {"distortion", WorstDistortion(response.points)},
                         {"supply_pressure_pa", log.supply_pressure},
                         {"oil_temperature_k", log.oil_temperature},
                         {"sample_rate_hz", 1 / log.record.sample_period},
                         {"segment_length", response.segment_length},
                         {"rows", log.rows},
                         {"rows_left_out", log.left_out},
                         {"time_base", log.time_base.english},
                         {"warnings", InEnglish(warnings)},
                         {"hint", hint.empty() ? nlohmann::json() : nlohmann::json(hint.english)},
                         {"german", {{"warnings", InGerman(warnings)}, {"hint", hint.german}}}};
  for (const FrequencyPoint* p : measured.Used()) json["points"].push_back(FrequencyPointJson(*p));
  if (response.model) {
    json.update(ValveModelJson(*response.model));
  } else {
    for (const char* key : {"model", "bandwidth_3db_hz", "phase_90_hz"}) json[key] = nullptr;
    json["model_reason"] = response.model_reason.english;
    json["german"]["model_reason"] = response.model_reason.german;
  }
  return json;
}

}  // namespace hydroscope
