#include <array>
#include <initializer_list>
#include <string_view>

#include "core/contains.h"
#include "core/units.h"
#include "replay/log_layout.h"
#include "setup/column_meaning.h"

namespace hydroscope {
namespace {

/// Lower case, umlauts written out, what stands in brackets left out.
std::string Plain(const std::string& name) {
  std::string text(SplitHeader(name).name);
  if (const auto bracket = text.find_last_of("[("); bracket != 0 && bracket != std::string::npos)
    text.resize(bracket);
  text = WithoutUmlauts(std::move(text));
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

/// Only letters and digits: "p_A" and "p A" are the same name.
std::string Squeezed(const std::string& text) {
  std::string squeezed;
  for (const char c : text)
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) squeezed += c;
  return squeezed;
}

/// The last word: "a" of "druck a", "" if the text is one word.
std::string LastWord(const std::string& text) {
  const std::size_t end = text.find_last_not_of(" _-.");
  if (end == std::string::npos) return "";
  const std::size_t begin = text.find_last_of(" _-.", end);
  return begin == std::string::npos ? "" : text.substr(begin + 1, end - begin);
}

struct ExactName {
  std::string_view name;
  Role role;
};
/// Short names, without separators.
constexpr ExactName kExactNames[] = {{"t", Role::kTime},
                                     {"sec", Role::kTime},
                                     {"seconds", Role::kTime},
                                     {"sekunden", Role::kTime},
                                     {"ts", Role::kTime},
                                     {"tms", Role::kTime},
                                     {"pa", Role::kPressureA},
                                     {"p1", Role::kPressureA},
                                     {"pza", Role::kPressureA},
                                     {"punten", Role::kPressureA},
                                     {"pdca", Role::kPressureA},
                                     {"pb", Role::kPressureB},
                                     {"p2", Role::kPressureB},
                                     {"pzb", Role::kPressureB},
                                     {"poben", Role::kPressureB},
                                     {"pdcb", Role::kPressureB},
                                     {"p0", Role::kSupplyPressure},
                                     {"pp", Role::kSupplyPressure},
                                     {"ps", Role::kSupplyPressure},
                                     {"supply", Role::kSupplyPressure},
                                     {"psupply", Role::kSupplyPressure},
                                     {"psys", Role::kSupplyPressure},
                                     {"pt", Role::kTankPressure},
                                     {"tank", Role::kTankPressure},
                                     {"ptank", Role::kTankPressure},
                                     {"p", Role::kPressure},
                                     {"z", Role::kPosition},
                                     {"zdc", Role::kPosition},
                                     {"x", Role::kPosition},
                                     {"s", Role::kPosition},
                                     {"xk", Role::kPosition},
                                     {"zist", Role::kPosition},
                                     {"xist", Role::kPosition},
                                     {"lage", Role::kPosition},
                                     {"zsoll", Role::kPositionCommand},
                                     {"xsoll", Role::kPositionCommand},
                                     {"xcmd", Role::kPositionCommand},
                                     {"xref", Role::kPositionCommand},
                                     {"yv", Role::kSpool},
                                     {"y", Role::kSpool},
                                     {"xv", Role::kSpool},
                                     {"yvist", Role::kSpool},
                                     {"yist", Role::kSpool},
                                     {"uv", Role::kValveCommand},
                                     {"u", Role::kValveCommand},
                                     {"usoll", Role::kValveCommand},
                                     {"ysoll", Role::kValveCommand},
                                     {"yvsoll", Role::kValveCommand},
                                     {"ucmd", Role::kValveCommand},
                                     {"toil", Role::kOilTemperature},
                                     {"toel", Role::kOilTemperature},
                                     {"theta", Role::kOilTemperature},
                                     {"f", Role::kForce},
                                     {"fz", Role::kForce}};

bool Has(const std::string& text, std::initializer_list<std::string_view> parts) {
  for (const std::string_view part : parts)
    if (text.find(part) != std::string::npos) return true;
  return false;
}

/// "Druck oben", "pressure, upper chamber".
bool TellsAbove(const std::string& squeezed) { return Has(squeezed, {"oben", "obere", "upper", "top"}); }
bool TellsBelow(const std::string& squeezed) { return Has(squeezed, {"unten", "untere", "lower", "bottom"}); }

/// The chamber by its letter or by the piston's face; nullopt where the name has neither.
std::optional<Role> ChamberRole(const std::string& text, const std::string& squeezed) {
  const std::string last = LastWord(text);
  if (last == "a" || last == "1" ||
      Has(squeezed,
          {"drucka", "pressurea", "aseite", "sidea", "chambera", "kammera", "kolbenseit", "boden", "piston"}))
    return Role::kPressureA;
  if (last == "b" || last == "2" ||
      Has(squeezed, {"druckb", "pressureb", "bseite", "sideb", "chamberb", "kammerb", "stangenseit",
                     "ringseit", "rod"}))
    return Role::kPressureB;
  return std::nullopt;
}

std::optional<Role> PressureRole(const std::string& text, const std::string& squeezed) {
  if (Has(squeezed, {"tank", "return", "ruecklauf"})) return Role::kTankPressure;
  if (Has(squeezed, {"supply", "pump", "system", "versorg", "netz", "speicher", "accu"}))
    return Role::kSupplyPressure;
  if (const auto chamber = ChamberRole(text, squeezed)) return chamber;
  const std::string port = LastWord(text);  // of a valve, as its body has them cast
  if (port == "p") return Role::kSupplyPressure;
  if (port == "t") return Role::kTankPressure;
  if (TellsAbove(squeezed)) return Role::kPressureB;
  if (TellsBelow(squeezed)) return Role::kPressureA;
  return Role::kPressure;
}

/// "mm" for "mm", "Bar" for "bar", "degC" for "C"; "" for what is no unit at the end of a name.
std::string UnitWord(const std::string& word) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 30> kWords = {
      {{"bar", "bar"},   {"mbar", "mbar"}, {"pa", "Pa"},           {"kpa", "kPa"}, {"mpa", "MPa"},
       {"psi", "psi"},   {"hpa", "mbar"},  {"mm", "mm"},           {"cm", "cm"},   {"um", "um"},
       {"ms", "ms"},     {"us", "us"},     {"ns", "ns"},           {"sec", "s"},   {"sek", "s"},
       {"ma", "mA"},     {"mv", "mV"},     {"volt", "V"},          {"pct", "%"},   {"percent", "%"},
       {"degc", "degC"}, {"kn", "kN"},     {"celsius", "degC"},    {"proz", "%"},  {"inch", "in"},
       {"inches", "in"}, {"degf", "degF"}, {"fahrenheit", "degF"}, {"gpm", "gpm"}, {"lbf", "lbf"}}};
  for (const auto& [spelling, unit] : kWords)
    if (word == spelling) return std::string(unit);
  return "";
}

/// What can be nothing but a unit at the end of a name, as it is spelt: "Nm", "1/min", "°C"; not "min", "in", "A".
std::string WholeUnit(const std::string& word) {
  static constexpr std::string_view kClear[] = {"Nm", "kNm", "kW", "Hz", "MN", "rad", "rpm", "kg", "kJ"};
  const bool clear = Contains(kClear, word) || word.find('/') != std::string::npos || word.starts_with("°");
  return clear && FindUnit(word) ? word : "";
}

/// The name without its last word.
std::string Stem(const std::string& text) {
  const std::string last = LastWord(text);
  if (last.empty()) return text;
  return text.substr(0, text.rfind(last));
}

}  // namespace

std::string WithoutUmlauts(std::string text) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kUmlauts = {{{"ä", "ae"},
                                                                                             {"ö", "oe"},
                                                                                             {"ü", "ue"},
                                                                                             {"Ä", "Ae"},
                                                                                             {"Ö", "Oe"},
                                                                                             {"Ü", "Ue"},
                                                                                             {"ß", "ss"},
                                                                                             {"Δ", "d"}}};
  for (const auto& [umlaut, letters] : kUmlauts)
    for (std::size_t at = text.find(umlaut); at != std::string::npos; at = text.find(umlaut))
      text.replace(at, 2, letters);
  return text;
}

std::string UnitInName(const std::string& name) {
  const std::string text = Plain(name), last = LastWord(text);
  if (last.empty()) return name.size() > 1 && name.back() == '%' ? "%" : "";
  if (const std::string unit = UnitWord(last); !unit.empty()) {
    // "p_pa" is the pressure of a chamber as often as a pressure in Pa: only after a name of its own.
    const std::string stem = Squeezed(Stem(text));
    return unit == "Pa" && stem.size() < 2 ? "" : unit;
  }
  const std::string stem = Squeezed(Stem(text));
  const bool time = stem == "t" || Has(stem, {"zeit", "time"});
  if (last == "s" && time) return "s";
  if (last == "d" && time) return "d";
  if (last == "c" && Has(stem, {"temp", "oil", "oel"})) return "degC";
  if (last == "k" && Has(stem, {"temp", "oil", "oel"})) return "K";
  const bool temperature = stem == "t" || Has(stem, {"temp", "oil"});
  if (last == "f" && temperature) return "degF";
  if (last == "in" && (stem == "z" || stem == "x" || Has(stem, {"pos", "stroke", "displ"}))) return "in";
  if (last == "n" && (stem == "f" || Has(stem, {"kraft", "force"}))) return "N";
  if (last == "m" && (stem == "z" || stem == "x" || Has(stem, {"pos", "weg", "hub"}))) return "m";
  return WholeUnit(name.substr(name.find_last_of(" _") + 1));
}

std::string NameWithoutUnit(const std::string& name) {
  const std::size_t bracket = name.find_last_of("[(");
  std::string bare = bracket == 0 ? name : name.substr(0, bracket);
  if (!UnitInName(bare).empty() && bare.back() != '%') bare.resize(bare.find_last_of(" _-."));
  while (!bare.empty() && (bare.back() == ' ' || bare.back() == '_')) bare.pop_back();
  return bare;
}

std::string BareName(const std::string& name) {
  const std::string text = Plain(name);
  return Squeezed(UnitInName(name).empty() || name.back() == '%' ? text : Stem(text));
}

std::optional<Role> RoleByName(const std::string& name) {
  if (!UnitInName(name).empty() && name.back() != '%')
    if (const auto role = RoleByName(name.substr(0, name.find_last_of(" _-.")))) return role;
  const std::string text = Plain(name);
  const std::string squeezed = Squeezed(text);
  for (const ExactName& exact : kExactNames)
    if (squeezed == exact.name) return exact.role;
  if (Has(squeezed, {"zeit", "time", "datum", "date"})) return Role::kTime;
  const bool standing = Has(squeezed, {"stellung"});
  const bool command =
      Has(squeezed, {"command", "cmd", "soll", "setpoint", "ansteuer", "reference", "demand"}) ||
      (Has(squeezed, {"stell"}) && !standing);
  const bool position = standing || Has(squeezed, {"pos", "weg", "hub", "displ", "stroke"});
  const bool force = Has(squeezed, {"kraft", "force"});
  if (Has(squeezed, {"valve", "ventil", "spool", "schieber"})) {
    const bool electric = Has(squeezed, {"spannung", "volt", "current", "strom", "signal"});
    return command || (electric && !position) ? Role::kValveCommand : Role::kSpool;
  }
  if (position) return command ? Role::kPositionCommand : Role::kPosition;
  const bool temperature = Has(squeezed, {"temp"});
  const bool pressure = Has(squeezed, {"druck", "press"});
  if (command) return temperature || pressure || force ? std::nullopt : std::optional(Role::kValveCommand);
  if (temperature) return Role::kOilTemperature;
  if (force) return Role::kForce;
  if (pressure) return PressureRole(text, squeezed);
  return std::nullopt;
}

bool TellsAboveOrBelow(const std::string& name) {
  const auto role = RoleByName(name);
  if (role != Role::kPressureA && role != Role::kPressureB) return false;
  const std::string text = Plain(name), squeezed = Squeezed(text);
  return !ChamberRole(text, squeezed) && (TellsAbove(squeezed) || TellsBelow(squeezed));
}

const char* SignalNameOf(Role role) {
  switch (role) {
    case Role::kTime:
      return "t";
    case Role::kPressureA:
      return "p_A";
    case Role::kPressureB:
      return "p_B";
    case Role::kSupplyPressure:
      return "p_0";
    case Role::kTankPressure:
      return "p_t";
    case Role::kPressure:
      return "p";
    case Role::kPosition:
      return "z";
    case Role::kPositionCommand:
      return "z_command";
    case Role::kSpool:
      return "y_v";
    case Role::kValveCommand:
      return "U_v";
    case Role::kOilTemperature:
      return "T_oil";
    case Role::kForce:
      return "F";
  }
  return "";
}

}  // namespace hydroscope
