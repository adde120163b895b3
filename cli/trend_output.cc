#include "cli/trend_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/interval_text.h"
#include "core/json_text.h"
#include "core/json_value.h"
#include "core/printable.h"
#include "core/short_number.h"
#include "core/shown_width.h"
#include "core/time_text.h"
#include "core/units.h"
#include "host/output.h"
#include "host/text_sink.h"
#include "models/parameter_unit.h"
#include "workbench/fit_output.h"
#include "workbench/history/trend_summary.h"

namespace hydroscope {
namespace {

constexpr std::size_t kSparkWidth = 10, kLeastSparkWidth = 4;
constexpr std::size_t kLongUnit = 8;  ///< longer ones are told in their column alone

std::string ValueText(double value, double half_width) {
  return std::isfinite(value) ? WithInterval(value, half_width) : "-";
}

/// "" if the last stroke excited it.
std::string LastExcited(const TrendSummary& s, const CountedWords& counted) {
  if (!s.since && s.latest.reason == EstimateReason::kConfounded)
    return fmt::format("never told from other parameters by these {}", counted.many);
  if (!s.since) return fmt::format("never excited: these {} have nothing to do with it", counted.many);
  if (*s.since == 0) return "";
  return fmt::format("last excited {} ago, {} of {} told something", counted.Counted(*s.since), s.updated,
                     s.strokes);
}

MachineKind KindOfSummary(const TrendSummary& s) { return s.kind == nullptr ? MachineKind{} : *s.kind; }

DisplayUnit ShownUnitOf(const TrendSummary& s) {
  return ParameterUnit(KindOfSummary(s), s.parameter, s.unit);
}

/// Of the change; nothing where a percentage says nothing.
std::optional<double> PercentOf(const TrendSummary& s) {
  return ToldInPercent(KindOfSummary(s), s.parameter, s.unit) ? s.change->Percent() : std::nullopt;
}

std::string TrendChangeText(const TrendSummary& s, const CountedWords& counted) {
  if (!s.change && s.version_since) return "not comparable";
  if (!s.change) return fmt::format("too few {}", counted.many);
  const auto percent = PercentOf(s);
  const DisplayUnit unit = ShownUnitOf(s);
  const double value = percent ? *percent : s.change->value * unit.factor;
  const double half_width = kNormal95 * (percent ? *s.change->PercentStd() : s.change->std * unit.factor);
  const bool in_column = unit.name == "-" || unit.name.size() > kLongUnit;
  const std::string name = percent ? " %" : in_column ? "" : fmt::format(" {}", unit.name);
  const char* judged = s.change->with_oil      ? "significant, with the oil"
                       : s.change->significant ? "significant"
                       : s.change->hint        ? "a hint"
                       : s.change->cannot_tell ? "cannot tell"
                                               : "within noise";
  return fmt::format("{}{}{}, {}", value >= 0 ? "+" : "", ValueText(value, half_width), name, judged);
}

/// Widths of the columns. What a long name or unit takes, values and changes give as far as they are shorter, then the course.
struct TableWidths {
  std::size_t name = 9, value = 20, unit = 6, change = 31, course = kSparkWidth;

  std::size_t Line() const { return name + value + unit + change + course + 4; }
};

std::string TableRow(const TableWidths& widths, const std::array<std::string, 5>& cells) {
  return fmt::format("{:<{}} {:>{}} {:<{}} {:<{}} {}\n", cells[0], widths.name, cells[1], widths.value,
                     cells[2], widths.unit, cells[3], widths.change, cells[4]);
}

std::string LatestText(const TrendSummary& s) {
  const DisplayUnit unit = ShownUnitOf(s);
  return ValueText(s.latest.value * unit.factor + unit.offset, kNormal95 * s.latest.std * unit.factor);
}

TableWidths WidthsFor(const std::vector<TrendSummary>& summaries, const CountedWords& counted) {
  TableWidths widths;
  std::size_t value = ShownWidth("latest, 95 %"), change = ShownWidth("change, 95 %");
  for (const TrendSummary& s : summaries) {
    widths.name = std::max(widths.name, ShownWidth(s.parameter));
    widths.unit = std::max(widths.unit, ShownWidth(ShownUnitOf(s).name));
    value = std::max(value, ShownWidth(LatestText(s)));
    change = std::max(change, ShownWidth(TrendChangeText(s, counted)));
  }
  const auto give = [&](std::size_t& width, std::size_t least) {
    const std::size_t beyond = widths.Line() - std::min(widths.Line(), kLineWidth);
    width = std::max(std::min(width, least), width - std::min(width, beyond));
  };
  give(widths.value, value);
  give(widths.change, change);
  give(widths.course, kLeastSparkWidth);
  return widths;
}

std::string Row(const TrendSummary& s, const TableWidths& widths, const CountedWords& counted) {
  const DisplayUnit unit = ShownUnitOf(s);
  return TableRow(widths, {s.parameter, LatestText(s), std::string(unit.name), TrendChangeText(s, counted),
                           Sparkline(s.values, s.stds, widths.course)});
}

std::string Header(const MachineTrends& trends) {
  const TrendPoint &first = trends.first, &last = trends.last;
  std::string text =
      fmt::format("{}: {} in {} run{}, {} {} to {} shown\n",
                  trends.machine.empty() ? "machine" : Printable(trends.machine),
                  trends.counted.Counted(trends.runs.back().first_sequence + trends.runs.back().strokes),
                  trends.runs.size(), trends.runs.size() == 1 ? "" : "s", trends.counted.many, first.sequence,
                  last.sequence);
  const RunInfo& run = trends.runs.back();
  text += fmt::format("last log {}{}, {}", Printable(run.source), run.complete ? "" : " (not finished)",
                      CountsFrom1970(first.time)
                          ? fmt::format("{} from {} to {}", trends.counted.many, LocalTimeText(first.time),
                                        LocalTimeText(last.time))
                          : fmt::format("ends at {:.1f} s", last.time));
  if (std::isfinite(last.oil_temperature))
    text += fmt::format(", oil {:.1f} °C", last.oil_temperature - kZeroCelsius);
  return text + "\n";
}

std::string Reasons(const std::vector<TrendSummary>& summaries, const CountedWords& counted) {
  std::string text;
  for (const TrendSummary& s : summaries) {
    const std::string excited = LastExcited(s, counted);
    const bool updated = s.latest.reason == EstimateReason::kUpdated;
    if (excited.empty() && updated) continue;
    const bool never = !s.since;
    text += fmt::format("{}: {}{}{}\n", s.parameter, updated || never ? "" : ReasonText(s.latest.reason),
                        excited.empty() || updated || never ? "" : "; ", excited);
  }
  return text.empty() ? text : fmt::format("\nNot updated by the last {}\n", counted.one) + text;
}

/// Changes that matter and would not be seen.
std::string CannotTellText(const std::vector<TrendSummary>& summaries) {
  std::string text;
  for (const TrendSummary& s : summaries) {
    if (!s.change || !s.change->cannot_tell) continue;
    const DisplayUnit unit = ShownUnitOf(s);
    text += fmt::format("{}: a change below {}{} would not be seen\n", s.parameter,
                        ShortNumber(s.change->smallest_seen * unit.factor),
                        unit.name == "-" ? "" : fmt::format(" {}", unit.name));
  }
  return text.empty() ? text : "\nCannot be told\n" + text;
}

/// That estimates of two models say nothing of a change.
std::string VersionsText(const std::vector<TrendSummary>& summaries, const CountedWords& counted) {
  const auto since =
      std::ranges::find_if(summaries, [](const auto& s) { return s.version_since.has_value(); });
  if (since == summaries.end()) return "";
  return fmt::format(
      "\nUp to {} {} estimates are of other versions of the model and cannot be compared with those since; changes are judged on "
      "blocks of {} refitted with the model in force, where it fits what is stored.\n",
      counted.one, *since->version_since - 1, counted.many);
}

/// What the newest estimates rest on.
std::string StatedText(const MachineTrends& trends) {
  std::string text;
  for (const TrendSummary& s : trends.summaries)
    if (!s.not_trusted.empty()) text += fmt::format("{}: {}\n", s.parameter, s.not_trusted.english);
  if (!text.empty()) text = "\nNot identifiable\n" + text;
  for (const Told& unusual : trends.unusual) text += fmt::format("\nWARNING: {}\n", unusual.english);
  if (!trends.assumed.empty()) text += "\n";
  for (const AssumedTolerance& assumed : trends.assumed) text += AssumedText(assumed) + "\n";
  return text;
}

/// Changes that the drift watch alarms: one that began late hardly shows in a comparison of thirds.
std::string AlarmsText(const MachineTrends& trends) {
  std::string text;
  for (const AlarmState& alarm : trends.alarms)
    text += fmt::format("{}: stands, since {} {}\n", alarm.id, trends.counted.one, alarm.first_stroke);
  return text.empty() ? text : "\nAlarms of the drift watch\n" + text;
}

/// A field of CSV, which may be shown on a terminal.
std::string Field(const std::string& text) {
  const std::string field = Printable(text);
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

/// Shortest text that reads back to the same double; empty for NaN.
std::string Number(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

double Celsius(double kelvin) { return std::round((kelvin - kZeroCelsius) * 1e6) / 1e6; }

std::string CsvRow(const std::string& machine, const TrendPoint& p) {
  const Estimate& e = p.estimate;
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", machine, p.run, p.stroke, p.sequence,
                     Number(p.time), Field(e.parameter), Number(e.value), Number(e.std), Field(e.unit),
                     Number(Celsius(p.oil_temperature)), ReasonName(e.reason), Number(e.excitation),
                     Number(e.last_excited));
}

nlohmann::json PointJson(const TrendPoint& p) {
  const Estimate& e = p.estimate;
  return {{"run", p.run},
          {"stroke", p.stroke},
          {"sequence", p.sequence},
          {"time_s", JsonNumber(p.time)},
          {"parameter", e.parameter},
          {"value", JsonNumber(e.value)},
          {"std", JsonNumber(e.std)},
          {"unit", e.unit},
          {"oil_temperature_degC", JsonNumber(Celsius(p.oil_temperature))},
          {"reason", ReasonName(e.reason)},
          {"excitation", JsonNumber(e.excitation)},
          {"last_excited_s", JsonNumber(e.last_excited)}};
}

nlohmann::json SummaryJson(const TrendSummary& s) {
  nlohmann::json out = {
      {"parameter", s.parameter},
      {"unit", s.unit},
      {"value", JsonNumber(s.latest.value)},
      {"std", JsonNumber(s.latest.std)},
      {"strokes", s.strokes},
      {"updated", s.updated},
      {"reason", ReasonName(s.latest.reason)},
      {"version_since", s.version_since ? nlohmann::json(*s.version_since) : nlohmann::json()},
      {"change", nullptr}};
  if (!s.not_trusted.empty()) {
    if (s.latest.reason == EstimateReason::kUpdated) out["reason"] = ReasonName(EstimateReason::kConfounded);
    out["why"] = s.not_trusted.english;
  }
  if (s.confounded) {
    out.update({{"confounded_with", s.confounded->effects},
                {"confounded_bias", s.confounded->bias},
                {"why", s.confounded->reason.english},
                {"advice", s.confounded->advice.english}});
  }
  if (!s.change) return out;
  out["change"] = {{"value", s.change->value},
                   {"std", s.change->std},
                   {"significant", s.change->significant},
                   {"hint", s.change->hint},
                   {"with_oil", s.change->with_oil},
                   {"p", s.change->p},
                   {"smallest_seen", s.change->smallest_seen},
                   {"cannot_tell", s.change->cannot_tell}};
  if (const auto percent = PercentOf(s)) {
    out["change"]["percent"] = *percent;
    out["change"]["percent_std"] = *s.change->PercentStd();
  }
  return out;
}

/// False: the file cannot be written, which Close tells.
Result<bool> WriteMachine(TextSink& sink, const MachineTrends& trends, const TrendPoints& points) {
  bool written = sink.Write(
      fmt::format("{{\"schema\": {}, \"machine\": {}, \"points\": [", kJsonSchema, JsonText(trends.machine)));
  const char* before = "\n";
  TRY(points(trends, [&](const TrendPoint& point) {
    written = written && sink.Write(before + JsonText(PointJson(point)));
    before = ",\n";
    return written;
  }));
  nlohmann::json summary = nlohmann::json::array();
  for (const TrendSummary& s : trends.summaries) summary.push_back(SummaryJson(s));
  nlohmann::json alarms = nlohmann::json::array();
  for (const AlarmState& alarm : trends.alarms)
    alarms.push_back({{"alarm", alarm.id}, {"first_stroke", alarm.first_stroke}});
  return written && sink.Write("\n], \"summary\": " + JsonText(summary, 1) +
                               ", \"assumed_tolerances\": " + JsonText(AssumedJson(trends.assumed), 1) +
                               ", \"warnings\": " + JsonText(InEnglish(trends.unusual), 1) +
                               ", \"alarms\": " + JsonText(alarms, 1) + "}");
}

}  // namespace

std::string TrendText(const MachineTrends& trends) {
  const std::vector<TrendSummary>& summaries = trends.summaries;
  std::string text = Header(trends);
  const TableWidths widths = WidthsFor(summaries, trends.counted);
  text += "\n" + TableRow(widths, {"parameter", "latest, 95 %", "unit", "change, 95 %",
                                   std::string(trends.counted.many)});
  for (const TrendSummary& s : summaries) text += Row(s, widths, trends.counted);
  return text + VersionsText(summaries, trends.counted) + CannotTellText(summaries) +
         Reasons(summaries, trends.counted) + StatedText(trends) + AlarmsText(trends);
}

Status WriteTrendCsv(const std::string& path, const std::vector<MachineTrends>& machines,
                     const TrendPoints& points) {
  auto sink = TRY(TextSink::Open(path));
  sink.Write(
      "machine,run,stroke,sequence,time_s,parameter,value,std,unit,oil_temperature_degC,reason,excitation,"
      "last_excited_s\n");
  for (const MachineTrends& trends : machines) {
    const std::string machine = Field(trends.machine);
    bool written = true;
    TRY(points(trends,
               [&](const TrendPoint& point) { return written = sink.Write(CsvRow(machine, point)); }));
    if (!written) break;
  }
  return sink.Close();
}

Status WriteTrendJson(const std::string& path, const std::vector<MachineTrends>& machines,
                      const TrendPoints& points) {
  auto sink = TRY(TextSink::Open(path));
  const bool several = machines.size() != 1;
  bool written = sink.Write(several ? "{\"machines\": [" : "");
  for (std::size_t i = 0; written && i < machines.size(); ++i) {
    if (i > 0) sink.Write(",\n");
    written = TRY(WriteMachine(sink, machines[i], points));
  }
  if (written) sink.Write(several ? "]}\n" : "\n");
  return sink.Close();
}

}  // namespace hydroscope
