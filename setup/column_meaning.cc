#include "setup/column_meaning.h"

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

/// Day numbers of a spreadsheet: 20000 is in 1954, 80000 in 2119; rows are at most minutes apart.
bool IsDayNumber(const LogColumn& column) {
  return column.low > 20'000 && column.high < 80'000 && column.step > 0 && column.step < 1e-3 &&
         column.span() < 400;
}

/// The unit in which one stroke of the machine takes a plausible time: the nearest to some seconds.
std::optional<UnitGuess> TimeByCycles(const LogColumn& column, double rows_per_cycle) {
  constexpr double kShortest = 0.2, kLongest = 300, kUsual = 6;  // s, of a press stroke with its return
  if (!(rows_per_cycle > 0)) return std::nullopt;
  std::optional<UnitGuess> best;
  double least = 0;
  for (const char* name : {"s", "ms", "us"}) {
    const double cycle = rows_per_cycle * column.step * FindUnit(name)->scale;
    if (cycle < kShortest || cycle > kLongest) continue;
    const double away = std::abs(std::log(cycle / kUsual));
    if (best && away >= least) continue;
    least = away;
    best = UnitGuess{name, 1, 0,
                     fmt::format("steps of {:.4g}; as {} a stroke with its return takes {:.3g} s",
                                 column.step, name, cycle),
                     true};
  }
  return best;
}

UnitGuess TimeBySize(const LogColumn& column, double rows_per_cycle) {
  const std::string seen = fmt::format("steps of {:.4g}", column.step);
  if (column.date) return {"s", 1, 0, "date or time of day"};
  if (IsDayNumber(column))
    return {"d", 1, 0,
            fmt::format("numbers near {:.0f} with steps of {:.3g}: days of a spreadsheet", column.low,
                        column.step)};
  if (const auto guess = TimeByCycles(column, rows_per_cycle)) return *guess;
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

constexpr double kLoopLow = 3.6, kLoopHigh = 20.8;  ///< mA, NAMUR NE 43: a live 4 ... 20 mA signal
/// Ranges that such transmitters usually have; the plate on the sensor knows.
constexpr double kLoopPressure = 400, kLoopTravel = 500, kLoopTemperature = 100;  ///< bar, mm, K

/// 4 ... 20 mA as 0 ... `range` of `unit`.
UnitGuess CurrentLoop(const char* unit, double range, const std::string& seen) {
  const double scale = range / 16;
  return {unit, scale, -4 * scale,
          fmt::format("{}: 4 ... 20 mA, taken as 0 ... {:g} {}, a guess: write the range of the sensor", seen,
                      range, unit),
          false};
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

/// A column's change over some rows, for its motion apart from noise.
std::vector<double> Motion(const LogColumn& column, std::size_t lag) {
  std::vector<double> out(column.value.size(), std::nan(""));
  for (std::size_t i = lag; i + lag < column.value.size(); ++i)
    out[i] = column.value[i + lag] - column.value[i - lag];
  return out;
}

double CorrelationOf(const std::vector<double>& a, const std::vector<double>& b) {
  double n = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (!std::isfinite(a[i]) || !std::isfinite(b[i])) continue;
    n += 1, sa += a[i], sb += b[i], saa += a[i] * a[i], sbb += b[i] * b[i], sab += a[i] * b[i];
  }
  const double variance = (n * saa - sa * sa) * (n * sbb - sb * sb);
  return variance > 0 ? (n * sab - sa * sb) / std::sqrt(variance) : 0;
}

/// Columns whose names say nothing ("AI_0"), in a machine that has not been recognised by names: the position
/// is the smooth one that goes to and fro, the spool follows its speed with both signs, the command runs with
/// the spool, the pressure of chamber A is the one without negative readings that goes with the stroke. All
/// are guesses.
class Anonymous {
 public:
  Anonymous(const LogColumns& head, std::vector<ColumnRole>& roles) : head_(head), roles_(roles) {}

  void Guess() {
    if (Taken(roles_, Role::kPressureA) && Taken(roles_, Role::kPosition) && Taken(roles_, Role::kSpool))
      return;
    if (!GuessPosition()) return;
    GuessSpool();
    GuessPressure();
    GuessRest();
  }

 private:
  static constexpr std::size_t kLag = 5;  ///< rows each way over which a motion is taken
  static constexpr double kSmooth = 0.12, kGoesWith = 0.35, kRunsWith = 0.9;

  bool Free(std::size_t i) const {
    const LogColumn& c = head_.columns[i];
    return !Used(roles_, i) && c.numeric() && c.span() > 0 && !c.rising && !c.date;
  }
  void Give(std::size_t column, Role role, const std::string& why) {
    if (!Taken(roles_, role)) roles_.push_back({column, role, "guessed: " + why, false});
  }
  /// Number of times the column comes back to the middle of its range: a drift does not.
  static bool GoesToAndFro(const LogColumn& column) {
    int crossings = 0;
    bool above = false, first = true;
    const double low = column.low + 0.3 * column.span(), high = column.low + 0.7 * column.span();
    for (const double x : column.value) {
      if (!(x < low) && !(x > high)) continue;
      crossings += !first && above != (x > high);
      above = x > high;
      first = false;
    }
    return crossings >= 4;
  }

  bool GuessPosition() {
    std::optional<std::size_t> best;
    for (const ColumnRole& role : roles_)
      if (role.role == Role::kPosition) best = role.column;
    for (std::size_t i = 0; !Taken(roles_, Role::kPosition) && i < head_.columns.size(); ++i)
      if (Free(i) && head_.columns[i].roughness < kSmooth && GoesToAndFro(head_.columns[i]) &&
          (!best || head_.columns[i].roughness < head_.columns[*best].roughness))
        best = i;
    if (!best) return false;
    Give(*best, Role::kPosition, "the smoothest column that goes to and fro");
    speed_ = Motion(head_.columns[*best], kLag);
    return true;
  }
  void GuessSpool() {
    if (Taken(roles_, Role::kSpool)) return;
    std::optional<std::size_t> best;
    double most = kGoesWith;
    for (std::size_t i = 0; i < head_.columns.size(); ++i) {
      const LogColumn& c = head_.columns[i];
      const bool both_signs = c.low < -0.02 * c.span() && c.high > 0.02 * c.span();
      const double with = Free(i) && both_signs ? std::abs(CorrelationOf(c.value, speed_)) : 0;
      if (with <= most) continue;
      most = with;
      best = i;
    }
    if (!best) return;
    std::size_t spool = *best;
    // Spool and command run together; the command is in volts, ten times the spool's numbers.
    for (std::size_t k = 0; k < head_.columns.size(); ++k) {
      if (k == *best || !Free(k) || std::abs(Correlation(head_.columns[*best], head_.columns[k])) < kRunsWith)
        continue;
      const bool larger = head_.columns[k].span() > head_.columns[*best].span();
      spool = larger ? *best : k;
      Give(larger ? k : *best, Role::kValveCommand, fmt::format("runs with {}", head_.columns[spool].name));
      break;
    }
    Give(spool, Role::kSpool, "both signs, goes with the speed of the position");
  }
  void GuessPressure() {
    if (Taken(roles_, Role::kPressureA)) return;
    std::optional<std::size_t> best;
    double most = kGoesWith;
    for (std::size_t i = 0; i < head_.columns.size(); ++i) {
      const LogColumn& c = head_.columns[i];
      const double with = Free(i) && c.low > -0.05 * c.high ? std::abs(CorrelationOf(c.value, speed_)) : 0;
      if (with <= most) continue;
      most = with;
      best = i;
    }
    if (best) Give(*best, Role::kPressureA, "never negative, goes with the stroke");
  }
  /// Of what is left, drifting slowly within 12 ... 95: oil temperature; the highest that stands: supply.
  void GuessRest() {
    if (!Taken(roles_, Role::kPressureA)) return;
    std::optional<std::size_t> highest, other;
    for (std::size_t i = 0; i < head_.columns.size(); ++i) {
      if (!Free(i)) continue;
      const LogColumn& c = head_.columns[i];
      if (c.roughness < 0.5 && c.low > 12 && c.high < 95 && c.span() < 25) {
        Give(i, Role::kOilTemperature, "drifts slowly within 12 ... 95");
        continue;
      }
      if (c.low <= 0) continue;
      if (!highest || c.low > head_.columns[*highest].low) {
        other = highest ? highest : other;
        highest = i;
      } else {
        other = i;
      }
    }
    const LogColumn* pressure = ColumnWith(Role::kPressureA);
    if (highest && pressure != nullptr && head_.columns[*highest].high > 0.8 * pressure->high)
      Give(*highest, Role::kSupplyPressure, "high and steady, of the size of the pressure in A");
    else
      other = highest;
    if (other && pressure != nullptr && head_.columns[*other].high < 1.5 * pressure->high)
      Give(*other, Role::kPressureB, "positive, of the size of the pressure in A");
  }
  const LogColumn* ColumnWith(Role role) const {
    for (const ColumnRole& found : roles_)
      if (found.role == role) return &head_.columns[found.column];
    return nullptr;
  }

  const LogColumns& head_;
  std::vector<ColumnRole>& roles_;
  std::vector<double> speed_;
};

}  // namespace

UnitGuess GuessUnit(Role role, const LogColumn& column, const SharedSizes& sizes) {
  const bool named = column.unit.empty() && !UnitInName(column.name).empty();
  const std::string header = named ? UnitInName(column.name) : KnownSpelling(column.unit);
  if (!header.empty() && FindUnit(header)->si == SiOf(role) && !column.date)
    return {header, 1, 0, named ? "unit in the name" : "unit in the header", true};
  const bool milliamperes = header == "mA";
  const std::string current = milliamperes ? "mA in the header or name" : Size(column);
  const bool loop = milliamperes || (header.empty() && sizes.current_loop && column.low >= kLoopLow &&
                                     column.high <= kLoopHigh);
  if (IsPressure(role) && loop) return CurrentLoop("bar", kLoopPressure, current);
  if ((role == Role::kPosition || role == Role::kPositionCommand) && loop)
    return CurrentLoop("mm", kLoopTravel, current);
  if (role == Role::kOilTemperature && loop) return CurrentLoop("degC", kLoopTemperature, current);
  if (role == Role::kSpool && loop) return SpoolBySize(column, "mA");
  if (role == Role::kValveCommand && loop) return CommandBySize(column, "mA", sizes.spool_span);
  if (IsPressure(role)) return PressureBySize(sizes.largest_pressure);
  switch (role) {
    case Role::kTime:
      return TimeBySize(column, sizes.rows_per_cycle);
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

namespace {

/// Rows from one rise through the middle of a column's range to the next, after it was low in between; 0 if
/// there are fewer than three.
double RowsPerCycle(const LogColumn& column) {
  const double low = column.low + 0.25 * column.span(), high = column.low + 0.75 * column.span();
  std::vector<double> rises;
  bool was_low = false;
  for (std::size_t i = 0; i < column.value.size(); ++i) {
    if (column.value[i] < low) was_low = true;
    if (!was_low || !(column.value[i] > high)) continue;
    rises.push_back(static_cast<double>(i));
    was_low = false;
  }
  if (rises.size() < 3) return 0;
  return (rises.back() - rises.front()) / static_cast<double>(rises.size() - 1);
}

const LogColumn* ColumnOf(const LogColumns& head, const std::vector<ColumnRole>& roles, Role role) {
  for (const ColumnRole& found : roles)
    if (found.role == role) return &head.columns[found.column];
  return nullptr;
}

}  // namespace

SharedSizes FindSharedSizes(const LogColumns& head, const std::vector<ColumnRole>& roles) {
  SharedSizes sizes;
  const LogColumn* pressure = ColumnOf(head, roles, Role::kPressureA);
  const LogColumn* position = ColumnOf(head, roles, Role::kPosition);
  if (pressure != nullptr && position != nullptr) sizes.rows_per_cycle = RowsPerCycle(*position);
  // A cushion is relieved between strokes: 4 mA and a little. Pressures in MPa fall below that.
  sizes.current_loop =
      pressure != nullptr && pressure->low >= kLoopLow && pressure->low < 8 && pressure->high > 8;
  for (const ColumnRole& found : roles)
    if (IsPressure(found.role))
      sizes.current_loop = sizes.current_loop && head.columns[found.column].low >= kLoopLow &&
                           head.columns[found.column].high <= kLoopHigh;
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
  Anonymous(head, roles).Guess();
  return roles;
}

}  // namespace hydroscope
