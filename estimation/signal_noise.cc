#include "estimation/signal_noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/short_number.h"
#include "core/units.h"

namespace hydroscope {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

/// Steps between neighbouring readings.
struct ReadingSteps {
  double smallest = 0, median = 0;
  double repeated = 0;           ///< share of readings that equal the one before
  std::vector<double> steps;     ///< other than zero
  std::vector<double> readings;  ///< behind them

  static ReadingSteps Of(std::span<const SignalRuns> strokes) {
    ReadingSteps out;
    std::size_t pairs = 0;
    for (const SignalRuns& stroke : strokes)
      for (const std::vector<double>& run : stroke)
        for (std::size_t k = 1; k < run.size(); ++k, ++pairs) {
          if (run[k] == run[k - 1]) continue;
          out.steps.push_back(std::abs(run[k] - run[k - 1]));
          out.readings.push_back(run[k]);
        }
    if (pairs == 0) return out;
    out.repeated = 1.0 - static_cast<double>(out.steps.size()) / static_cast<double>(pairs);
    if (out.steps.empty()) return out;
    const auto middle = out.steps.begin() + out.steps.size() / 2;
    std::nth_element(out.steps.begin(), middle, out.steps.end());
    out.median = *middle;
    // Rounding of decimal numbers makes tiny differences of differences; a step is one that is reached.
    out.smallest = *std::ranges::min_element(out.steps);
    return out;
  }

  /// Share of steps that are no multiple of the smallest.
  double OffGrid() const {
    constexpr double kOffGrid = 0.1;  // of the smallest step
    const auto off = std::ranges::count_if(steps, [&](double step) {
      const double multiple = step / smallest;
      return std::abs(multiple - std::round(multiple)) > kOffGrid;
    });
    return steps.empty() ? 0.0 : static_cast<double>(off) / static_cast<double>(steps.size());
  }

  /// Share of the readings that no other equals.
  double Unique() const {
    std::vector<double> sorted = readings;
    std::ranges::sort(sorted);
    std::size_t alone = 0;
    for (std::size_t k = 0; k < sorted.size(); ++k)
      alone +=
          (k == 0 || sorted[k] != sorted[k - 1]) && (k + 1 == sorted.size() || sorted[k] != sorted[k + 1]);
    return sorted.empty() ? 0.0 : static_cast<double>(alone) / static_cast<double>(sorted.size());
  }
};

/// Readings between their neighbours: on the straight line, or a corner.
struct Corners {
  double straight = 0;    ///< share of readings, without those that repeat the one before
  double resolution = 0;  ///< the smallest bend
  double median = 0;      ///< bend
  double turned = 0;      ///< share of corners at which the signal turns back, ...
  double against = 0;     ///< ... and of those that bend against the one before

  static Corners Of(std::span<const SignalRuns> strokes, double range) {
    Corners out;
    out.resolution = std::max(SmallestBend(strokes), kRoundOff * range);
    // Rounding shifts each of the three readings by half a step, the middle one twice.
    const double rounding = kRoundingSteps * out.resolution;
    std::vector<double> bends;
    std::size_t readings = 0, straight = 0, turned = 0, against = 0;
    for (const SignalRuns& stroke : strokes)
      for (const std::vector<double>& run : stroke) {
        double last = 0;  // bend
        for (std::size_t k = 2; k < run.size(); ++k, ++readings) {
          const double before = run[k - 1] - run[k - 2], after = run[k] - run[k - 1], bend = after - before;
          if (std::abs(bend) > rounding) {
            bends.push_back(std::abs(bend));
            turned += before * after < 0;
            against += bend * last < 0;
            last = bend;
          } else {
            straight += before != 0 && after != 0;
          }
        }
      }
    if (readings > 0) out.straight = static_cast<double>(straight) / static_cast<double>(readings);
    if (bends.empty()) return out;
    out.turned = static_cast<double>(turned) / static_cast<double>(bends.size());
    out.against = static_cast<double>(against) / static_cast<double>(bends.size());
    const auto middle = bends.begin() + bends.size() / 2;
    std::nth_element(bends.begin(), middle, bends.end());
    out.median = *middle;
    return out;
  }
  /// Where noise is drawn the signal turns back; where motion with noise is, it bends to and fro by less than it moves.
  bool AreOfInterpolation(double usual_step, const SignalNoiseOptions& options) const {
    return straight >= options.straight_share && median >= options.corner_steps * resolution &&
           (turned >= options.corner_turns ||
            (against >= options.corner_reversals && median <= options.corner_bend * usual_step));
  }

 private:
  static constexpr double kRoundingSteps = 2.5, kRoundOff = 1e-12;

  static double SmallestBend(std::span<const SignalRuns> strokes) {
    double smallest = std::numeric_limits<double>::infinity();
    for (const SignalRuns& stroke : strokes)
      for (const std::vector<double>& run : stroke)
        for (std::size_t k = 2; k < run.size(); ++k)
          if (const double bend = std::abs(run[k] - 2 * run[k - 1] + run[k - 2]); bend > 0)
            smallest = std::min(smallest, bend);
    return std::isfinite(smallest) ? smallest : 0;
  }
};

Told Milliseconds(double s) { return TellNumber(ShortNumber(1e3 * s) + " ms"); }

/// From the 5 % to the 95 % quantile.
double RangeOf(std::span<const SignalRuns> strokes) {
  std::vector<double> rows;
  for (const SignalRuns& stroke : strokes)
    for (const std::vector<double>& run : stroke) rows.insert(rows.end(), run.begin(), run.end());
  if (rows.empty()) return 0;
  const auto quantile = [&](double q) {
    const auto at = rows.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(rows.size() - 1));
    std::nth_element(rows.begin(), at, rows.end());
    return *at;
  };
  const double low = quantile(0.05);
  return quantile(0.95) - low;
}

void DescribeSteps(const ReadingSteps& steps, double period, const SignalNoiseOptions& options,
                   SignalNoise& noise) {
  const int percent = static_cast<int>(std::lround(100 * noise.repeated));
  const bool on_grid = steps.OffGrid() <= options.off_grid_share || steps.Unique() <= options.unique_share;
  if (on_grid && noise.quiet_std > options.hidden_noise * noise.quantum) {
    noise.kind = NoiseKind::kRepeats;
    noise.sentence = Tell(
        "{} % of the readings of {} repeat the one before, and the others move by many times its resolution: it does not follow "
        "every motion, as with play, friction or a deadband, and its noise cannot be seen",
        "{} % der Werte von {} wiederholen den davor, und die anderen bewegen sich um ein Vielfaches seiner Auflösung: es folgt nicht "
        "jeder Bewegung, wie bei Spiel, Reibung oder einem Totband, und sein Rauschen ist nicht zu sehen",
        percent, noise.name);
    return;
  }
  if (on_grid) {
    noise.kind = NoiseKind::kQuantised;
    noise.sentence = Tell(
        "{} is read in steps of {}, which hide its noise: {} % of the readings repeat the one before",
        "{} wird in Stufen von {} gelesen, die das Rauschen verdecken: {} % der Werte wiederholen den davor",
        noise.name, WithUnit(noise.quantum, noise.unit), percent);
    return;
  }
  noise.kind = NoiseKind::kHeld;
  if (steps.smallest >= options.deadband_step * steps.median)
    noise.sentence = Tell(
        "{} was stored only where it had moved by {} or more, as a historian with a deadband does: {} % of its readings repeat "
        "the one before; what it did in between is lost. Record it at every row",
        "{} wurde nur gespeichert, wo es sich um {} oder mehr bewegt hatte, wie ein Archiv mit Totband es tut: {} % der Werte "
        "wiederholen den davor; was dazwischen geschah, fehlt. In jeder Zeile aufzeichnen",
        noise.name, WithUnit(steps.smallest, noise.unit), percent);
  else
    noise.sentence =
        Tell("{} % of the readings of {} repeat the one before: it is updated less often than every {}",
             "{} % der Werte von {} wiederholen den davor: es wird seltener als alle {} erneuert", percent,
             noise.name, Milliseconds(period));
}

void DescribeInterpolation(SignalNoise& noise) {
  noise.kind = NoiseKind::kInterpolated;
  noise.sentence = Tell(
      "{} was not stored at every row: {:.0f} % of its readings lie on straight lines between others, as a historian with a "
      "deadband exports them; what it did in between is lost, and looks like a play, a lag or a delay of it",
      "{} wurde nicht in jeder Zeile gespeichert: {:.0f} % der Werte liegen auf Geraden zwischen anderen, wie ein "
      "Archiv mit Totband sie ausgibt; was dazwischen geschah, fehlt und sieht aus wie Spiel, Trägheit oder Verzug",
      noise.name, 100 * noise.straight);
}

void DescribeMotion(double period, bool beyond_stated, SignalNoise& noise) {
  noise.kind = NoiseKind::kSignalInContrast;
  const Told over = Milliseconds(3 * period);
  noise.sentence =
      beyond_stated
          ? Tell(
                "{} scatters by {} from row to row, its stated noise is {}: it moves within {}, "
                "or more noise is there than stated",
                "{} streut von Zeile zu Zeile um {}, angegeben ist ein Rauschen von {}: es bewegt sich innerhalb von "
                "{}, oder es rauscht mehr als angegeben",
                noise.name, WithUnit(noise.std, noise.unit), WithUnit(noise.stated, noise.unit), over)
          : Tell("{} moves within the {} over which noise is told from motion: its noise cannot be seen",
                 "{} bewegt sich innerhalb der {}, über die Rauschen von Bewegung getrennt wird: "
                 "sein Rauschen ist nicht zu sehen",
                 noise.name, over);
}

void DescribeColour(bool stronger, SignalNoise& noise) {
  noise.kind = NoiseKind::kColoured;
  const bool four_rows = stronger && std::isfinite(noise.slow_ratio);
  noise.sentence = Tell(
      "noise of {} is not white: over {} rows {:.2g} times as strong as from row to row, {}",
      "das Rauschen von {} ist nicht weiß: über {} Zeilen {:.2g}-mal so stark wie von Zeile zu Zeile, {}",
      noise.name, four_rows ? 4 : 2, four_rows ? noise.slow_ratio : noise.ratio,
      stronger ? Tell("a sensor or controller filters it", "ein Sensor oder eine Steuerung filtert es")
               : Tell("neighbouring rows are not independent readings",
                      "benachbarte Zeilen sind keine unabhängigen Werte"));
}

void DescribeDisagreement(SignalNoise& noise) {
  noise.kind = NoiseKind::kDisagreesWithStated;
  noise.sentence = Tell("{} scatters by {} from row to row, the machine file states a noise of {}",
                        "{} streut von Zeile zu Zeile um {}, die Maschinendatei gibt ein Rauschen von {} an",
                        noise.name, WithUnit(noise.std, noise.unit), WithUnit(noise.stated, noise.unit));
}

void JudgeContrasts(const RowContrasts& contrasts, double period, const SignalNoiseOptions& options,
                    SignalNoise& noise) {
  const EnergyRatio pairs = contrasts.OverRows(1), fours = contrasts.OverRows(2);
  const EnergyRatio all = contrasts.OverQuiet(0), all_pairs = contrasts.OverQuiet(1);
  noise.ratio = pairs.value();
  noise.ratio_low = std::exp(pairs.log - pairs.Band95());
  noise.ratio_high = std::exp(pairs.log + pairs.Band95());
  noise.slope = pairs.log / std::log(2.0);
  const bool four_rows = contrasts.reach() == 8;
  const bool motion = four_rows && fours.value() - 1 > options.motion_growth * (pairs.value() - 1);
  noise.slow_ratio = four_rows && !motion ? fours.value() : kNotANumber;

  const double p = options.significance, tolerated = options.tolerated_ratio;
  const bool moves = all.ClearlyAbove(options.motion_share, p) && all_pairs.log > 2 * all.log;
  const bool beyond_stated = noise.std > (1 + options.stated_tolerance) * noise.stated;
  const bool stronger = !motion && (pairs.ClearlyAbove(tolerated, p) ||
                                    (four_rows && fours.ClearlyAbove(options.motion_trace, p)));
  noise.seen_at_rest = noise.ratio <= options.motion_ratio && !beyond_stated;
  const bool motion_or_colour = motion && pairs.ClearlyAbove(options.motion_trace, p);
  if (!noise.seen_at_rest || moves || motion_or_colour)
    DescribeMotion(period, beyond_stated, noise);
  else if (stronger || pairs.ClearlyBelow(1 / tolerated, p))
    DescribeColour(stronger, noise);
  else if (noise.std * (1 + options.stated_tolerance) < noise.stated)
    DescribeDisagreement(noise);
  else
    noise.kind = NoiseKind::kWhite;
}

}  // namespace

Told WithUnit(double si, const std::string& unit) {
  const DisplayUnit shown = unit == "K" ? DisplayUnit{1, 0, "K"} : DisplayUnitFor(unit);
  return TellNumber(fmt::format("{}{}{}", ShortNumber(si * shown.factor),
                                shown.name == "1" || shown.name.empty() ? "" : " ",
                                shown.name == "1" ? "" : shown.name));
}

const char* NoiseKindName(NoiseKind kind) {
  switch (kind) {
    case NoiseKind::kUnknown:
      return "not known";
    case NoiseKind::kWhite:
      return "white";
    case NoiseKind::kColoured:
      return "coloured";
    case NoiseKind::kQuantised:
      return "quantised";
    case NoiseKind::kSignalInContrast:
      return "signal";
    case NoiseKind::kDisagreesWithStated:
      return "not as stated";
    case NoiseKind::kInterpolated:
      return "interpolated";
    case NoiseKind::kHeld:
      return "held";
    case NoiseKind::kRepeats:
      return "repeating";
  }
  return "not known";
}

SignalNoise JudgeSignalNoise(const std::string& name, const std::string& unit,
                             std::span<const SignalRuns> strokes, double period, double stated,
                             const SignalNoiseOptions& options) {
  SignalNoise noise;
  noise.name = name;
  noise.unit = unit;
  noise.stated = stated;
  const ReadingSteps steps = ReadingSteps::Of(strokes);
  noise.quantum = steps.smallest;
  noise.repeated = steps.repeated;
  noise.range = RangeOf(strokes);
  const Corners corners = Corners::Of(strokes, noise.range);
  noise.straight = corners.straight;
  const RowContrasts contrasts(strokes, options.chunks);
  if (contrasts.empty()) return noise;
  noise.std = std::sqrt(contrasts.Energy(0, false));
  noise.quiet_std = std::sqrt(contrasts.Energy(0, true));
  if (noise.std > noise.quiet_std)
    noise.loud_growth = (contrasts.Energy(1, false) - contrasts.Energy(1, true)) /
                        (contrasts.Energy(0, false) - contrasts.Energy(0, true));
  if (noise.std <= 0) return noise;
  if (noise.repeated > options.repeated_share)
    DescribeSteps(steps, period, options, noise);
  else
    JudgeContrasts(contrasts, period, options, noise);
  if (noise.kind != NoiseKind::kHeld && corners.AreOfInterpolation(steps.median, options))
    DescribeInterpolation(noise);
  return noise;
}

}  // namespace hydroscope
