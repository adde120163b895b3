#include "core/units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/constants.h"

namespace hydroscope {
namespace {

using Named = std::pair<std::string_view, Unit>;
constexpr std::array<Named, 75> kUnits = {{
    {"1", {1, 0, "1"}},
    {"%", {0.01, 0, "1"}},
    {"s", {1, 0, "s"}},
    {"ms", {1e-3, 0, "s"}},
    {"us", {1e-6, 0, "s"}},
    {"ns", {1e-9, 0, "s"}},
    {"min", {60, 0, "s"}},
    {"h", {3600, 0, "s"}},
    {"d", {86400, 0, "s"}},
    {"Pa", {1, 0, "Pa"}},
    {"kPa", {1e3, 0, "Pa"}},
    {"MPa", {1e6, 0, "Pa"}},
    {"GPa", {1e9, 0, "Pa"}},
    {"bar", {1e5, 0, "Pa"}},
    {"mbar", {1e2, 0, "Pa"}},
    {"psi", {6894.757293168, 0, "Pa"}},
    {"m", {1, 0, "m"}},
    {"cm", {1e-2, 0, "m"}},
    {"mm", {1e-3, 0, "m"}},
    {"um", {1e-6, 0, "m"}},
    {"in", {0.0254, 0, "m"}},
    {"ft", {0.3048, 0, "m"}},
    {"m/s", {1, 0, "m/s"}},
    {"mm/s", {1e-3, 0, "m/s"}},
    {"m2", {1, 0, "m2"}},
    {"cm2", {1e-4, 0, "m2"}},
    {"mm2", {1e-6, 0, "m2"}},
    {"in2", {6.4516e-4, 0, "m2"}},
    {"m3", {1, 0, "m3"}},
    {"l", {1e-3, 0, "m3"}},
    {"cm3", {1e-6, 0, "m3"}},
    {"m3/s", {1, 0, "m3/s"}},
    {"l/min", {1e-3 / 60, 0, "m3/s"}},
    {"gpm", {3.785411784e-3 / 60, 0, "m3/s"}},
    {"V", {1, 0, "V"}},
    {"mV", {1e-3, 0, "V"}},
    {"mA", {1e-3, 0, "A"}},
    {"A", {1, 0, "A"}},
    {"N", {1, 0, "N"}},
    {"kN", {1e3, 0, "N"}},
    {"lbf", {4.4482216152605, 0, "N"}},
    {"K", {1, 0, "K"}},
    {"degC", {1, 273.15, "K"}},
    {"°C", {1, 273.15, "K"}},
    {"degF", {5.0 / 9, 459.67 * 5 / 9, "K"}},
    {"Hz", {1, 0, "Hz"}},
    {"rad/s", {1, 0, "rad/s"}},
    {"m3/(s Pa)", {1, 0, "m3/(s Pa)"}},
    {"rad", {1, 0, "rad"}},
    {"deg", {kTwoPi / 360, 0, "rad"}},
    {"1/s", {1, 0, "1/s"}},
    {"1/min", {1.0 / 60, 0, "1/s"}},
    {"W", {1, 0, "W"}},
    {"kW", {1e3, 0, "W"}},
    {"Nm", {1, 0, "N m"}},
    {"rpm", {kTwoPi / 60, 0, "rad/s"}},
    {"m/s2", {1, 0, "m/s2"}},
    {"kg", {1, 0, "kg"}},
    {"kg m", {1, 0, "kg m"}},
    {"kg m2", {1, 0, "kg m2"}},
    {"1/K", {1, 0, "1/K"}},
    {"%/K", {0.01, 0, "1/K"}},
    {"mm/s2", {1e-3, 0, "m/s2"}},
    {"rad/s2", {1, 0, "rad/s2"}},
    {"J", {1, 0, "J"}},
    {"kJ", {1e3, 0, "J"}},
    {"N/m", {1, 0, "N/m"}},
    {"N/mm", {1e3, 0, "N/m"}},
    {"N s/m", {1, 0, "N s/m"}},
    {"1/V", {1, 0, "1/V"}},
    {"m3/s2", {1, 0, "m3/s2"}},
    {"m3/(s A)", {1, 0, "m3/(s A)"}},
    {"kNm", {1e3, 0, "N m"}},
    {"MN", {1e6, 0, "N"}},
    {"U/min", {kTwoPi / 60, 0, "rad/s"}},
}};

/// The SI unit of `si` per second.
std::string RateOf(std::string_view si) {
  if (si == "1") return "1/s";
  if (si == "J") return "W";
  for (const std::string_view rate : {"m/s", "rad/s", "m3/s"})
    if (si == rate) return std::string(rate) + "2";
  return std::string(si) + "/s";
}

/// "bar/s", "K/min", "l/h": every unit but those of time, per second, per minute and per hour.
const std::map<std::string, Unit, std::less<>>& Rates() {
  static const auto rates = [] {
    static std::set<std::string> si;  // what Unit::si looks into
    std::map<std::string, Unit, std::less<>> all;
    for (const auto& [name, unit] : kUnits) {
      if (unit.si == "s") continue;
      const std::string_view rate = *si.insert(RateOf(unit.si)).first;
      all[std::string(name) + "/s"] = {unit.scale, 0, rate};
      all[std::string(name) + "/min"] = {unit.scale / 60, 0, rate};
      all[std::string(name) + "/h"] = {unit.scale / 3600, 0, rate};
    }
    return all;
  }();
  return rates;
}

/// "m/s²", "N·m", "µm", "°": what people type in place of "m/s2", "Nm", "um", "deg".
std::string PlainSpelling(std::string name) {
  constexpr std::pair<std::string_view, std::string_view> kTyped[] = {
      {"²", "2"}, {"³", "3"}, {"^", ""}, {"µ", "u"}, {"μ", "u"}, {"N·m", "Nm"}, {"°C", "degC"}, {"°", "deg"}};
  for (const auto& [typed, plain] : kTyped)
    for (std::size_t at = name.find(typed); at != name.npos; at = name.find(typed, at + plain.size()))
      name.replace(at, typed.size(), plain);
  return name;
}

/// Letters to put in, leave out, replace or swap with their neighbour.
std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      next[j] = std::min({row[j] + 1, next[j - 1] + 1, row[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        next[j] = std::min(next[j], before[j - 2] + 1);
    }
    before.swap(row);
    row.swap(next);
  }
  return row.back();
}

std::optional<Unit> Listed(std::string_view name) {
  for (const auto& [key, unit] : kUnits)
    if (key == name) return unit;
  if (const auto rate = Rates().find(name); rate != Rates().end()) return rate->second;
  return std::nullopt;
}

}  // namespace

std::optional<Unit> FindUnit(std::string_view name) {
  if (const auto unit = Listed(name)) return unit;
  return Listed(PlainSpelling(std::string(name)));
}

std::vector<std::string> UnitNames() {
  std::vector<std::string> names;
  for (const auto& [key, unit] : kUnits) names.emplace_back(key);
  return names;
}

DisplayUnit DisplayUnitFor(std::string_view si) {
  if (si == "Pa") return {1e-5, 0, "bar"};
  if (si == "m") return {1e3, 0, "mm"};
  if (si == "m/s") return {1e3, 0, "mm/s"};
  if (si == "m2") return {1e6, 0, "mm2"};
  if (si == "m3") return {1e3, 0, "l"};
  if (si == "m3/s") return {6e4, 0, "l/min"};
  if (si == "m3/(s Pa)") return {6e9, 0, "l/min per bar"};
  if (si == "m3/(s sqrt(Pa))") return {6e4 * std::sqrt(1e5), 0, "l/min per sqrt(bar)"};
  if (si == "N m") return {1, 0, "Nm"};
  if (si == "N m s") return {1, 0, "Nm s"};
  if (si == "K") return {1, -273.15, "°C"};
  return {1, 0, si};
}

std::string Nearest(std::string_view name, const std::vector<std::string>& candidates) {
  std::string best;
  const std::size_t most = std::max<std::size_t>(2, name.size() / 3);
  // At least half of the name must be left, unless one is the beginning of the other.
  const std::size_t most_of_others = std::min(most, std::max<std::size_t>(1, name.size() / 2));
  std::size_t best_distance = std::min(most + 1, name.size());
  for (const std::string& candidate : candidates) {
    const std::size_t distance = EditDistance(name, candidate);
    const bool begins =
        !candidate.empty() && (name.starts_with(candidate) || std::string_view(candidate).starts_with(name));
    if (distance < best_distance && (begins || distance <= most_of_others)) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace hydroscope
