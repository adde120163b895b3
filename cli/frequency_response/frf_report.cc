#include "cli/frequency_response/frf_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/frequency_response/bode_plot.h"
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
std::vector<const FrequencyPoint*> RowsToShow(const FrequencyResponse& response) {
  std::vector<const FrequencyPoint*> rows;
  for (const FrequencyPoint& p : response.points) {
    if (response.method == FrequencyResponseMethod::kSine || p.reason == PointReason::kUsed)
      rows.push_back(&p);
  }
  return ThinnedPoints(std::move(rows), kMostRows);
}

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
  const std::string name = index < 0 ? "1" : machine.signals[static_cast<std::size_t>(index)].unit;
  const auto unit = FindUnit(name);
  return {machine.valve.full_scale / (unit ? unit->scale : 1.0), name};
}

std::string SineTable(const FrequencyResponse& response, const CommandUnit& unit) {
  std::string text =
      fmt::format("{:>9} {:>9} {:>8} {:>8} {:>9} {:>8} {:>7} {:>7} {:>7}\n", "f Hz", "gain", "± 95 %", "dB",
                  "phase °", "± 95 %", "U0 " + unit.name, "harm. %", "periods");
  for (const FrequencyPoint* p : RowsToShow(response)) {
    if (p->reason == PointReason::kTooShort) {
      text += fmt::format("{:>9.4g} {:>9} {:>8} {:>8} {:>9} {:>8} {:>7.4g}\n{}", p->frequency, "-", "-", "-",
                          "-", "-", p->amplitude * unit.factor, Note(p->reason));
      continue;
    }
    text += fmt::format("{:>9.5g} {:>9.5f} {:>8.2g} {:>8.3f} {:>9.3f} {:>8.2g} {:>7.4g} {:>7} {:>7.0f}\n{}",
                        p->frequency, p->gain(), kNormal95 * p->GainStd(), Decibels(p->gain()),
                        p->phase * kDegrees, kNormal95 * p->PhaseStd() * kDegrees, p->amplitude * unit.factor,
                        Percent(p->output_distortion), p->periods, Note(p->reason));
  }
  return text;
}

std::string WelchTable(const FrequencyResponse& response) {
  std::string text = fmt::format("{:>10} {:>10} {:>9} {:>8} {:>9} {:>8} {:>10}\n", "f Hz", "gain", "± 95 %",
                                 "dB", "phase °", "± 95 %", "coherence");
  for (const FrequencyPoint* p : RowsToShow(response)) {
    text += fmt::format("{:>10.5g} {:>10.5f} {:>9.2g} {:>8.3f} {:>9.3f} {:>8.2g} {:>10.4f}\n", p->frequency,
                        p->gain(), kNormal95 * p->GainStd(), Decibels(p->gain()), p->phase * kDegrees,
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

double MedianAmplitude(const FrequencyResponse& response) {
  std::vector<double> amplitudes;
  for (const FrequencyPoint& p : response.points) {
    if (p.reason == PointReason::kUsed) amplitudes.push_back(p.amplitude);
  }
  std::sort(amplitudes.begin(), amplitudes.end());
  return amplitudes.empty() ? 0 : amplitudes[amplitudes.size() / 2];
}

}  // namespace

std::string FrfText(const FrequencyResponse& response, const FrfRecord& log, const Machine& machine,
                    const std::string& log_name) {
  const CommandUnit unit = UnitOfCommand(machine);
  const bool sine = response.method == FrequencyResponseMethod::kSine;
  std::string text =
      fmt::format("Frequency response {} -> {}, {}\n", machine.valve.input, machine.valve.output, log_name);
  if (sine) {
    text += fmt::format("{} held frequencies, orthogonal correlation over whole periods, {:g} samples/s\n\n",
                        response.points.size(), 1 / log.record.sample_period);
    text += SineTable(response, unit);
  } else {
    const auto used = std::count_if(response.points.begin(), response.points.end(),
                                    [](const auto& p) { return p.reason == PointReason::kUsed; });
    text += fmt::format(
        "averaged cross spectra, segments of {} samples, {:g} samples/s; {} of {} frequencies coherent\n\n",
        response.segment_length, 1 / log.record.sample_period, used, response.points.size());
    text += WelchTable(response);
  }
  text += "\n";
  text +=
      response.model ? ValveModelText(*response.model) : fmt::format("No model: {}\n", response.model_reason);
  if (!std::isnan(log.supply_pressure))
    text += fmt::format("  supply pressure {:.1f} bar\n", log.supply_pressure / 1e5);
  if (!std::isnan(log.oil_temperature))
    text += fmt::format("  oil temperature {:.1f} °C\n", log.oil_temperature - kZeroCelsius);
  for (const std::string& warning : response.warnings) text += fmt::format("Note: {}\n", warning);
  if (!log.time_base.empty()) text += fmt::format("Note: {}\n", log.time_base.english);
  if (log.left_out > 0)
    text += fmt::format("Note: {} of {} rows left out ({})\n", log.left_out, log.rows, log.left_out_why);
  if (const double worst = WorstDistortion(response.points); worst > kNotableDistortion) {
    text += fmt::format(
        "Hint: up to {:.1f} % harmonics in the response that the command does not have: the valve ran into a limit (spool speed, "
        "stroke) or has a dead band or play, so that the model holds for this amplitude only. Repeat with half of {:.3g} {} and "
        "with twice as much: a gain that rises with the amplitude is that of a dead band or play, one that falls that of a limit\n",
        100 * worst, MedianAmplitude(response) * unit.factor, unit.name);
  }
  return text;
}

nlohmann::json FrfJson(const FrequencyResponse& response, const FrfRecord& log, const Machine& machine) {
  nlohmann::json json;
  json["method"] = MethodName(response.method);
  json["points"] = nlohmann::json::array();
  for (const FrequencyPoint& p : response.points)
    if (p.reason == PointReason::kUsed) json["points"].push_back(FrequencyPointJson(p));
  json["left_out"] = LeftOutPointsJson(response.points);
  if (response.model) {
    const ValveModel& m = *response.model;
    json["model"] = {{"f0_hz", ValueJson(m.natural_frequency)},
                     {"D", ValueJson(m.damping)},
                     {"K_v", ValueJson(m.gain)},
                     {"T_dead_s", ValueJson(m.dead_time)}};
    json["bandwidth_3db_hz"] = m.bandwidth.value;
    json["bandwidth_3db_std_hz"] = m.bandwidth.std;
    json["bandwidth_3db_extrapolated"] = m.bandwidth.value > m.highest;
    json["phase_90_hz"] = m.phase_90.value;
    json["phase_90_std_hz"] = m.phase_90.std;
    json["phase_90_extrapolated"] = m.phase_90.value > m.highest;
    json["t90_s"] = m.rise_time_90.value;
    json["t90_std_s"] = m.rise_time_90.std;
    json["first_order"] = m.first_order;
    json["command_hold_s"] = m.command_hold;
    json["chi_squared"] = m.chi_squared;
    json["degrees_of_freedom"] = m.degrees_of_freedom;
    json["inflation"] = m.inflation;
  } else {
    for (const char* key : {"model", "bandwidth_3db_hz", "phase_90_hz"}) json[key] = nullptr;
    json["model_reason"] = response.model_reason;
  }
  json["input"] = machine.valve.input;
  json["output"] = machine.valve.output;
  json["amplitude"] = MedianAmplitude(response);
  json["distortion"] = WorstDistortion(response.points);
  json["supply_pressure_pa"] = log.supply_pressure;
  json["oil_temperature_k"] = log.oil_temperature;
  json["sample_rate_hz"] = 1 / log.record.sample_period;
  json["segment_length"] = response.segment_length;
  json["rows"] = log.rows;
  json["rows_left_out"] = log.left_out;
  json["time_base"] = log.time_base.english;
  json["warnings"] = response.warnings;
  return json;
}

std::string FrfBodePlot(const FrequencyResponse& response, const std::string& title) {
  BodePicture picture{.title = title};
  for (const FrequencyPoint& p : response.points)
    if (p.reason == PointReason::kUsed) picture.points.push_back(&p);
  if (response.model) {
    const ValveModel& model = *response.model;
    picture.response = [&model](double f) { return model.Response(f); };
    picture.phase = [&model](double f) { return model.Phase(f); };
    picture.gain_level = Decibels(std::abs(model.gain.value)) - kHalfPower;
    picture.legend =
        fmt::format(" — curve: f0 {:.4g} Hz, D {:.3g}, dead time {:.3f} ms", model.natural_frequency.value,
                    model.damping.value, 1e3 * model.dead_time.value + 0.0);
  }
  return BodePlot(picture);
}

}  // namespace hydroscope
