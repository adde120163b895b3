#include "estimation/frequency_response/frequency_response.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/told_error.h"
#include "estimation/frequency_response/correlation.h"
#include "estimation/frequency_response/disturbed_points.h"
#include "estimation/frequency_response/model.h"
#include "estimation/frequency_response/model_refusal.h"
#include "estimation/frequency_response/segments.h"
#include "estimation/frequency_response/welch.h"

namespace hydroscope {
namespace {

constexpr std::size_t kShortestRecord = 64;
// When people are told to sweep higher: f0 known worse than this, relative, or -90 degrees extrapolated by more than this factor.
constexpr double kWeakFrequency = 0.2, kFarExtrapolation = 1.5;
// Of the excitation that held sines must cover to be taken for a stepped sine.
constexpr double kHeldShare = 0.6;

constexpr double kFewestHeld = 0.2;  // below, the few held stretches are accidents of a chirp or of noise

struct HeldInRun {
  std::size_t run = 0;
  HeldSine held;
};

struct Search {
  std::vector<HeldInRun> held;
  std::size_t active = 0, covered = 0;
  int unsteady = 0;
  bool stairs = false;  // the command is refreshed every few samples and held between
};

Search SearchHeldSines(const FrequencyRecord& record) {
  Search search;
  for (std::size_t r = 0; r < record.runs.size(); ++r) {
    const HeldSines sines = FindHeldSines(record.runs[r].input);
    for (const HeldSine& held : sines.found) search.held.push_back({r, held});
    search.active += sines.active;
    search.covered += sines.covered;
    search.unsteady += sines.unsteady;
    search.stairs = search.stairs || sines.stair_length > 1;
  }
  return search;
}

Status CheckRecord(const FrequencyRecord& record) {
  std::size_t samples = 0;
  double low = std::numeric_limits<double>::infinity(), high = -low, out_low = low, out_high = -low;
  for (const SignalRun& run : record.runs) {
    if (run.input.size() != run.output.size()) return InternalError("input and output differ in length");
    samples += run.input.size();
    for (double u : run.input) low = std::min(low, u), high = std::max(high, u);
    for (double y : run.output) out_low = std::min(out_low, y), out_high = std::max(out_high, y);
  }
  if (samples < kShortestRecord) {
    return BadInput(Tell("the record is too short: {} usable samples, at least {} are needed",
                         "die Aufzeichnung ist zu kurz: {} brauchbare Werte, nötig sind mindestens {}",
                         samples, kShortestRecord));
  }
  if (!(record.sample_period > 0))
    return BadInput("the sample period is {} s, a positive one is needed", record.sample_period);
  if (!(high > low)) {
    return BadInput(
        Tell("the command is constant ({:.6g}): excite the valve with stepped sines, a chirp or noise",
             "der Befehl ist konstant ({:.6g}): das Ventil mit gestuften Sinusschwingungen, "
             "einem Gleitsinus oder Rauschen anregen",
             low));
  }
  if (!(out_high > out_low)) {
    return BadInput(Tell(
        "the response is constant ({:.6g}) while the command moves: check that the right column is mapped, "
        "the sensor is connected and the valve is enabled",
        "die Antwort ist konstant ({:.6g}), während sich der Befehl bewegt: prüfen, ob die richtige Spalte zugeordnet, der Sensor "
        "angeschlossen und das Ventil freigegeben ist",
        out_low));
  }
  return {};
}

SettleRule RuleFor(const FrequencyResponseOptions& options, const FrequencyRecord& record,
                   const std::optional<ValveModel>& model) {
  SettleRule rule;
  if (!std::isnan(options.settle_time)) rule.fixed = options.settle_time / record.sample_period;
  if (!model) return rule;
  const double d = model->damping.value;
  const double omega_0 = 2 * std::numbers::pi * model->natural_frequency.value * record.sample_period;
  rule.time_constant = 1 / (omega_0 * (d < 1 ? d : d - std::sqrt(d * d - 1)));
  rule.dead_time = model->dead_time.value / record.sample_period;
  return rule;
}

std::vector<HeldSineSums> SumsOf(const FrequencyRecord& record, const Search& search) {
  std::vector<HeldSineSums> sums;
  for (const HeldInRun& h : search.held) {
    const SignalRun& run = record.runs[h.run];
    sums.emplace_back(run.input, run.output, h.held.omega, h.held.begin, h.held.end);
  }
  return sums;
}

std::vector<FrequencyPoint> CorrelateAll(const FrequencyRecord& record, const Search& search,
                                         const std::vector<HeldSineSums>& sums, const SettleRule& rule) {
  std::vector<CorrelatedPoint> correlated;
  for (std::size_t i = 0; i < search.held.size(); ++i) {
    const HeldInRun& h = search.held[i];
    correlated.push_back(CorrelateHeldSine(record.runs[h.run], record.sample_period, h.held, sums[i], rule));
  }
  PoolVariances(correlated);
  std::vector<FrequencyPoint> points;
  for (const CorrelatedPoint& c : correlated) points.push_back(c.point);
  std::ranges::stable_sort(points, [](const auto& a, const auto& b) { return a.frequency < b.frequency; });
  return points;
}

bool SameUse(const std::vector<FrequencyPoint>& a, const std::vector<FrequencyPoint>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& p, const auto& q) { return p.reason == q.reason; });
}

bool SameWindows(const std::vector<FrequencyPoint>& a, const std::vector<FrequencyPoint>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& p, const auto& q) {
    return p.reason == q.reason && p.begin == q.begin && p.end == q.end;
  });
}

int CountReason(const std::vector<FrequencyPoint>& points, PointReason reason) {
  return static_cast<int>(
      std::ranges::count_if(points, [reason](const auto& p) { return p.reason == reason; }));
}

void TakeModel(Result<ValveModel> fitted, FrequencyResponse& response) {
  if (fitted) {
    response.model = *fitted;
  } else {
    response.model.reset();
    response.model_reason = ToldOf(fitted.error());
  }
  UnwrapPhases(response.points, response.model ? &*response.model : nullptr);
}

/// Why not one of the held frequencies could be used.
Told NoneUsed(const std::vector<FrequencyPoint>& points, const FrequencyResponseOptions& options) {
  if (const int outside = CountReason(points, PointReason::kOutsideRange); outside > 0)
    return Tell(
        "no usable frequency lies within {:g} to {:g} Hz, {} of {} lie outside: give a wider range",
        "keine brauchbare Frequenz liegt zwischen {:g} und {:g} Hz, {} von {} liegen außerhalb: den Bereich weiter wählen",
        options.lowest, options.highest, outside, points.size());
  if (const int clipped = CountReason(points, PointReason::kClipped); clipped > 0)
    return Tell(
        "command or response is clipped at {} of {} frequencies: lower the amplitude or check the sensor's range",
        "Befehl oder Antwort ist bei {} von {} Frequenzen abgeschnitten: die Amplitude senken oder den Messbereich prüfen",
        clipped, points.size());
  if (CountReason(points, PointReason::kNoResponse) > 0)
    return Tell(
        "the response does not follow the command at any of {} frequencies (it is noise): check that the right column is mapped "
        "and the valve is enabled",
        "die Antwort folgt dem Befehl bei keiner von {} Frequenzen (sie ist Rauschen): prüfen, ob die richtige Spalte zugeordnet "
        "und das Ventil freigegeben ist",
        points.size());
  return Tell(
      "all {} held frequencies are too short: fewer than 2 whole periods are left after the transient; hold each frequency longer",
      "alle {} gehaltenen Frequenzen sind zu kurz: nach dem Einschwingen bleiben weniger als 2 ganze Perioden; "
      "jede Frequenz länger halten",
      points.size());
}

void WarnOfLeftOut(FrequencyResponse& response) {
  static constexpr std::pair<PointReason, Wording> kReasons[] = {
      {PointReason::kClipped, {"command or response is clipped", "Befehl oder Antwort ist abgeschnitten"}},
      {PointReason::kNoResponse,
       {"the response does not stand out of its noise", "die Antwort hebt sich nicht von ihrem Rauschen ab"}},
      {PointReason::kTooShort,
       {"fewer than 2 whole periods after the transient",
        "weniger als 2 ganze Perioden nach dem Einschwingen"}},
      {PointReason::kOutsideRange, {"outside the range asked for", "außerhalb des gewünschten Bereichs"}},
      {PointReason::kOffTheOthers,
       {"far off the model that describes all others, as where the response picks up a hum of just this frequency: "
        "repeat it next to it",
        "weit neben dem Modell, das alle anderen beschreibt, wie wo die Antwort ein Brummen gerade dieser Frequenz aufnimmt: "
        "daneben wiederholen"}}};
  for (const auto& [reason, what] : kReasons)
    if (const int count = CountReason(response.points, reason); count > 0)
      response.warnings.push_back(Tell("{} of {} frequencies left out: {}",
                                       "{} von {} Frequenzen ausgelassen: {}", count, response.points.size(),
                                       what));
}

Result<FrequencyResponse> BySteppedSines(const FrequencyRecord& record, const Search& search,
                                         const FrequencyResponseOptions& options) {
  if (static_cast<double>(search.covered) <= kFewestHeld * static_cast<double>(search.active)) {
    return BadInput(Tell(
        "no frequency is held steadily in the command ({} stretches drift); hold each for at least 5 periods "
        "(2 more than the transient takes), or use --method welch for a chirp or noise",
        "im Befehl ist keine Frequenz ruhig gehalten ({} Strecken laufen weg); jede mindestens 5 Perioden halten (2 mehr, als das "
        "Einschwingen dauert), oder bei Gleitsinus und Rauschen gemittelte Spektren (--method welch) nehmen",
        search.unsteady));
  }
  FrequencyResponse response;
  response.method = FrequencyResponseMethod::kSine;
  const std::vector<HeldSineSums> sums = SumsOf(record, search);
  for (int pass = 0; pass < 3; ++pass) {  // the transient's length comes from the model of the pass before
    auto points = CorrelateAll(record, search, sums, RuleFor(options, record, response.model));
    LeaveOutOfRange(points, options);
    if (pass > 0 && SameWindows(points, response.points)) break;
    const std::optional<ValveModel> before = response.model;
    const bool near = before && SameUse(points, response.points);
    response.points = std::move(points);
    TakeModel(
        FitValveModel(response.points, 1, record.sample_period, search.stairs, near ? &*before : nullptr),
        response);
    if (!response.model) break;
  }
  if (auto without = response.model ? FitWithoutOne(response.points, *response.model, record.sample_period)
                                    : std::nullopt)
    TakeModel(std::move(*without), response);
  if (CountReason(response.points, PointReason::kUsed) == 0)
    return BadInput(NoneUsed(response.points, options));
  WarnOfLeftOut(response);
  if (search.unsteady > 0) {
    response.warnings.push_back(Tell(
        "{} stretches of the command were left out: frequency or amplitude not steady",
        "{} Strecken des Befehls wurden ausgelassen: Frequenz oder Amplitude nicht ruhig", search.unsteady));
  }
  return response;
}

Told DisturbedWarning(const std::vector<FrequencyPoint>& points) {
  double lowest = std::numeric_limits<double>::infinity(), highest = 0;
  for (const FrequencyPoint& p : points) {
    if (p.reason != PointReason::kDisturbed) continue;
    lowest = std::min(lowest, p.frequency);
    highest = std::max(highest, p.frequency);
  }
  return Tell(
      "{} frequencies between {:.4g} and {:.4g} Hz left out: the command is weak there and the response follows "
      "another law than elsewhere, as where both channels pick up a hum",
      "{} Frequenzen zwischen {:.4g} und {:.4g} Hz ausgelassen: der Befehl ist dort schwach, und die Antwort folgt einem anderen "
      "Gesetz als sonst, wie wo beide Kanäle ein Brummen aufnehmen",
      CountReason(points, PointReason::kDisturbed), lowest, highest);
}

/// The record with its response `samples` earlier.
FrequencyRecord Advanced(const FrequencyRecord& record, std::size_t samples) {
  FrequencyRecord advanced{record.sample_period, {}, record.shares};
  for (const SignalRun& run : record.runs) {
    if (run.input.size() <= samples) continue;
    const auto by = static_cast<std::ptrdiff_t>(samples);
    advanced.runs.push_back(
        {run.start, {run.input.begin(), run.input.end() - by}, {run.output.begin() + by, run.output.end()}});
  }
  return advanced;
}

/// Averaged spectra take a response that is late by a share of a segment for weaker by that share, without a sign of it (Bendat and
/// Piersol 2010, sec. 9.3.1). Where it is late by more than a hundredth, command and response are first set side by side, and the
/// delay is put back into the phase.
Result<WelchSpectra> SpectraSideBySide(const FrequencyRecord& record,
                                       const FrequencyResponseOptions& options) {
  constexpr double kLate = 0.01;  // of a segment
  auto spectra = EstimateByWelch(record, options);
  if (!spectra) return spectra;
  const auto rough = FitValveModel(spectra->points, kHannCorrelation, record.sample_period);
  if (!rough) return spectra;
  const double late = std::round(rough->dead_time.value / record.sample_period);
  if (late < kLate * static_cast<double>(spectra->segment_length) ||
      late > static_cast<double>(spectra->segment_length))
    return spectra;
  FrequencyResponseOptions same = options;
  same.segment_length = spectra->segment_length;
  auto aligned = EstimateByWelch(Advanced(record, static_cast<std::size_t>(late)), same);
  if (!aligned) return spectra;
  for (FrequencyPoint& p : aligned->points)
    p.response *= std::polar(1.0, -2 * std::numbers::pi * p.frequency * late * record.sample_period);
  return aligned;
}

Result<FrequencyResponse> ByWelch(const FrequencyRecord& record, const FrequencyResponseOptions& options) {
  auto spectra = TRY(SpectraSideBySide(record, options));
  FrequencyResponse response;
  response.method = FrequencyResponseMethod::kWelch;
  response.segment_length = spectra.segment_length;
  response.points = std::move(spectra.points);
  const int used = CountReason(response.points, PointReason::kUsed);
  const int outside = CountReason(response.points, PointReason::kOutsideRange);
  if (used < 3 && outside > 0) {
    return BadInput(Tell(
        "only {} coherent frequencies lie within {:g} to {:g} Hz, at least 3 are needed; {} lie outside: "
        "give a wider range or a longer --segment",
        "nur {} kohärente Frequenzen liegen zwischen {:g} und {:g} Hz, nötig sind mindestens 3; {} liegen außerhalb: einen "
        "weiteren Bereich oder längere Segmente (--segment) wählen",
        used, options.lowest, options.highest, outside));
  }
  if (used < 3) {
    return BadInput(Tell(
        "command and response are not related: coherence reaches the limit at {} of {} frequencies, at least "
        "3 are needed; check that the right columns are mapped, that the "
        "command moves and the valve is enabled",
        "Befehl und Antwort hängen nicht zusammen: die Kohärenz erreicht die Grenze bei {} von {} Frequenzen, nötig sind "
        "mindestens 3; prüfen, ob die richtigen Spalten zugeordnet sind, der Befehl sich bewegt und das Ventil freigegeben ist",
        used, response.points.size()));
  }
  if (const int powerless = CountReason(response.points, PointReason::kNoPower); powerless > 0) {
    response.warnings.push_back(Tell(
        "{} coherent frequencies left out: the command has hardly any power there, what both channels share "
        "is accident or disturbance",
        "{} kohärente Frequenzen ausgelassen: der Befehl hat dort kaum Leistung, was beide Kanäle teilen, ist Zufall oder Störung",
        powerless));
  }
  for (const SignalRun& run : record.runs) {
    if (LooksClipped(run.input) || LooksClipped(run.output)) {
      response.warnings.push_back(
          {"command or response sits on its extreme for long: clipped or saturated, lower the amplitude",
           "Befehl oder Antwort steht lange auf ihrem Höchstwert: abgeschnitten oder am Anschlag, die Amplitude senken"});
      break;
    }
  }
  auto model = FitValveModel(response.points, kHannCorrelation, record.sample_period);
  if (const auto without =
          model ? FitWithoutDisturbed(response.points, *model, kHannCorrelation, record.sample_period)
                : std::nullopt) {
    model = *without;
    response.warnings.push_back(DisturbedWarning(response.points));
  }
  TakeModel(std::move(model), response);
  return response;
}

/// What the fitted figures say about the check itself.
void AddModelWarnings(FrequencyResponse& response) {
  if (!response.model) return;
  const ValveModel& m = *response.model;
  if (m.gain.value < 0)
    response.warnings.push_back(
        {"the response moves against the command: polarity of a sensor or of the valve is reversed",
         "die Antwort bewegt sich gegen den Befehl: ein Sensor oder das Ventil ist umgepolt"});
  if (m.dead_time.value + 3 * m.dead_time.std < 0) {
    response.warnings.push_back(
        {"the dead time is negative: the command is recorded later than the response, "
         "or it is not the signal the valve gets",
         "die Totzeit ist negativ: der Befehl ist später aufgezeichnet als die Antwort, oder er ist nicht das, was das Ventil "
         "bekommt"});
  }
  if (m.first_order && m.bandwidth.std > kWeakFrequency * m.bandwidth.value) {
    response.warnings.push_back(
        {"the response is of first order as far as it is seen, and not even its corner frequency is determined: record "
         "longer, with more amplitude, or sweep higher",
         "die Antwort ist, soweit man sieht, erster Ordnung, und nicht einmal ihre Eckfrequenz ist bestimmt: länger, mit mehr "
         "Amplitude oder bis zu höheren Frequenzen aufzeichnen"});
  } else if (m.first_order) {
    response.warnings.push_back(Tell(
        "the response is of first order with dead time: only its corner frequency f0/(2 D) = {:.4g} Hz is "
        "determined, D is held at {:.3g}",
        "die Antwort ist erster Ordnung mit Totzeit: nur ihre Eckfrequenz f0/(2 D) = {:.4g} Hz ist bestimmt, "
        "D ist auf {:.3g} festgehalten",
        m.natural_frequency.value / (2 * m.damping.value), m.damping.value));
  } else if (m.natural_frequency.std > kWeakFrequency * m.natural_frequency.value ||
             m.phase_90.value > kFarExtrapolation * m.highest) {
    response.warnings.push_back(Tell(
        "the frequencies (up to {:.4g} Hz) end well before the phase reaches -90 degrees: f0 and "
        "D are weakly determined, sweep higher",
        "die Frequenzen (bis {:.4g} Hz) enden lange, bevor die Phase -90 Grad erreicht: f0 und D sind schwach bestimmt, bis "
        "zu höheren Frequenzen messen",
        m.highest));
  }
  if (m.command_hold > 0) {
    response.warnings.push_back(Tell(
        "the response fits a command that is held between samples ({:.4g} ms): the hold is taken "
        "into account and is not part of the dead time",
        "die Antwort passt zu einem Befehl, der zwischen den Werten gehalten wird ({:.4g} ms): das ist berücksichtigt und "
        "nicht Teil der Totzeit",
        1e3 * m.command_hold));
  }
  if (m.inflation > 1) {
    response.warnings.push_back(Tell(
        "second order with dead time does not describe the points within their noise: misfit is "
        "{:.3g} times the noise, intervals are widened by that",
        "zweite Ordnung mit Totzeit beschreibt die Punkte nicht innerhalb ihres Rauschens: die Abweichung ist {:.3g}-mal das "
        "Rauschen, die Intervalle sind darum weiter",
        m.inflation));
  }
}

}  // namespace

const char* MethodName(FrequencyResponseMethod method) {
  switch (method) {
    case FrequencyResponseMethod::kAuto:
      return "auto";
    case FrequencyResponseMethod::kSine:
      return "sine";
    case FrequencyResponseMethod::kWelch:
      return "welch";
  }
  return "";
}

const char* PointReasonName(PointReason reason) {
  switch (reason) {
    case PointReason::kUsed:
      return "used";
    case PointReason::kTooShort:
      return "too_short";
    case PointReason::kNoResponse:
      return "no_response";
    case PointReason::kLowCoherence:
      return "low_coherence";
    case PointReason::kClipped:
      return "clipped";
    case PointReason::kNoPower:
      return "no_power";
    case PointReason::kDisturbed:
      return "disturbed";
    case PointReason::kOffTheOthers:
      return "off_the_others";
    case PointReason::kOutsideRange:
      return "outside_range";
  }
  return "";
}

Status FrequencyResponseOptions::Validate() const {
  constexpr std::size_t kLeastSegment = 32;
  TRY(ValidateSpectra(*this, kLeastSegment));
  if (settle_time < 0) return UsageError("settle time {} s: a positive number is needed", settle_time);
  return {};
}

void LeaveOutOfRange(std::vector<FrequencyPoint>& points, const FrequencyResponseOptions& options) {
  for (FrequencyPoint& p : points) {
    // A frequency that is held is known to some 1e-8.
    const bool inside =
        p.frequency >= options.lowest * (1 - 1e-6) && p.frequency <= options.highest * (1 + 1e-6);
    if (p.reason == PointReason::kUsed && !inside) p.reason = PointReason::kOutsideRange;
  }
}

Result<FrequencyResponse> MeasureFrequencyResponse(const FrequencyRecord& record,
                                                   const FrequencyResponseOptions& options) {
  TRY(options.Validate());
  TRY(CheckRecord(record));
  FrequencyResponseMethod method = options.method;
  Search search;
  if (method != FrequencyResponseMethod::kWelch) search = SearchHeldSines(record);
  if (method == FrequencyResponseMethod::kAuto) {
    const bool held = !search.held.empty() &&
                      static_cast<double>(search.covered) > kHeldShare * static_cast<double>(search.active);
    method = held ? FrequencyResponseMethod::kSine : FrequencyResponseMethod::kWelch;
  }
  auto response = method == FrequencyResponseMethod::kSine ? BySteppedSines(record, search, options)
                                                           : ByWelch(record, options);
  if (!response) return response;
  response->model_reason = WhyNoModel(*response, record.shares);
  if (!response->model_reason.empty()) response->model.reset();
  AddModelWarnings(*response);
  return response;
}

double FrequencyPoint::OwnDistortion() const {
  const double own = output_distortion - std::max(0.0, input_distortion);
  return own > 4 * distortion_std ? own : 0;
}

double WorstDistortion(const std::vector<FrequencyPoint>& points) {
  double worst = 0;
  for (const FrequencyPoint& p : points)
    if (p.reason != PointReason::kNoResponse) worst = std::max(worst, p.OwnDistortion());
  return worst;
}

std::optional<ValveCheck> MakeValveCheck(const FrequencyResponse& response, double time,
                                         double supply_pressure, double oil_temperature) {
  if (!response.model) return std::nullopt;
  const ValveModel& m = *response.model;
  ValveCheck check{time, m.natural_frequency, m.damping, m.gain, m.dead_time, m.bandwidth, m.phase_90};
  std::vector<double> amplitudes;
  for (const FrequencyPoint& p : response.points) {
    if (p.reason == PointReason::kUsed) amplitudes.push_back(p.amplitude);
  }
  std::nth_element(amplitudes.begin(), amplitudes.begin() + amplitudes.size() / 2, amplitudes.end());
  check.amplitude = amplitudes[amplitudes.size() / 2];
  check.worst_distortion = WorstDistortion(response.points);
  check.supply_pressure = supply_pressure;
  check.oil_temperature = oil_temperature;
  return check;
}

}  // namespace hydroscope
