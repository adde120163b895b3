#include "service/column_meaning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/units.h"

namespace hydroscope {
namespace {

bool IsPressure(Role role) {
  return role == Role::kPressureA || role == Role::kPressureB || role == Role::kSupplyPressure ||
         role == Role::kTankPressure || role == Role::kPressure;
}

std::string_view SiOf(Role role) {
  if (IsPressure(role)) return "Pa";
  switch (role) {
    case Role::kTime:
      return "s";
    case Role::kPosition:
    case Role::kPositionCommand:
      return "m";
    case Role::kValveCommand:
      return "V";
    case Role::kOilTemperature:
      return "K";
    case Role::kForce:
      return "N";
    default:
      return "1";
  }
}

/// The unit of the header as the machine file writes it: "Bar", "C", "°C", "grad" are usual spellings.
std::string KnownSpelling(const std::string& unit) {
  if (FindUnit(unit)) return unit;
  std::string lower = unit;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (lower == "c" || lower == "deg c" || lower == "grad c" || lower == "celsius") return "degC";
  if (lower == "sec" || lower == "sek") return "s";
  if (lower == "-" || lower == "pu") return "1";
  for (const std::string& name : UnitNames()) {
    std::string candidate = name;
    for (char& c : candidate) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (candidate == lower) return name;
  }
  return "";
}

std::string Size(const LogColumn& column) {
  return fmt::format("values {:.4g} ... {:.4g}", column.low, column.high);
}

UnitGuess PressureBySize(double largest) {
  const std::string seen = fmt::format("pressures reach {:.4g}", largest);
  if (largest > 2e5) return {"Pa", 1, 0, seen + ", which can only be Pa"};
  if (largest > 2e3) return {"kPa", 1, 0, seen + ", which fits kPa", false};
  if (largest > 45) return {"bar", 1, 0, seen + ", which fits bar"};
  if (largest > 12) return {"MPa", 1, 0, seen + ", which fits MPa; if it is bar, write bar", false};
  return {"bar", 1, 0, seen + "; taken as bar, it may be MPa or volts", false};
}

UnitGuess TimeBySize(const LogColumn& column) {
  const std::string seen = fmt::format("steps of {:.4g}", column.step);
  if (column.date) return {"s", 1, 0, "date or time of day"};
  if (column.step >= 200) return {"us", 1, 0, seen + ", which fits us", false};
  if (column.step >= 0.2) return {"ms", 1, 0, seen + ", which fits ms", column.step < 100};
  return {"s", 1, 0, seen + ", which fits s"};
}

UnitGuess SpoolBySize(const LogColumn& column, const std::string& header) {
  const double largest = std::max(std::abs(column.low), std::abs(column.high));
  if (header == "V") return {"1", 0.1, 0, "volts in the header, 10 V taken as fully open", false};
  if (header == "mA") return {"1", 0.125, -1.5, "mA in the header, 4 ... 20 mA taken as -1 ... 1", false};
  if (largest <= 1.5) return {"1", 1, 0, Size(column) + " fit -1 ... 1"};
  if (largest <= 12)
    return {"1", 0.1, 0,
            Size(column) + " taken as volts, 10 V fully open; if it is %, write unit % and no scale", false};
  return {"%", 1, 0, Size(column) + " fit %", largest <= 130};
}

/// The spool tells volts from per cent and from -1 ... 1: full command opens it fully.
UnitGuess CommandBySize(const LogColumn& column, const std::string& header, double spool_span) {
  const double largest = std::max(std::abs(column.low), std::abs(column.high));
  const double ratio = spool_span > 0 ? column.span() / spool_span : 0;
  if (header == "mA") return {"V", 0.625, -7.5, "mA in the header, 4 ... 20 mA taken as -10 ... 10 V", false};
  if (header == "%") return {"V", 0.1, 0, "% in the header, 100 % = 10 V"};
  const std::string seen = fmt::format("{}, {:.3g} times the spool's, ", Size(column), ratio);
  if (ratio > 40) return {"V", 0.1, 0, seen + "taken as %, 100 % = 10 V", false};
  if (ratio > 4) return {"V", 1, 0, seen + "fit V", largest <= 15};
  if (ratio > 0) return {"V", 10, 0, seen + "taken as -1 ... 1 of 10 V", false};
  if (largest > 15) return {"V", 0.1, 0, Size(column) + " taken as %, 100 % = 10 V", false};
  return {"V", 1, 0, Size(column) + " taken as V", largest > 1.05};
}

UnitGuess PositionBySize(const LogColumn& column) {
  const double largest = std::max(std::abs(column.low), std::abs(column.high));
  if (largest > 6) return {"mm", 1, 0, Size(column) + " fit mm"};
  return {"m", 1, 0, Size(column) + " fit m", largest <= 2.5 && column.span() < 2.5};
}

bool Taken(const std::vector<ColumnRole>& roles, Role role) {
  return std::any_of(roles.begin(), roles.end(), [&](const ColumnRole& r) { return r.role == role; });
}
bool Used(const std::vector<ColumnRole>& roles, std::size_t column) {
  return std::any_of(roles.begin(), roles.end(), [&](const ColumnRole& r) { return r.column == column; });
}

void ByName(const LogColumns& head, std::vector<ColumnRole>& roles) {
  for (std::size_t i = 0; i < head.columns.size(); ++i) {
    const LogColumn& column = head.columns[i];
    if (!column.numeric() || !head.layout.header) continue;
    const auto role = RoleByName(column.name);
    if (!role || Taken(roles, *role)) continue;
    roles.push_back({i, *role, fmt::format("name \"{}\"", column.name), true});
  }
  // A log with one pressure only: it is the one the model needs.
  if (!Taken(roles, Role::kPressureA))
    for (ColumnRole& role : roles)
      if (role.role == Role::kPressure) {
        role.role = Role::kPressureA;
        role.sure = false;
      }
}

/// A time column without a telling name rises in every row with nearly constant steps; a row counter does too
/// and is only taken if there is nothing better.
void TimeByBehaviour(const LogColumns& head, std::vector<ColumnRole>& roles) {
  if (Taken(roles, Role::kTime)) return;
  for (const bool counter : {false, true})
    for (std::size_t i = 0; i < head.columns.size(); ++i) {
      const LogColumn& column = head.columns[i];
      if (Used(roles, i) || !column.rising || (column.step == 1) != counter) continue;
      roles.push_back({i, Role::kTime, fmt::format("rises in every row, by {:.4g}", column.step), !counter});
      return;
    }
}

double Correlation(const LogColumn& a, const LogColumn& b) {
  double n = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (std::size_t i = 0; i < std::min(a.value.size(), b.value.size()); ++i) {
    const double x = a.value[i] - a.low, y = b.value[i] - b.low;
    if (!(x == x) || !(y == y)) continue;
    n += 1, sa += x, sb += y, saa += x * x, sbb += y * y, sab += x * y;
  }
  const double variance = (n * saa - sa * sa) * (n * sbb - sb * sb);
  return variance > 0 ? (n * sab - sa * sb) / std::sqrt(variance) : 0;
}

/// Columns of Pa size: the steadiest and highest is the supply, the liveliest chamber A.
void PressuresByBehaviour(const LogColumns& head, std::vector<ColumnRole>& roles) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < head.columns.size(); ++i)
    if (!Used(roles, i) && head.columns[i].numeric() && head.columns[i].high > 5e5 &&
        head.columns[i].low > -2e6)
      found.push_back(i);
  std::sort(found.begin(), found.end(),
            [&](std::size_t a, std::size_t b) { return head.columns[a].span() > head.columns[b].span(); });
  const auto give = [&](std::size_t column, Role role, const char* why) {
    if (!Taken(roles, role)) roles.push_back({column, role, why, false});
  };
  if (!found.empty()) give(found[0], Role::kPressureA, "the pressure that moves most");
  if (found.size() == 2) give(found[1], Role::kPressureB, "the other pressure");
  if (found.size() < 3) return;
  const auto highest = std::max_element(found.begin() + 1, found.end(), [&](std::size_t a, std::size_t b) {
    return head.columns[a].low < head.columns[b].low;
  });
  give(*highest, Role::kSupplyPressure, "a high and steady pressure");
  for (auto i = found.begin() + 1; i != found.end(); ++i)
    if (i != highest) give(*i, Role::kPressureB, "a pressure that moves little");
}

/// Spool and command run together, within -1.2 ... 1.2 and within +-12; what is left and smooth is the
/// position.
void ValveAndPositionByBehaviour(const LogColumns& head, std::vector<ColumnRole>& roles) {
  const auto free = [&](std::size_t i) {
    return !Used(roles, i) && head.columns[i].numeric() && head.columns[i].span() > 0 &&
           head.columns[i].step != 1;
  };
  for (std::size_t i = 0; i < head.columns.size() && !Taken(roles, Role::kSpool); ++i)
    for (std::size_t k = 0; k < head.columns.size(); ++k) {
      const LogColumn &spool = head.columns[i], &command = head.columns[k];
      if (i == k || !free(i) || !free(k) || Taken(roles, Role::kValveCommand)) continue;
      const bool sizes = std::abs(spool.high) < 1.2 && std::abs(spool.low) < 1.2 &&
                         std::abs(command.high) < 12 && std::abs(command.low) < 12 &&
                         command.span() > 3 * spool.span();
      if (!sizes || Correlation(spool, command) < 0.8) continue;
      roles.push_back({i, Role::kSpool, fmt::format("within -1 ... 1 and follows {}", command.name), false});
      roles.push_back({k, Role::kValveCommand, fmt::format("within +-12, {} follows it", spool.name), false});
    }
  for (std::size_t i = 0; i < head.columns.size() && !Taken(roles, Role::kOilTemperature); ++i)
    if (free(i) && head.columns[i].low > 12 && head.columns[i].high < 95 && head.columns[i].span() < 15 &&
        Taken(roles, Role::kPressureA) && Taken(roles, Role::kSpool))
      roles.push_back({i, Role::kOilTemperature, "hardly changes, within 12 ... 95", false});
  if (Taken(roles, Role::kPosition) || !Taken(roles, Role::kPressureA)) return;
  std::optional<std::size_t> smoothest;
  for (std::size_t i = 0; i < head.columns.size(); ++i)
    if (free(i) && (!smoothest || head.columns[i].roughness < head.columns[*smoothest].roughness))
      smoothest = i;
  if (smoothest && head.columns[*smoothest].roughness < 0.1)
    roles.push_back({*smoothest, Role::kPosition, "the smoothest of the remaining columns", false});
}

}  // namespace

UnitGuess GuessUnit(Role role, const LogColumn& column, const SharedSizes& sizes) {
  const std::string header = KnownSpelling(column.unit);
  if (!header.empty() && FindUnit(header)->si == SiOf(role) && !column.date)
    return {header, 1, 0, "unit in the header", true};
  if (IsPressure(role)) return PressureBySize(sizes.largest_pressure);
  switch (role) {
    case Role::kTime:
      return TimeBySize(column);
    case Role::kSpool:
      return SpoolBySize(column, header);
    case Role::kValveCommand:
      return CommandBySize(column, header, sizes.spool_span);
    case Role::kPosition:
    case Role::kPositionCommand:
      return PositionBySize(column);
    case Role::kOilTemperature:
      if (column.low > 220) return {"K", 1, 0, Size(column) + " fit K"};
      return {"degC", 1, 0, Size(column) + " fit degC", column.low > -40 && column.high < 150};
    default:
      return {"N", 1, 0, Size(column) + " taken as N", false};
  }
}

SharedSizes FindSharedSizes(const LogColumns& head, const std::vector<ColumnRole>& roles) {
  SharedSizes sizes;
  for (const ColumnRole& found : roles) {
    const LogColumn& column = head.columns[found.column];
    if (IsPressure(found.role)) sizes.largest_pressure = std::max(sizes.largest_pressure, column.high);
    if (found.role != Role::kSpool) continue;
    const UnitGuess guess = GuessUnit(found.role, column, {});
    sizes.spool_span = column.span() * guess.scale * FindUnit(guess.unit).value_or(Unit{}).scale;
  }
  return sizes;
}

std::vector<ColumnRole> AssignRoles(const LogColumns& head) {
  std::vector<ColumnRole> roles;
  ByName(head, roles);
  TimeByBehaviour(head, roles);
  PressuresByBehaviour(head, roles);
  ValveAndPositionByBehaviour(head, roles);
  return roles;
}

}  // namespace hydroscope
