#include "setup/unit_guess.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

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
  std::string lower = unit;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  static constexpr std::pair<std::string_view, std::string_view> kSpellings[] = {{"c", "degC"},
                                                                                 {"deg c", "degC"},
                                                                                 {"grad c", "degC"},
                                                                                 {"celsius", "degC"},
                                                                                 {"f", "degF"},
                                                                                 {"deg f", "degF"},
                                                                                 {"fahrenheit", "degF"},
                                                                                 {"inch", "in"},
                                                                                 {"\"", "in"},
                                                                                 {"gal/min", "gpm"},
                                                                                 {"usgpm", "gpm"},
                                                                                 {"lbs", "lbf"},
                                                                                 {"psig", "psi"},
                                                                                 {"psia", "psi"},
                                                                                 {"barg", "bar"},
                                                                                 {"bara", "bar"},
                                                                                 {"sec", "s"},
                                                                                 {"sek", "s"},
                                                                                 {"-", "1"},
                                                                                 {"pu", "1"},
                                                                                 {"rev/min", "rpm"},
                                                                                 {"min-1", "1/min"},
                                                                                 {"min^-1", "1/min"},
                                                                                 {"n m", "Nm"},
                                                                                 {"n*m", "Nm"},
                                                                                 {"n·m", "Nm"},
                                                                                 {"m/s^2", "m/s2"},
                                                                                 {"cm³", "cm3"},
                                                                                 {"cm²", "cm2"},
                                                                                 {"mm²", "mm2"},
                                                                                 {"µm", "um"},
                                                                                 {"μm", "um"},
                                                                                 {"°", "deg"},
                                                                                 {"grad", "deg"},
                                                                                 {"lpm", "l/min"}};
  for (const auto& [spelling, name] : kSpellings)
    if (lower == spelling) return std::string(name);
  if (FindUnit(unit)) return unit;
  for (const std::string& name : UnitNames()) {
    std::string candidate = name;
    for (char& c : candidate) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (candidate == lower) return name;
  }
  return "";
}

Told Size(const LogColumn& column) {
  return Tell("values {:.4g} ... {:.4g}", "Werte {:.4g} ... {:.4g}", column.low, column.high);
}

UnitGuess PressureBySize(double largest) {
  const Told seen = Tell("pressures reach {:.4g}", "Drücke bis {:.4g}", largest);
  if (largest > 2e5) return {"Pa", 1, 0, Tell("{}, which can only be Pa", "{}, das kann nur Pa sein", seen)};
  if (largest > 2e3) return {"kPa", 1, 0, Tell("{}, which fits kPa", "{}, das passt zu kPa", seen), false};
  if (largest > 45) return {"bar", 1, 0, Tell("{}, which fits bar", "{}, das passt zu bar", seen)};
  if (largest > 12)
    return {"MPa", 1, 0,
            Tell("{}, which fits MPa; if it is bar, write bar",
                 "{}, das passt zu MPa; ist es bar, bar wählen", seen),
            false};
  return {"bar", 1, 0,
          Tell("{}; taken as bar, it may be MPa or volts",
               "{}; als bar genommen, es können MPa oder Volt sein", seen),
          false};
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
  for (const char* name : {"s", "ms", "us", "ns"}) {
    const double cycle = rows_per_cycle * column.step * FindUnit(name)->scale;
    if (cycle < kShortest || cycle > kLongest) continue;
    const double away = std::abs(std::log(cycle / kUsual));
    if (best && away >= least) continue;
    least = away;
    best = UnitGuess{name, 1, 0,
                     Tell("steps of {:.4g}; as {} a movement and back takes {:.3g} s",
                          "Schritte von {:.4g}; als {} dauert eine Bewegung hin und zurück {:.3g} s",
                          column.step, std::string(name), cycle),
                     true};
  }
  return best;
}

UnitGuess TimeBySize(const LogColumn& column, double rows_per_cycle) {
  const Told seen = Tell("steps of {:.4g}", "Schritte von {:.4g}", column.step);
  if (column.date) return {"s", 1, 0, Told("date or time of day", "Datum oder Uhrzeit")};
  if (IsDayNumber(column))
    return {"d", 1, 0,
            Tell("numbers near {:.0f} with steps of {:.3g}: days of a spreadsheet",
                 "Zahlen um {:.0f} mit Schritten von {:.3g}: Tage einer Tabellenkalkulation", column.low,
                 column.step)};
  if (const auto guess = TimeByCycles(column, rows_per_cycle)) return *guess;
  if (column.step >= 200) return {"us", 1, 0, Tell("{}, which fits us", "{}, das passt zu us", seen), false};
  if (column.step >= 0.2)
    return {"ms", 1, 0, Tell("{}, which fits ms", "{}, das passt zu ms", seen), column.step < 100};
  return {"s", 1, 0, Tell("{}, which fits s", "{}, das passt zu s", seen)};
}

constexpr double kWidestSpool = 1.5;  ///< 1 = fully open; sensors read somewhat beyond

UnitGuess SpoolBySize(const LogColumn& column, const std::string& header) {
  const double largest = std::max(std::abs(column.low), std::abs(column.high));
  if (header == "V")
    return {"1", 0.1, 0,
            Told("volts in the header, 10 V taken as fully open",
                 "Volt in der Kopfzeile, 10 V als ganz offen genommen"),
            false};
  if (header == "mA")
    return {"1", 0.125, -1.5,
            Told("mA in the header, 4 ... 20 mA taken as -1 ... 1",
                 "mA in der Kopfzeile, 4 ... 20 mA als -1 ... 1 genommen"),
            false};
  if (largest <= kWidestSpool)
    return {"1", 1, 0, Tell("{} fit -1 ... 1", "{} passen zu -1 ... 1", Size(column))};
  if (largest <= 12)
    return {"1", 0.1, 0,
            Tell("{} taken as volts, 10 V fully open; if it is %, write unit % and no scale",
                 "{} als Volt genommen, 10 V ganz offen; ist es %, die Einheit % wählen", Size(column)),
            false};
  return {"%", 1, 0, Tell("{} fit %", "{} passen zu %", Size(column)), largest <= 130};
}

/// The spool tells volts from per cent and from -1 ... 1: full command opens it fully.
UnitGuess CommandBySize(const LogColumn& column, const std::string& header, double spool_span) {
  const double largest = std::max(std::abs(column.low), std::abs(column.high));
  const double ratio = spool_span > 0 ? column.span() / spool_span : 0;
  if (header == "mA")
    return {"V", 0.625, -7.5,
            Told("mA in the header, 4 ... 20 mA taken as -10 ... 10 V",
                 "mA in der Kopfzeile, 4 ... 20 mA als -10 ... 10 V genommen"),
            false};
  if (header == "%")
    return {"V", 0.1, 0, Told("% in the header, 100 % = 10 V", "% in der Kopfzeile, 100 % = 10 V")};
  const Told seen =
      Tell("{}, {:.3g} times the spool's, ", "{}, {:.3g}-mal die des Schiebers, ", Size(column), ratio);
  if (ratio > 40)
    return {"V", 0.1, 0, Tell("{}taken as %, 100 % = 10 V", "{}als % genommen, 100 % = 10 V", seen), false};
  if (ratio > 4) return {"V", 1, 0, Tell("{}fit V", "{}passt zu V", seen), largest <= 15};
  if (ratio > 0)
    return {"V", 10, 0, Tell("{}taken as -1 ... 1 of 10 V", "{}als -1 ... 1 von 10 V genommen", seen), false};
  if (largest > 15)
    return {"V", 0.1, 0, Tell("{} taken as %, 100 % = 10 V", "{} als % genommen, 100 % = 10 V", Size(column)),
            false};
  return {"V", 1, 0, Tell("{} taken as V", "{} als V genommen", Size(column)), largest > 1.05};
}

constexpr double kLoopLow = 3.6, kLoopHigh = 20.8;  ///< mA, NAMUR NE 43: a live 4 ... 20 mA signal
/// Ranges that such transmitters usually have; the plate on the sensor knows.
constexpr double kLoopPressure = 400, kLoopTravel = 500, kLoopTemperature = 100;  ///< bar, mm, K

/// 4 ... 20 mA as 0 ... `range` of `unit`.
UnitGuess CurrentLoop(const char* unit, double range, const Told& seen) {
  const double scale = range / 16;
  return {unit, scale, -4 * scale,
          Tell("{}: 4 ... 20 mA, taken as 0 ... {:g} {}, a guess: write the range of the sensor",
               "{}: 4 ... 20 mA, als 0 ... {:g} {} genommen, geraten: den Messbereich des Sensors eintragen",
               seen, range, std::string(unit)),
          false};
}

}  // namespace

bool AreCurrentLoops(const LogColumns& head, const std::vector<std::size_t>& columns) {
  constexpr double kMovesBy = 2;  ///< mA, at least one of them
  int loops = 0;
  bool moves = false;
  for (const std::size_t at : columns) {
    const LogColumn& column = head.columns[at];
    const std::string written = WrittenUnit(column);
    if (!written.empty() && written != "mA") continue;
    if (column.low < kLoopLow || column.high > kLoopHigh) return false;
    ++loops;
    moves = moves || column.span() > kMovesBy;
  }
  return loops > 1 && moves;
}

UnitGuess UnknownCurrentLoop(const LogColumn& column) {
  UnitGuess guess{
      "1", 1.0 / 16, -0.25,
      Tell("{}: 4 ... 20 mA of a sensor of unknown range, taken as 0 ... 1 of it",
           "{}: 4 ... 20 mA eines Sensors mit unbekanntem Messbereich, als 0 ... 1 davon genommen",
           Size(column)),
      false};
  guess.to_fill_in = Tell(
      "[signals], lines marked FILL IN: the columns look like 4 ... 20 mA; write for each the range on its sensor's plate, from LOW at "
      "4 mA to HIGH at 20 mA: its unit, scale = (HIGH - LOW)/16 and offset = LOW - 4*scale (0 ... 400 bar: unit = \"bar\", scale = "
      "25, offset = -100)",
      "[signals], Zeilen mit FILL IN: die Spalten sehen nach 4 ... 20 mA aus; für jede den Messbereich vom Typenschild des Sensors "
      "eintragen, von UNTEN bei 4 mA bis OBEN bei 20 mA: Einheit, scale = (OBEN - UNTEN)/16 und offset = UNTEN - 4*scale (0 ... 400 "
      "bar: unit = \"bar\", scale = 25, offset = -100)");
  return guess;
}

namespace {

/// Units that logs are written in, and how large the signals of machines are at most and at least, SI.
struct UsualUnits {
  std::string_view si;
  std::array<std::string_view, 3> units;  ///< "" = no more
  PlausibleSize size;
};
constexpr UsualUnits kUsualUnits[] = {{"Pa", {"Pa", "bar", "MPa"}, {3e5, 1e8}},
                                      {"m", {"m", "mm", ""}, {1e-3, 3, PlausibleSize::kTravel}},
                                      {"m3/s", {"m3/s", "l/min", ""}, {1e-6, 0.05}},
                                      {"rad/s", {"rad/s", "rpm", ""}, {1, 500}},
                                      {"rad", {"rad", "deg", ""}, {1e-3, 6.3}},
                                      {"m/s2", {"m/s2", "mm/s2", ""}, {1e-2, 1e3}},
                                      {"A", {"A", "mA", ""}, {1e-4, 0.5}},
                                      {"1", {"1", "%", ""}, {0, 1.5}},
                                      {"V", {"V", "mV", ""}, {0, 12}},
                                      {"N", {"N", "kN", ""}, {10, 1e7}}};

/// Of the readings, in the numbers of the log.
double SizeOf(const LogColumn& column, PlausibleSize::Of of) {
  if (of == PlausibleSize::kTravel) return column.span();
  if (of == PlausibleSize::kMean) return 0.5 * std::abs(column.low + column.high);
  return std::max(std::abs(column.low), std::abs(column.high));
}

UnitGuess PositionBySize(const LogColumn& column) {
  const double largest = std::max(std::abs(column.low), std::abs(column.high));
  if (largest > 6) return {"mm", 1, 0, Tell("{} fit mm", "{} passen zu mm", Size(column))};
  return {"m", 1, 0, Tell("{} fit m", "{} passen zu m", Size(column)), largest <= 2.5 && column.span() < 2.5};
}

}  // namespace

std::string WrittenUnit(const LogColumn& column) {
  const std::string in_name = UnitInName(column.name);
  return column.unit.empty() && !in_name.empty() ? in_name : KnownSpelling(column.unit);
}

UnitGuess AsWritten(const std::string& unit, const LogColumn& column) {
  return {unit, 1, 0,
          column.unit_chosen    ? Told("unit chosen by hand", "Einheit von Hand gewählt")
          : column.unit.empty() ? Told("unit in the name", "Einheit im Namen")
                                : Told("unit in the header", "Einheit in der Kopfzeile")};
}

namespace {

/// Of a sensor that is not scaled yet.
bool IsRaw(std::string_view si) { return si == "1" || si == "V" || si == "A"; }

/// The header's unit as a signal in `si` has it: a speed of rotation in 1/min counts revolutions.
std::string WrittenUnitOf(const LogColumn& column, std::string_view si) {
  const std::string written = WrittenUnit(column);
  return si == "rad/s" && written == "1/min" ? "rpm" : written;
}

}  // namespace

bool MayBe(Role role, const LogColumn& column) {
  const auto unit = FindUnit(WrittenUnit(column));
  if (!unit || unit->si == SiOf(role)) return true;
  const bool travels = role == Role::kSpool;  // of a valve, in mm as well
  return IsRaw(unit->si) || (travels && unit->si == "m");
}

bool MayBe(const MachineInput& signal, const LogColumn& column) {
  const auto unit = FindUnit(WrittenUnitOf(column, signal.si));
  return !unit || unit->si == signal.si || IsRaw(unit->si);
}

namespace {

UnitGuess ByHeaderOrSize(Role role, const LogColumn& column, const SharedSizes& sizes) {
  const std::string header = WrittenUnit(column);
  if (!header.empty() && FindUnit(header)->si == SiOf(role) && !column.date) {
    UnitGuess written = AsWritten(header, column);
    const double opening = std::max(std::abs(column.low), std::abs(column.high)) * FindUnit(header)->scale;
    if (role != Role::kSpool || opening <= kWidestSpool) return written;
    written.why = Tell("{}, but {} in {} are no opening of a spool, which is -1 ... 1",
                       "{}, aber {} in {} sind keine Öffnung eines Schiebers, die -1 ... 1 ist", written.why,
                       Size(column), header);
    written.sure = false;
    return written;
  }
  const bool milliamperes = header == "mA";
  const Told current =
      milliamperes ? Told("mA in the header or name", "mA in Kopfzeile oder Name") : Size(column);
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
      if (column.low > 220) return {"K", 1, 0, Tell("{} fit K", "{} passen zu K", Size(column))};
      return {"degC", 1, 0, Tell("{} fit °C", "{} passen zu °C", Size(column)),
              column.low > -40 && column.high < 150};
    default:
      return {"N", 1, 0, Tell("{} taken as N", "{} als N genommen", Size(column)), false};
  }
}

UnitGuess ByHeaderOrSize(const MachineInput& signal, const LogColumn& column) {
  const std::string written = WrittenUnitOf(column, signal.si);
  if (const auto unit = FindUnit(written); unit && (unit->si == signal.si || unit->si != "1")) {
    if (unit->si == signal.si) return AsWritten(written, column);
    return {std::string(signal.si), 1, 0,
            Tell("{} in the header: write scale and unit of the sensor",
                 "{} in der Kopfzeile: Skalierung und Einheit des Sensors eintragen", written),
            false};
  }
  const auto usual = std::find_if(std::begin(kUsualUnits), std::end(kUsualUnits),
                                  [&](const UsualUnits& known) { return known.si == signal.si; });
  const Told seen = Size(column);
  if (usual == std::end(kUsualUnits))
    return {std::string(signal.si), 1, 0, Tell("{}, unit unknown", "{}, Einheit unbekannt", seen), false};
  const PlausibleSize plausible = signal.size.value_or(usual->size);
  std::vector<std::string> fitting;
  for (const std::string_view unit : usual->units) {
    if (unit.empty()) continue;
    const double size = SizeOf(column, plausible.of) * FindUnit(unit)->scale;
    if (size >= plausible.low && size <= plausible.high) fitting.emplace_back(unit);
  }
  if (fitting.empty())
    return {std::string(usual->units.front()), 1, 0,
            Tell("{} fit no usual unit", "{} passen zu keiner üblichen Einheit", seen), false};
  return {fitting.front(), 1, 0, Tell("{} fit {}", "{} passen zu {}", seen, fitting.front()),
          fitting.size() == 1};
}

/// What stands in the header's brackets may be a unit that is not known here: then the size alone says nothing for sure.
UnitGuess WithUnknownUnit(UnitGuess guess, const LogColumn& column) {
  constexpr std::size_t kLongest = 8;  // characters of a unit; longer words are remarks
  const bool unknown =
      !column.unit.empty() && column.unit.size() <= kLongest && KnownSpelling(column.unit).empty();
  if (!unknown || column.unit_chosen) return guess;
  guess.sure = false;
  guess.why = Tell(
      "{}; if \"{}\" in the header is a unit, it is none that is known here: write scale and unit",
      "{}; falls „{}“ in der Kopfzeile eine Einheit ist, ist sie hier nicht bekannt: Skalierung und Einheit eintragen",
      guess.why, column.unit);
  return guess;
}

}  // namespace

UnitGuess GuessUnit(Role role, const LogColumn& column, const SharedSizes& sizes) {
  return WithUnknownUnit(ByHeaderOrSize(role, column, sizes), column);
}

UnitGuess GuessUnitOf(const MachineInput& signal, const LogColumn& column) {
  return WithUnknownUnit(ByHeaderOrSize(signal, column), column);
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

}  // namespace hydroscope
