#include "estimation/closed_loop/closed_loop.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/distributions.h"
#include "core/told_error.h"
#include "estimation/closed_loop/causality.h"
#include "estimation/closed_loop/input_limit.h"
#include "estimation/closed_loop/reversal.h"
#include "estimation/frequency_response/model.h"

namespace hydroscope {
namespace {

constexpr double kNormal99 = 2.5758293035489004;
constexpr std::size_t kFewestOfOctave = 4;

double LargestMagnitude(const FrequencyRecord& record, std::vector<double> SignalRun::*signal) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const SignalRun& run : record.runs)
    for (const double value : run.*signal) low = std::min(low, value), high = std::max(high, value);
  return high > low ? high - low : 0;
}

Status CheckThatItMoves(const FrequencyRecord& record, const ClosedLoopPlant& plant) {
  for (const auto& [name, signal] : {std::pair(plant.set_point, &SignalRun::set_point),
                                     {plant.input, &SignalRun::input},
                                     {plant.output, &SignalRun::output}})
    if (!(LargestMagnitude(record, signal) > 0))
      return BadInput(Tell(
          "{} does not move in this record; excite the set point with noise while it is recorded, and check "
          "that the right column is mapped",
          "{} bewegt sich in dieser Aufzeichnung nicht; den Sollwert beim Aufzeichnen mit Rauschen anregen, und nachsehen, "
          "ob die richtige Spalte zugeordnet ist",
          name));
  return {};
}

/// One bin as people see it.
FrequencyPoint PointOf(const LoopSpectra& spectra, std::size_t bin, const LoopOptions& options) {
  const LoopSums& sums = spectra.bins[bin];
  const double segments = spectra.segments, independent = segments * kIndependentShareOfSegment;
  const double length = static_cast<double>(spectra.segment_length);
  FrequencyPoint point;
  point.frequency = spectra.Frequency(bin);
  const std::complex<double> difference = spectra.Difference(point.frequency), ratio = sums.Ratio();
  point.response = ratio / difference;
  const double noise = sums.Residual(ratio) / segments;
  point.variance = noise * sums.rr / segments / (2 * std::norm(sums.ru / segments) * (independent - 1)) /
                   std::norm(difference);
  point.dof = 2 * (independent - 1);
  point.coherence = sums.CoherenceOfOutput();
  point.periods = independent;
  const double scale = 2 / (length * length / 4) / segments;  // mean square in the window's noise bandwidth
  point.amplitude = std::sqrt(sums.uu * scale);
  point.output_amplitude = std::sqrt(sums.yy * scale) / std::abs(difference);
  if (point.coherence < options.min_coherence) point.reason = PointReason::kLowCoherence;
  return point;
}

/// Mean of direct over ratio less one in the octave where it is largest.
std::optional<DirectBias> LargestDirectBias(const LoopResponse& response) {
  std::optional<DirectBias> largest;
  DirectBias octave;
  std::size_t count = 0;
  const auto close = [&] {
    if (count >= kFewestOfOctave) {
      octave.gain /= static_cast<double>(count);
      if (!largest || std::abs(octave.gain) > std::abs(largest->gain)) largest = octave;
    }
    count = 0;
  };
  for (std::size_t i = 0; i < response.points.size(); ++i) {
    const FrequencyPoint& p = response.points[i];
    if (p.reason != PointReason::kUsed) continue;
    if (count > 0 && p.frequency > 2 * octave.lowest) close();
    if (count == 0) octave = {p.frequency, p.frequency, 0};
    octave.highest = p.frequency;
    octave.gain += (response.direct[i] / p.response).real() - 1;
    ++count;
  }
  close();
  return largest;
}

/// Length of such a record that brings every parameter to its wanted precision.
void TakeNeededSeconds(const ClosedLoopPlant& plant, LoopResponse& response) {
  for (std::size_t i = 0; i < plant.parameters.size(); ++i) {
    const LoopParameter& parameter = plant.parameters[i];
    if (parameter.wanted <= 0) continue;
    const double half = kNormal99 * response.fit->Std(parameter, i) / std::abs(response.fit->parameters[i]);
    const double needed = response.seconds * half * half / (parameter.wanted * parameter.wanted);
    if (needed <= response.seconds_needed) continue;
    response.seconds_needed = needed;
    response.needed_for = parameter.name;
  }
}

/// What people see of the fit.
void TakeParameters(const ClosedLoopPlant& plant, LoopResponse& response) {
  const double wider = response.fit->Widening();
  for (std::size_t i = 0; i < plant.parameters.size(); ++i)
    response.parameters.push_back(
        {response.fit->parameters[i], wider * response.fit->Std(plant.parameters[i], i)});
  TakeNeededSeconds(plant, response);
}

void TakeFit(const LoopSpectra& spectra, const std::vector<std::size_t>& used, const TransferModel& model,
             const std::vector<double>& known, LoopResponse& response) {
  auto fit = FitTransfer(spectra, used, model);
  const Status follows = fit ? CheckCausality(*model.plant, *fit, spectra.sample_period) : Status();
  if (!fit || !follows) {
    response.no_fit = ToldOf(fit ? follows.error() : fit.error());
    return;
  }
  response.fit = std::move(*fit);
  if (!known.empty())
    static_cast<LoopEstimate&>(*response.fit) = NearestWay(*model.plant, *response.fit, known);
  TakeParameters(*model.plant, response);
  if (Told reversed = ReversedSignal(*model.plant, response.fit->parameters, known); !reversed.empty())
    response.warnings.push_back(std::move(reversed));
  if (response.fit->inflation > 1)
    response.warnings.push_back(Tell(
        "the transfer function does not describe the response within its noise: misfit is {:.3g} times the noise, intervals "
        "are widened by that; friction that does not grow with speed, or movements too large for a linear valve",
        "die Übertragungsfunktion beschreibt die Antwort nicht innerhalb ihres Rauschens: die Abweichung ist {:.3g}-mal das "
        "Rauschen, die Intervalle sind darum weiter; Reibung, die nicht mit der Geschwindigkeit wächst, oder Bewegungen, die "
        "für ein lineares Ventil zu groß sind",
        response.fit->inflation));
  if (response.seconds_needed > response.seconds)
    response.warnings.push_back(Tell(
        "{:.0f} s are too short for the precision wanted: {} needs {:.0f} s of such a record (or more excitation)",
        "{:.0f} s sind zu kurz für die gewünschte Genauigkeit: {} braucht {:.0f} s einer solchen Aufzeichnung (oder mehr Anregung)",
        response.seconds, response.needed_for, response.seconds_needed));
}

}  // namespace

Status LoopOptions::Validate() const {
  constexpr std::size_t kLeastSegment = 64;
  return ValidateSpectra(*this, kLeastSegment);
}

Result<LoopResponse> MeasureClosedLoop(const FrequencyRecord& record, const TransferModel& model,
                                       const LoopOptions& options) {
  TRY(options.Validate());
  TRY(CheckThatItMoves(record, *model.plant));
  LoopSpectraOptions averaging{.segment_length = options.segment_length};
  auto spectra = AverageLoopSpectra(record, averaging);
  if (!spectra) return tl::unexpected(spectra.error());
  std::vector<std::size_t> used = BinsOfSetPoint(*spectra, options.lowest, options.highest);
  if (used.size() < kFewestBinsOfSetPoint)
    return BadInput(Tell(
        "{} and {} are not related: the input follows the set point at {} frequencies, at least {} are needed; check that "
        "the right columns are mapped, that the loop is closed and that the set point is excited",
        "{} und {} hängen nicht zusammen: der Eingang folgt dem Sollwert bei {} Frequenzen, mindestens {} sind nötig; "
        "nachsehen, ob die richtigen Spalten zugeordnet sind, ob der Regelkreis geschlossen und der Sollwert angeregt ist",
        model.plant->set_point, model.plant->input, used.size(), kFewestBinsOfSetPoint));

  LoopResponse response;
  static_cast<InputRange&>(response) = FindInputRange(record, averaging, *spectra, used);
  if (response.input_limit) {
    averaging.limit = *response.input_limit;
    spectra = AverageLoopSpectra(record, averaging);
    if (!spectra) return tl::unexpected(spectra.error());
    used = BinsOfSetPoint(*spectra, options.lowest, options.highest);
  }
  response.warnings = NonlinearInputTexts(*model.plant, response);
  response.segment_length = spectra->segment_length;
  response.segments = spectra->segments;
  for (const SignalRun& run : record.runs)
    response.seconds += static_cast<double>(run.input.size()) * record.sample_period;
  for (const std::size_t bin : used) {
    response.points.push_back(PointOf(*spectra, bin, options));
    response.direct.push_back(spectra->bins[bin].Direct() / spectra->Difference(spectra->Frequency(bin)));
  }
  UnwrapPhases(response.points);
  response.direct_bias = LargestDirectBias(response);
  TakeFit(*spectra, used, model, options.known, response);
  return response;
}

}  // namespace hydroscope
