#include "pipeline/log_faults/sensor_ends.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "models/output_unit.h"

namespace hydroscope {
namespace {

constexpr std::size_t kLeastPiled = 10;  ///< readings exactly at the end
/// Of so many readings at any other value none piles up; a coarse converter repeats all of its steps.
constexpr std::size_t kOverAnyOther = 4;
/// What only reaches a value swings back: few readings lie as near to an end that cuts a signal off as it moves from row to row.
constexpr double kShareAtEnd = 0.5;
/// What settles at a value comes to it gently, what is cut off at its own pace: of that the last two steps together.
constexpr double kPaceAtEnd = 0.5;
/// Readings before such a pile that tell whether noise scatters them.
constexpr std::size_t kRowsBefore = 12;
/// Correlation of third differences with the next ones: -3/4 of white noise (-15/20, binomial coefficients), 1 of smooth motion.
constexpr double kOfNoise = -0.4;

double MiddleStep(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Distance between readings that follow each other, of those that differ.
double StepOfARow(const std::vector<double>& x) {
  std::vector<double> steps;
  for (std::size_t row = 1; row < x.size(); ++row)
    if (const double step = std::abs(x[row] - x[row - 1]); step > 0) steps.push_back(step);
  return MiddleStep(std::move(steps));
}

/// The last two steps before a run of readings at `end`.
double StepsInto(const std::vector<double>& x, double end) {
  std::vector<double> steps;
  for (std::size_t row = 2; row < x.size(); ++row)
    if (x[row] == end && x[row - 1] != end && std::isfinite(x[row - 1]))
      steps.push_back(std::abs(x[row] - x[row - 1]) +
                      (std::isfinite(x[row - 2]) ? std::abs(x[row - 1] - x[row - 2]) : 0));
  return MiddleStep(std::move(steps));
}

/// Whether noise of more than a converter's step scatters the readings before a run of readings at `end`: at rest it would scatter
/// them too, and none would repeat.
bool NoiseScattersInto(const std::vector<double>& x, double end, double converter_step) {
  double squares = 0, products = 0, count = 0;
  for (std::size_t row = kRowsBefore; row < x.size(); ++row) {
    if (x[row] != end || x[row - 1] == end) continue;
    double before = NAN;
    for (std::size_t k = row - kRowsBefore; k + 3 < row; ++k) {
      const bool whole = std::none_of(
          x.begin() + static_cast<std::ptrdiff_t>(k), x.begin() + static_cast<std::ptrdiff_t>(k + 4),
          [end](double reading) { return reading == end || !std::isfinite(reading); });
      const double third = whole ? x[k + 3] - 3 * (x[k + 2] - x[k + 1]) - x[k] : NAN;
      if (std::isfinite(third) && std::isfinite(before)) {
        squares += third * third;
        products += third * before;
        ++count;
      }
      before = third;
    }
  }
  constexpr double kThirdOfWhite = 20;  // variance of third differences over that of white noise
  return squares > kThirdOfWhite * count * converter_step * converter_step && products < kOfNoise * squares;
}

/// Least distance between readings that differ.
double ConverterStep(const std::map<double, std::size_t>& counts) {
  double least = INFINITY;
  for (auto next = std::next(counts.begin()); next != counts.end(); ++next)
    least = std::min(least, next->first - std::prev(next)->first);
  return least;
}

/// `sign` -1: the lower end.
std::optional<SensorEnd> EndOf(const std::vector<double>& x, double sign) {
  std::map<double, std::size_t> counts;
  for (const double reading : x)
    if (std::isfinite(reading)) ++counts[sign * reading];
  if (counts.size() < 3) return std::nullopt;
  const auto [end, at] = *counts.rbegin();
  if (end == 0 || at < kLeastPiled) return std::nullopt;
  // The other end may be one as well.
  const std::size_t other =
      std::max_element(std::next(counts.begin()), std::prev(counts.end()), [](const auto& a, const auto& b) {
        return a.second < b.second;
      })->second;
  if (at < kOverAnyOther * other) return std::nullopt;
  const double step = StepOfARow(x);
  if (StepsInto(x, sign * end) < kPaceAtEnd * step &&
      !NoiseScattersInto(x, sign * end, ConverterStep(counts)))
    return std::nullopt;
  std::size_t before = 0;
  for (auto near = counts.lower_bound(end - step); near != counts.end(); ++near) before += near->second;
  before -= at;
  if (static_cast<double>(at) < kShareAtEnd * static_cast<double>(at + before)) return std::nullopt;
  return SensorEnd{.upper = sign > 0, .at = sign * end, .rows = at};
}

/// Whether the machine file says that something stops there.
bool IsStated(const Machine& machine, double at) {
  const auto says = [at](const std::string& limit) {
    char* rest = nullptr;
    const double value = std::strtod(limit.c_str(), &rest);
    return !limit.empty() && *rest == '\0' && std::abs(value - at) <= 1e-6 * std::abs(at);
  };
  return std::ranges::any_of(machine.states.states,
                             [&](const StateSpec& state) { return says(state.min) || says(state.max); });
}

}  // namespace

std::vector<SensorEnd> FlagSensorEnds(const Machine& machine, const std::vector<int>& signals,
                                      SampleBlock& rows) {
  std::vector<SensorEnd> found;
  for (const int signal : signals) {
    const auto s = static_cast<std::size_t>(signal);
    if (machine.signals[s].stuck_time == 0) continue;
    const std::vector<double>& x = rows.signal[s];
    for (const double sign : {1.0, -1.0}) {
      std::optional<SensorEnd> end = EndOf(x, sign);
      if (!end || IsStated(machine, end->at)) continue;
      end->signal = signal;
      for (std::size_t row = 0; row < x.size(); ++row)
        if (x[row] == end->at) rows.quality[s][row] |= quality::kOutOfRange;
      found.push_back(*end);
    }
  }
  return found;
}

std::vector<SensorEnd> FlaggedInputEnds(const Machine& machine, const std::vector<int>& inputs,
                                        const SampleBlock& rows) {
  std::vector<SensorEnd> found;
  for (const int signal : inputs) {
    const auto s = static_cast<std::size_t>(signal);
    const SignalSpec& spec = machine.signals[s];
    const std::vector<double>& x = rows.signal[s];
    std::map<double, std::size_t> flagged;
    for (std::size_t row = 0; row < x.size(); ++row)
      if ((rows.quality[s][row] & quality::kOutOfRange) != 0 && x[row] >= spec.min.value_or(x[row]) &&
          x[row] <= spec.max.value_or(x[row]))
        ++flagged[x[row]];
    for (const auto& [at, count] : flagged)
      if (const bool upper = std::none_of(x.begin(), x.end(), [end = at](double r) { return r > end; });
          count >= kLeastPiled)
        found.push_back({.signal = signal, .upper = upper, .at = at, .rows = count});
  }
  return found;
}

std::vector<CutOff> AsCutOffs(const std::vector<SensorEnd>& ends) {
  std::vector<CutOff> out;
  for (const SensorEnd& end : ends)
    out.push_back({.signal = static_cast<std::size_t>(end.signal), .upper = end.upper, .from = end.at});
  return out;
}

Told SensorEndText(const SensorEnd& end, const Machine& machine) {
  const std::string& signal = machine.signals[end.signal].name;
  const DisplayUnit unit = ShownUnit(machine, signal);
  return Tell(
      "{} stands at its {} reading, {:.4g} {}, in {} rows: its sensor or converter ends there, and these readings are left out; "
      "if what it measures stops there, say so by {} of a state, or by stuck_time = 0 of the signal",
      "{0} steht in {4} Zeilen auf dem {1} Messwert, {2:.4g} {3}: sein Sensor oder Wandler endet dort, und diese Messwerte bleiben "
      "weg; wenn dort aufhört, was er misst, es durch {5} eines Zustands oder stuck_time = 0 des Signals sagen",
      signal, end.upper ? Wording("highest", "höchsten") : Wording("lowest", "niedrigsten"),
      end.at * unit.factor + unit.offset, std::string(unit.name), end.rows, end.upper ? "max" : "min");
}

Told InputEndText(const SensorEnd& end, const Machine& machine) {
  const std::string& signal = machine.signals[static_cast<std::size_t>(end.signal)].name;
  const DisplayUnit unit = ShownUnit(machine, signal);
  return Tell(
      "{} stands at its {} reading, {:.4g} {}, in {} rows: its sensor or converter seems to end there, and episodes go without "
      "these rows; if it is a command or an amplifier that is limited there, say so by stuck_time = 0 of the signal",
      "{0} steht in {4} Zeilen auf dem {1} Messwert, {2:.4g} {3}: sein Sensor oder Wandler scheint dort zu enden, und Episoden "
      "kommen ohne diese Zeilen aus; wenn es ein Sollwert oder Verstärker ist, der dort begrenzt ist, es durch stuck_time = 0 des "
      "Signals sagen",
      signal, end.upper ? Wording("highest", "höchsten") : Wording("lowest", "niedrigsten"),
      end.at * unit.factor + unit.offset, std::string(unit.name), end.rows);
}

}  // namespace hydroscope
