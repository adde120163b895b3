#include "setup/column_meaning.h"

#include <algorithm>
#include <cmath>

#include "setup/unit_guess.h"

namespace hydroscope {
namespace {

bool Taken(const std::vector<ColumnRole>& roles, Role role) {
  return std::ranges::any_of(roles, [&](const ColumnRole& r) { return r.role == role; });
}
bool Used(const std::vector<ColumnRole>& roles, std::size_t column) {
  return std::ranges::any_of(roles, [&](const ColumnRole& r) { return r.column == column; });
}

void ByName(const LogColumns& head, std::vector<ColumnRole>& roles) {
  for (std::size_t i = 0; i < head.columns.size(); ++i) {
    const LogColumn& column = head.columns[i];
    if (!column.numeric() || !head.layout.header) continue;
    const auto role = RoleByName(column.name);
    if (!role || Taken(roles, *role) || !MayBe(*role, column)) continue;
    const bool side = TellsAboveOrBelow(column.name);
    roles.push_back(
        {i, *role,
         side ? Tell("name \"{}\", with the rod above", "Name „{}“, mit der Stange oben", column.name)
              : Tell("name \"{}\"", "Name „{}“", column.name),
         !side});
  }
  // A log with one pressure only: it is the one the model needs.
  if (!Taken(roles, Role::kPressureA))
    for (ColumnRole& role : roles)
      if (role.role == Role::kPressure) {
        role.role = Role::kPressureA;
        role.sure = false;
      }
}

/// A time column without a telling name rises in every row with nearly constant steps. A counter of rows does too, in steps of
/// 1, and says nothing of the time between them.
void TimeByBehaviour(const LogColumns& head, std::vector<ColumnRole>& roles) {
  if (Taken(roles, Role::kTime)) return;
  for (std::size_t i = 0; i < head.columns.size(); ++i) {
    const LogColumn& column = head.columns[i];
    if (Used(roles, i) || !column.rising || column.step == 1) continue;
    roles.push_back({i, Role::kTime,
                     Tell("rises in every row, by {:.4g}", "steigt in jeder Zeile, um {:.4g}", column.step),
                     true});
    return;
  }
}

/// Over the rows in which both are known; `a0` and `b0`, about which they are summed, keep rounding small.
double Correlation(const std::vector<double>& a, const std::vector<double>& b, double a0 = 0, double b0 = 0) {
  double n = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const double x = a[i] - a0, y = b[i] - b0;
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    n += 1, sa += x, sb += y, saa += x * x, sbb += y * y, sab += x * y;
  }
  const double variance = (n * saa - sa * sa) * (n * sbb - sb * sb);
  return variance > 0 ? (n * sab - sa * sb) / std::sqrt(variance) : 0;
}

double Correlation(const LogColumn& a, const LogColumn& b) {
  return Correlation(a.value, b.value, a.low, b.low);
}

/// Whether `then` follows `first` by some rows rather than the other way round: a spool follows its command.
bool Leads(const LogColumn& first, const LogColumn& then) {
  constexpr std::size_t kLate = 5;  ///< rows that are tried
  const auto after = [](const LogColumn& a, const LogColumn& b, std::size_t rows) {
    if (rows >= b.value.size()) return 0.0;
    const std::vector<double> later(b.value.begin() + static_cast<std::ptrdiff_t>(rows), b.value.end());
    const std::vector<double> earlier(a.value.begin(), a.value.end() - static_cast<std::ptrdiff_t>(rows));
    return Correlation(earlier, later, a.low, b.low);
  };
  double forward = 0, back = 0;
  for (std::size_t rows = 1; rows <= kLate; ++rows) {
    forward = std::max(forward, after(first, then, rows));
    back = std::max(back, after(then, first, rows));
  }
  return forward > back;
}

/// Columns of Pa size: the steadiest and highest is the supply, the liveliest chamber A.
void PressuresByBehaviour(const LogColumns& head, std::vector<ColumnRole>& roles) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < head.columns.size(); ++i)
    if (!Used(roles, i) && head.columns[i].numeric() && head.columns[i].high > 5e5 &&
        head.columns[i].low > -2e6 && MayBe(Role::kPressure, head.columns[i]))
      found.push_back(i);
  std::ranges::sort(
      found, [&](std::size_t a, std::size_t b) { return head.columns[a].span() > head.columns[b].span(); });
  const auto give = [&](std::size_t column, Role role, const Told& why) {
    if (!Taken(roles, role)) roles.push_back({column, role, why, false});
  };
  if (!found.empty())
    give(found[0], Role::kPressureA,
         Told("the pressure that moves most", "der Druck, der sich am meisten bewegt"));
  if (found.size() == 2) give(found[1], Role::kPressureB, Told("the other pressure", "der andere Druck"));
  if (found.size() < 3) return;
  const auto highest = std::max_element(found.begin() + 1, found.end(), [&](std::size_t a, std::size_t b) {
    return head.columns[a].low < head.columns[b].low;
  });
  give(*highest, Role::kSupplyPressure, Told("a high and steady pressure", "ein hoher und stetiger Druck"));
  for (auto i = found.begin() + 1; i != found.end(); ++i)
    if (i != highest)
      give(*i, Role::kPressureB, Told("a pressure that moves little", "ein Druck, der sich wenig bewegt"));
}

/// Spool and command run together, within -1.2 ... 1.2 and within +-12; what is left and smooth is the position.
void ValveAndPositionByBehaviour(const LogColumns& head, std::vector<ColumnRole>& roles) {
  const auto free = [&](std::size_t i) {
    return !Used(roles, i) && head.columns[i].numeric() && head.columns[i].span() > 0 &&
           head.columns[i].step != 1;
  };
  for (std::size_t i = 0; i < head.columns.size() && !Taken(roles, Role::kSpool); ++i)
    for (std::size_t k = 0; k < head.columns.size(); ++k) {
      const LogColumn &spool = head.columns[i], &command = head.columns[k];
      if (i == k || !free(i) || !free(k) || Taken(roles, Role::kValveCommand) ||
          !MayBe(Role::kSpool, spool) || !MayBe(Role::kValveCommand, command))
        continue;
      const bool sizes = std::abs(spool.high) < 1.2 && std::abs(spool.low) < 1.2 &&
                         std::abs(command.high) < 12 && std::abs(command.low) < 12 &&
                         command.span() > 3 * spool.span();
      if (!sizes || Correlation(spool, command) < 0.8) continue;
      roles.push_back(
          {i, Role::kSpool,
           Tell("within -1 ... 1 and follows {}", "innerhalb -1 ... 1 und folgt {}", command.name), false});
      roles.push_back({k, Role::kValveCommand,
                       Tell("within ±12, {} follows it", "innerhalb ±12, {} folgt ihr", spool.name), false});
    }
  for (std::size_t i = 0; i < head.columns.size() && !Taken(roles, Role::kOilTemperature); ++i)
    if (free(i) && head.columns[i].low > 12 && head.columns[i].high < 95 && head.columns[i].span() < 15 &&
        Taken(roles, Role::kPressureA) && Taken(roles, Role::kSpool) &&
        MayBe(Role::kOilTemperature, head.columns[i]))
      roles.push_back({i, Role::kOilTemperature,
                       Told("hardly changes, within 12 ... 95", "ändert sich kaum, innerhalb 12 ... 95"),
                       false});
  if (Taken(roles, Role::kPosition) || !Taken(roles, Role::kPressureA)) return;
  std::optional<std::size_t> smoothest;
  for (std::size_t i = 0; i < head.columns.size(); ++i)
    if (free(i) && MayBe(Role::kPosition, head.columns[i]) &&
        (!smoothest || head.columns[i].roughness < head.columns[*smoothest].roughness))
      smoothest = i;
  if (smoothest && head.columns[*smoothest].roughness < 0.1)
    roles.push_back({*smoothest, Role::kPosition,
                     Told("the smoothest of the remaining columns", "die glatteste der übrigen Spalten"),
                     false});
}

/// A column's change over some rows, for its motion apart from noise.
std::vector<double> Motion(const LogColumn& column, std::size_t lag) {
  std::vector<double> out(column.value.size(), std::nan(""));
  for (std::size_t i = lag; i + lag < column.value.size(); ++i)
    out[i] = column.value[i + lag] - column.value[i - lag];
  return out;
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
  static constexpr double kOtherScale = 3;  ///< spans of the same numbers in different units differ by more

  bool Free(std::size_t i, Role role) const {
    const LogColumn& c = head_.columns[i];
    return !Used(roles_, i) && c.numeric() && c.span() > 0 && !c.rising && !c.date && MayBe(role, c);
  }
  void Give(std::size_t column, Role role, const Told& why) {
    if (!Taken(roles_, role))
      roles_.push_back({column, role, Tell("guessed: {}", "geraten: {}", why), false});
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
      if (Free(i, Role::kPosition) && head_.columns[i].roughness < kSmooth &&
          GoesToAndFro(head_.columns[i]) &&
          (!best || head_.columns[i].roughness < head_.columns[*best].roughness))
        best = i;
    if (!best) return false;
    Give(*best, Role::kPosition,
         Told("the smoothest column that goes to and fro", "die glatteste Spalte, die hin und her geht"));
    speed_ = Motion(head_.columns[*best], kLag);
    return true;
  }
  static bool HasBothSigns(const LogColumn& column) {
    return column.low < -0.02 * column.span() && column.high > 0.02 * column.span();
  }
  /// Larger than a share of the stroke, smaller than per cent of it.
  static bool MayBeVolts(const LogColumn& column) {
    const double most = std::max(std::abs(column.low), std::abs(column.high));
    return most > 1.2 && most < 12;
  }
  void GuessSpool() {
    if (Taken(roles_, Role::kSpool)) return;
    std::optional<std::size_t> best;
    double most = kGoesWith;
    for (std::size_t i = 0; i < head_.columns.size(); ++i) {
      const LogColumn& c = head_.columns[i];
      const double with =
          Free(i, Role::kSpool) && HasBothSigns(c) ? std::abs(Correlation(c.value, speed_)) : 0;
      if (with <= most) continue;
      most = with;
      best = i;
    }
    if (!best) return;
    std::size_t spool = *best;
    // Spool and command run together; the command is the one that may be in volts, else ten times the spool's numbers, else the
    // one that the other follows.
    for (std::size_t k = 0; k < head_.columns.size(); ++k) {
      if (k == *best || !Free(k, Role::kValveCommand) || !HasBothSigns(head_.columns[k]) ||
          std::abs(Correlation(head_.columns[*best], head_.columns[k])) < kRunsWith)
        continue;
      const bool volts = MayBeVolts(head_.columns[k]), others_volts = MayBeVolts(head_.columns[*best]);
      const double spans = head_.columns[k].span() / head_.columns[*best].span();
      const bool alike = volts == others_volts && spans > 1 / kOtherScale && spans < kOtherScale;
      const bool commands = alike                   ? Leads(head_.columns[k], head_.columns[*best])
                            : volts != others_volts ? volts
                                                    : spans > 1;
      spool = commands ? *best : k;
      Give(commands ? k : *best, Role::kValveCommand,
           Tell("runs with {}", "läuft mit {}", head_.columns[spool].name));
      break;
    }
    Give(spool, Role::kSpool,
         Told("both signs, goes with the speed of the position",
              "beide Vorzeichen, geht mit der Geschwindigkeit der Position"));
  }
  void GuessPressure() {
    if (Taken(roles_, Role::kPressureA)) return;
    std::optional<std::size_t> best;
    double most = kGoesWith;
    for (std::size_t i = 0; i < head_.columns.size(); ++i) {
      const LogColumn& c = head_.columns[i];
      const double with =
          Free(i, Role::kPressureA) && c.low > -0.05 * c.high ? std::abs(Correlation(c.value, speed_)) : 0;
      if (with <= most) continue;
      most = with;
      best = i;
    }
    if (best)
      Give(*best, Role::kPressureA,
           Told("never negative, goes with the stroke", "nie negativ, geht mit dem Hub"));
  }
  /// Of what is left, drifting slowly or called after the oil, within 12 ... 95: oil temperature; the highest that stands: supply.
  void GuessRest() {
    if (!Taken(roles_, Role::kPressureA)) return;
    std::optional<std::size_t> highest, other;
    for (std::size_t i = 0; i < head_.columns.size(); ++i) {
      const LogColumn& c = head_.columns[i];
      const std::string name = BareName(c.name);
      const bool of_oil = name.starts_with("oel") || name.starts_with("oil");
      if (Free(i, Role::kOilTemperature) && (of_oil || c.roughness < 0.5) && c.low > 12 && c.high < 95 &&
          c.span() < 25) {
        Give(i, Role::kOilTemperature,
             of_oil
                 ? Told("called after the oil, within 12 ... 95", "nach dem Öl benannt, innerhalb 12 ... 95")
                 : Told("drifts slowly within 12 ... 95", "wandert langsam innerhalb 12 ... 95"));
        continue;
      }
      if (!Free(i, Role::kPressure) || c.low <= 0) continue;
      if (!highest || c.low > head_.columns[*highest].low) {
        other = highest ? highest : other;
        highest = i;
      } else {
        other = i;
      }
    }
    const LogColumn* pressure = ColumnWith(Role::kPressureA);
    if (highest && pressure != nullptr && head_.columns[*highest].high > 0.8 * pressure->high)
      Give(*highest, Role::kSupplyPressure,
           Told("high and steady, of the size of the pressure in A",
                "hoch und stetig, von der Größe des Drucks in A"));
    else
      other = highest;
    if (other && pressure != nullptr && head_.columns[*other].high < 1.5 * pressure->high)
      Give(*other, Role::kPressureB,
           Told("positive, of the size of the pressure in A", "positiv, von der Größe des Drucks in A"));
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
