#include "replay/column_plan.h"

#include <bit>
#include <utility>

#include "core/contains.h"
#include "core/told_error.h"
#include "core/units.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMostFindings = 100;
constexpr std::size_t kMostNamesListed = 60;

std::string ListNames(const std::vector<std::string>& names) {
  std::string list;
  for (std::size_t i = 0; i < names.size() && i < kMostNamesListed; ++i)
    list += fmt::format("{}'{}'", i > 0 ? ", " : "", names[i]);
  if (names.size() > kMostNamesListed) list += fmt::format(" and {} more", names.size() - kMostNamesListed);
  return list;
}

tl::unexpected<Error> MissingColumn(const LogLayout& layout, const std::string& column, const Told& purpose,
                                    const std::string& origin, const Told& advice) {
  const std::string nearest = Nearest(column, layout.names);
  const Told question =
      nearest.empty() ? Told(".") : Tell("; did you mean '{}'?", "; ist '{}' gemeint?", nearest);
  const Told kind = layout.header ? Told()
                                  : Told(" (the log has no header, so columns are named by number)",
                                         " (das Log hat keine Kopfzeile, also heißen sie nach ihrer Nummer)");
  return BadInput(Tell("log '{}': no column '{}' for {}{} Columns found{}: {}{}",
                       "Log '{}': keine Spalte '{}' für {}{} Gefundene Spalten{}: {}{}", origin, column,
                       purpose, question, kind, ListNames(layout.names), advice));
}

/// The unit a log states must mean the same as the machine file's; a unit the project does not know says nothing.
Status CheckUnit(const LogLayout& layout, int column, const std::string& unit, const std::string& key,
                 const std::string& origin) {
  const auto index = static_cast<std::size_t>(column);
  if (index >= layout.units.size() || layout.units[index].empty()) return {};
  const auto stated = FindUnit(layout.units[index]);
  const auto expected = FindUnit(unit);
  if (!stated || !expected) return {};
  if (stated->scale == expected->scale && stated->offset == expected->offset && stated->si == expected->si)
    return {};
  if (layout.units[index] == "1/min" && unit == "rpm") return {};  // of a shaft
  return BadInput(Tell(
      "log '{}', column '{}': the log states the unit '{}', the machine file has {} = \"{}\"; write \"{}\" "
      "there, or correct the log",
      "Log '{}', Spalte '{}': das Log nennt die Einheit '{}', die Maschinendatei {} = \"{}\"; dort \"{}\" schreiben, "
      "oder das Log berichtigen",
      origin, layout.names[index], layout.units[index], key, unit, layout.units[index]));
}

Status PlanSignal(const LogLayout& layout, const SignalSpec& spec, const std::string& origin,
                  ColumnPlan& plan, LogCounters& counters) {
  const auto unit = FindUnit(spec.unit);
  if (!unit)
    return BadInput(Tell("signal '{}': unknown unit '{}'; known units: {}",
                         "Signal '{}': unbekannte Einheit '{}'; bekannt sind: {}", spec.name, spec.unit,
                         ListNames(UnitNames())));
  plan.to_si.push_back({spec.scale * unit->scale, spec.offset * unit->scale + unit->offset});
  const auto column = layout.Find(spec.column);
  plan.column.push_back(column ? static_cast<int>(*column) : ColumnPlan::kAbsent);
  if (!column) {
    if (spec.required)
      return MissingColumn(layout, spec.column, Tell("signal '{}'", "Signal '{}'", spec.name), origin, {});
    AddFinding(counters, {0, spec.column, "no such column",
                          fmt::format("a column for the optional signal '{}'", spec.name)});
    return {};
  }
  if (spec.scale != 1.0 || spec.offset != 0.0) return {};  // the log states the unit before scaling
  return CheckUnit(layout, plan.column.back(), spec.unit, fmt::format("signals.{}.unit", spec.name), origin);
}

Status PlanTime(const LogLayout& layout, const LogFormat& format, const std::string& origin,
                ColumnPlan& plan) {
  if (format.time_column.empty()) {
    if (!format.sample_period || !(*format.sample_period > 0))
      return BadInput(Tell(
          "log '{}': the machine file names no time column (time = \"\" in [log]), so it must give sample_period in s "
          "there, greater than 0",
          "Log '{}': die Maschinendatei nennt keine Zeitspalte (time = \"\" in [log]), also muss sie dort "
          "sample_period in s nennen, größer als 0",
          origin));
    return {};
  }
  const auto unit = FindUnit(format.time_unit);
  if (!unit || unit->si != "s")
    return BadInput(Tell(
        "unit = \"{}\" of time in [log] is no unit of time; expected one of 's', 'ms', 'us', 'ns', 'min', 'h', 'd'",
        "unit = \"{}\" der Zeit in [log] ist keine Einheit der Zeit; erwartet 's', 'ms', 'us', 'ns', 'min', 'h' oder "
        "'d'",
        format.time_unit));
  plan.time_scale = unit->scale;
  const auto column = layout.Find(format.time_column);
  if (!column)
    return MissingColumn(
        layout, format.time_column, Told("the time", "die Zeit"), origin,
        Told(
            "; name it by time = \"...\" in [log], or write time = \"\" and sample_period in s "
            "there if the rows are equally spaced",
            "; sie mit time = \"...\" in [log] nennen, oder dort time = \"\" und sample_period in s schreiben, wenn "
            "die Zeilen gleich weit auseinander liegen"));
  plan.time = static_cast<int>(*column);
  return CheckUnit(layout, plan.time, format.time_unit, "log.time.unit", origin);
}

void ReportTwins(const LogLayout& layout, const Machine& machine, LogCounters& counters) {
  std::vector<std::string> names = {machine.log.time_column};
  for (const SignalSpec& spec : machine.signals)
    if (!Contains(names, spec.column)) names.push_back(spec.column);
  for (const std::string& name : names) {
    const Told text = TwinsText(layout, name);
    if (text.empty()) continue;
    const std::vector<std::size_t> twins = layout.FindAll(name);
    for (auto twin = twins.begin() + 1; twin != twins.end(); ++twin)
      AddFinding(counters, {layout.data_line - 1, layout.names[*twin],
                            fmt::format("the name again, column {}", *twin + 1),
                            fmt::format("one column of that name; column {} is read", twins.front() + 1)});
    counters.twins = counters.twins.empty() ? text : Tell("{}; {}", "{}; {}", counters.twins, text);
  }
}

}  // namespace

Told TwinsText(const LogLayout& layout, const std::string& column) {
  const std::vector<std::size_t> twins = layout.FindAll(column);
  if (twins.size() < 2) return {};
  std::vector<std::size_t> numbers;
  for (const std::size_t twin : twins) numbers.push_back(twin + 1);
  return Tell(
      "{} columns are called '{}' ({}): column {} is read; where another is meant, the machine file can name it by its "
      "number, \"{}\"",
      "{} Spalten heißen '{}' ({}): gelesen wird Spalte {}; ist eine andere gemeint, kann die Maschinendatei sie mit ihrer "
      "Nummer nennen, \"{}\"",
      twins.size(), column, fmt::to_string(fmt::join(numbers, ", ")), numbers.front(), numbers[1]);
}

Result<ColumnPlan> PlanColumns(const LogLayout& layout, const Machine& machine, const std::string& origin,
                               LogCounters& counters) {
  ColumnPlan plan;
  TRY(PlanTime(layout, machine.log, origin, plan));
  for (const SignalSpec& spec : machine.signals) TRY(PlanSignal(layout, spec, origin, plan, counters));
  ReportTwins(layout, machine, counters);
  return plan;
}

void ConvertToSi(const ColumnPlan& plan, std::size_t rows, SampleBlock& block) {
  for (std::size_t s = 0; s < plan.to_si.size(); ++s) {
    const Linear linear = plan.to_si[s];
    if (linear.IsIdentity()) continue;
    double* values = block.signal[s].data();
    for (std::size_t row = 0; row < rows; ++row) values[row] = values[row] * linear.scale + linear.offset;
  }
}

void AddFinding(LogCounters& counters, LogFinding finding) {
  if (counters.findings.size() < kMostFindings) counters.findings.push_back(std::move(finding));
}

int FlagBit(Quality flag) { return std::countr_zero(flag); }

}  // namespace hydroscope
