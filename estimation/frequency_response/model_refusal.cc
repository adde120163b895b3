#include "estimation/frequency_response/model_refusal.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace hydroscope {
namespace {

/// Distance of the points from the model, rms over rms of the gain, above which the model describes another thing. Second order
/// is an approximation: that of the servo press (`hydroscope frf chirp_0A.txt --segment 4096`) is off by 1.5 %. Beyond
/// the limit f0 is of no valve, whatever its interval says: a spool at its highest speed, a dead band, or a valve that
/// changed amid the sweep.
constexpr double kFarOff = 0.05;
/// Distance of the response from a mere gain and delay, relative, below which it has no dynamics.
constexpr double kNoLag = 0.005, kFewestPoints = 3;
/// Output in shares of the stroke over input in shares of full command, and Hz: beyond, no valve is like that.
constexpr double kLeastGain = 0.2, kMostGain = 5, kLeastFrequency = 0.5, kMostFrequency = 5000;

/// Applies to every point that is used.
template <typename Sum>
double SumOverUsed(const std::vector<FrequencyPoint>& points, const Sum& sum) {
  double total = 0;
  for (const FrequencyPoint& p : points)
    if (p.reason == PointReason::kUsed) total += sum(p);
  return total;
}

double Omega(const FrequencyPoint& p) { return 2 * std::numbers::pi * p.frequency; }

double DistanceFromModel(const FrequencyResponse& response) {
  const double power = SumOverUsed(response.points, [](const auto& p) { return std::norm(p.response); });
  const double off = SumOverUsed(response.points, [&](const auto& p) {
    return std::norm(p.response - response.model->Response(p.frequency));
  });
  return std::sqrt(off / power);
}

/// Of the points from K exp(-j omega tau), K and tau as suit them best; relative, rms. Infinity of too few points.
double DistanceFromDelay(const std::vector<FrequencyPoint>& points) {
  const double count = SumOverUsed(points, [](const auto&) { return 1.0; });
  if (count < kFewestPoints) return std::numeric_limits<double>::infinity();
  const double gain = SumOverUsed(points, [](const auto& p) { return std::abs(p.response); }) / count;
  const double turned =
      std::cos(std::ranges::find(points, PointReason::kUsed, &FrequencyPoint::reason)->phase);
  const auto phase = [&](const FrequencyPoint& p) {
    return p.phase - (turned < 0 ? std::copysign(std::numbers::pi, p.phase) : 0.0);
  };
  const double squares = SumOverUsed(points, [](const auto& p) { return Omega(p) * Omega(p); });
  const double delay = -SumOverUsed(points, [&](const auto& p) { return Omega(p) * phase(p); }) / squares;
  const double off = SumOverUsed(points, [&](const auto& p) {
    return std::norm(p.response / (turned < 0 ? -gain : gain) - std::polar(1.0, -Omega(p) * delay));
  });
  return std::sqrt(off / count);
}

/// Nothing if gain and corner frequency may be a valve's.
Told WhyNoValve(const ValveModel& m) {
  const double gain = std::abs(m.gain.value);
  if (gain < kLeastGain || gain > kMostGain)
    return Tell(
        "full command would move the spool by {:.3g} of its stroke: a unit is not the one that the machine file says (unit of "
        "command and response, [valve] full_scale)",
        "der volle Befehl würde den Schieber um das {:.3g}-fache seines Hubs bewegen: eine Einheit ist nicht die, die in der "
        "Maschinendatei steht (Einheit von Befehl und Antwort, [valve] full_scale)",
        gain);
  const double corner =
      m.first_order ? m.natural_frequency.value / (2 * m.damping.value) : m.natural_frequency.value;
  if (corner < kLeastFrequency || corner > kMostFrequency)
    return Tell(
        "the valve would have its corner at {:.3g} Hz: the time is not in the unit that the machine file says, or command and "
        "response are not a valve's",
        "das Ventil hätte seine Eckfrequenz bei {:.3g} Hz: die Zeit ist nicht in der Einheit, die in der Maschinendatei steht, "
        "oder Befehl und Antwort sind nicht die eines Ventils",
        corner);
  return {};
}

}  // namespace

Told WhyNoModel(const FrequencyResponse& response, bool shares) {
  if (DistanceFromDelay(response.points) < kNoLag)
    return {
        "the response follows the command without any lag but a delay: it is the command once more, "
        "or a set point, not what the valve did",
        "die Antwort folgt dem Befehl ohne jede Trägheit, nur verzögert: sie ist der Befehl noch einmal oder ein Sollwert, nicht "
        "was das Ventil tat"};
  if (!response.model) return response.model_reason;
  const ValveModel& m = *response.model;
  if (const double off = DistanceFromModel(response); m.inflation > 1 && off > kFarOff)
    return Tell(
        "second order with dead time does not describe the points, which lie {:.0f} % off it: the spool ran into a limit of speed "
        "or stroke or has a dead band (repeat with less amplitude), valve or sensor changed amid the record, or the rows are too far "
        "apart for these frequencies (log faster, or leave the highest out with --to)",
        "zweite Ordnung mit Totzeit beschreibt die Punkte nicht, die {:.0f} % daneben liegen: der Schieber lief an eine Grenze von "
        "Geschwindigkeit oder Hub oder hat eine tote Zone (mit weniger Amplitude wiederholen), Ventil oder Sensor änderte sich "
        "während der Aufzeichnung, oder die Zeilen liegen für diese Frequenzen zu weit auseinander (schneller aufzeichnen oder die "
        "höchsten mit --to auslassen)",
        100 * off);
  return shares ? WhyNoValve(m) : Told();
}

}  // namespace hydroscope
