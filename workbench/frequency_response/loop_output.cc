#include "workbench/frequency_response/loop_output.h"

#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/interval_text.h"
#include "models/closed_loop.h"
#include "models/machine_kind.h"
#include "workbench/frequency_response/frequency_points.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsOfTable = 24;

std::complex<double> DirectAt(const LoopResponse& response, const FrequencyPoint& point) {
  return response.direct[&point - response.points.data()];
}

std::string PointTable(const LoopResponse& response) {
  std::string text = fmt::format("{:>9} {:>11} {:>9} {:>9} {:>8} {:>10} {:>12}\n", "f Hz", "gain", "± 95 %",
                                 "phase °", "± 95 %", "coherence", "direct gain");
  for (const FrequencyPoint* p : UsedPoints(response, kRowsOfTable))
    text += fmt::format("{:>9.4g} {:>11.4g} {:>9.2g} {:>9.2f} {:>8.2g} {:>10.3f} {:>12.4g}\n", p->frequency,
                        p->gain(), kNormal95 * p->GainStd(), p->phase * kDegrees,
                        kNormal95 * p->PhaseStd() * kDegrees, p->coherence, std::abs(DirectAt(response, *p)));
  return text;
}

std::string WithUnitOf(const LoopParameter& parameter, ValueWithStd v) {
  return WithInterval(v.value * parameter.factor, kNormal95 * v.std * parameter.factor) +
         (parameter.unit.empty() ? "" : fmt::format(" {}", parameter.unit));
}

std::string ModelLines(const LoopLog& measured, const Machine& machine) {
  const LoopResponse& response = measured.response;
  const ClosedLoopPlant& plant = *ClosedLoopOf(machine);
  const MachineKind& kind = KindOf(machine);
  std::string text = "Transfer function, 95 % intervals\n";
  for (std::size_t i = 0; i < response.parameters.size(); ++i)
    text += fmt::format("  {:<8} {:<32} {}\n", kind.parameters[i].name,
                        WithUnitOf(plant.parameters[i], response.parameters[i]), kind.parameters[i].meaning);
  text += fmt::format(
      "  misfit {:.3g} times the noise at {} degrees of freedom; {}\n",
      std::sqrt(response.fit->chi_squared / response.fit->degrees_of_freedom),
      response.fit->degrees_of_freedom,
      measured.model.hold > 0 ? "the input is held between rows" : "the input moves evenly between rows");
  std::vector<std::string> wanted;
  for (const LoopParameter& p : plant.parameters)
    if (p.wanted > 0) wanted.push_back(fmt::format("{} within {:g} %", p.name, 100 * p.wanted));
  text += fmt::format("  {} in 99 of 100 records: {:.0f} s of such a record are needed, {:.0f} s are there\n",
                      fmt::join(wanted, ", "), response.seconds_needed, response.seconds);
  return text;
}

std::vector<Told> WarningsOf(const LoopLog& measured, const Machine& machine) {
  const LoopResponse& response = measured.response;
  const ClosedLoopPlant& plant = *ClosedLoopOf(machine);
  std::vector<Told> warnings = response.warnings;
  if (response.input_limit) warnings.push_back(InputLimitText(plant, *response.input_limit));
  for (const Told& text : RowWarnings(measured.log)) warnings.push_back(text);
  for (const Told& limit : OutsideLimits(machine, response)) warnings.push_back(limit);
  return warnings;
}

nlohmann::json PointsJson(const LoopResponse& response) {
  nlohmann::json points = nlohmann::json::array();
  for (const FrequencyPoint& p : response.points) {
    if (p.reason != PointReason::kUsed) continue;
    const std::complex<double> direct = DirectAt(response, p);
    nlohmann::json point = FrequencyPointJson(p);
    point["direct_gain"] = std::abs(direct);
    point["direct_phase_deg"] = p.phase * kDegrees + std::arg(direct / p.response) * kDegrees;
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace

std::string LoopText(const LoopLog& measured, const Machine& machine) {
  const LoopResponse& response = measured.response;
  const ClosedLoopPlant& plant = *ClosedLoopOf(machine);
  std::string text = fmt::format("Frequency response {} -> {} in closed loop, {}\n", plant.input,
                                 plant.output, measured.name);
  text += fmt::format(
      "ratio of cross spectra with the set point {}, {} segments of {} samples, {:g} samples/s; {} of {} frequencies coherent\n\n",
      plant.set_point, response.segments, response.segment_length, 1 / measured.log.record.sample_period,
      UsedPoints(response, response.points.size()).size(), response.points.size());
  text += PointTable(response) + "\n";
  if (response.direct_bias)
    text += fmt::format(
        "The direct ratio of output to input lies {:+.2g} % beside it from {:.3g} to {:.3g} Hz.\n",
        100 * response.direct_bias->gain, response.direct_bias->lowest, response.direct_bias->highest);
  text +=
      response.fit ? ModelLines(measured, machine) : fmt::format("No model: {}\n", response.no_fit.english);
  for (const Told& warning : WarningsOf(measured, machine))
    text += fmt::format("Note: {}\n", warning.english);
  return text;
}

nlohmann::json LoopJson(const LoopLog& measured, const Machine& machine) {
  const LoopResponse& response = measured.response;
  const ClosedLoopPlant& plant = *ClosedLoopOf(machine);
  const MachineKind& kind = KindOf(machine);
  const std::vector<Told> warnings = WarningsOf(measured, machine);
  nlohmann::json json = {{"method", "closed_loop"},
                         {"points", PointsJson(response)},
                         {"left_out", LeftOutPointsJson(response.points)},
                         {"model", nullptr},
                         {"set_point", plant.set_point},
                         {"input", plant.input},
                         {"output", plant.output},
                         {"seconds", response.seconds},
                         {"sample_rate_hz", 1 / measured.log.record.sample_period},
                         {"segment_length", response.segment_length},
                         {"segments", response.segments},
                         {"command_hold_s", measured.model.hold},
                         {"input_limit", nullptr},
                         {"dead_band", nullptr},
                         {"readings_end", nullptr},
                         {"direct_bias", nullptr},
                         {"rows", measured.log.rows},
                         {"rows_left_out", measured.log.left_out},
                         {"warnings", InEnglish(warnings)},
                         {"german", {{"warnings", InGerman(warnings)}}}};
  if (response.input_limit) json["input_limit"] = *response.input_limit;
  if (response.dead_band) json["dead_band"] = *response.dead_band;
  if (response.readings_end) json["readings_end"] = *response.readings_end;
  if (response.direct_bias)
    json["direct_bias"] = {{"from_hz", response.direct_bias->lowest},
                           {"to_hz", response.direct_bias->highest},
                           {"gain", response.direct_bias->gain}};
  if (!response.fit) {
    json["model_reason"] = response.no_fit.english;
    json["german"]["model_reason"] = response.no_fit.german;
    return json;
  }
  for (std::size_t i = 0; i < response.parameters.size(); ++i)
    json["model"][std::string(kind.parameters[i].name)] = {{"value", response.parameters[i].value},
                                                           {"std", response.parameters[i].std},
                                                           {"unit", kind.parameters[i].si}};
  json["chi_squared"] = response.fit->chi_squared;
  json["degrees_of_freedom"] = response.fit->degrees_of_freedom;
  json["inflation"] = response.fit->inflation;
  json["needed_seconds"] = response.seconds_needed;
  json["needed_for"] = response.needed_for;
  json["minima"] = nlohmann::json::array();
  for (const TransferMinimum& minimum : response.fit->minima)
    json["minima"].push_back({{"parameters", minimum.parameters},
                              {"chi_squared", minimum.chi_squared},
                              {"starts", minimum.starts}});
  return json;
}

std::vector<const FrequencyPoint*> UsedPoints(const LoopResponse& response, std::size_t most) {
  std::vector<const FrequencyPoint*> points;
  for (const FrequencyPoint& p : response.points)
    if (p.reason == PointReason::kUsed) points.push_back(&p);
  return ThinnedPoints(std::move(points), most);
}

double PhaseBeside(const TransferModel& model, const std::vector<double>& parameters, double frequency,
                   const FrequencyPoint& point) {
  const double raw = std::arg(model.Response(frequency, parameters));
  return raw + kTwoPi * std::round((point.phase - raw) / kTwoPi);
}

}  // namespace hydroscope
