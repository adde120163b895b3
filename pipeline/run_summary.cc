#include "pipeline/run_summary.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json_text.h"

namespace hydroscope {
namespace {

/// Throws if a value is of another kind than expected.
RunSummary ReadSummary(const nlohmann::json& json) {
  RunSummary s;
  s.sample_period = json.value("sample_period", 0.0);
  s.rows = json.value("rows", std::int64_t{0});
  s.rejected_rows = json.value("rejected_rows", std::int64_t{0});
  s.gated = json.value("gated", std::int64_t{0});
  s.used = json.value("used", std::int64_t{0});
  s.discarded_strokes = json.value("discarded_strokes", std::int64_t{0});
  s.flagged = json.value("flagged", decltype(s.flagged){});
  s.absent = json.value("absent", decltype(s.absent){});
  s.warnings = json.value("warnings", decltype(s.warnings){});
  s.too_slow = json.value("too_slow", std::string());
  s.impossible = json.value("impossible", std::string());
  for (const auto& [key, value] :
       {std::pair("noise_scale", &s.noise_scale), std::pair("evidence_scale", &s.evidence_scale),
        std::pair("floor_scale", &s.floor_scale)})
    if (const double read = json.value(key, 0.0); std::isfinite(read) && read > 0) *value = read;
  s.stopped = json.value("stopped", std::string());
  for (const auto& f : json.value("findings", nlohmann::json::array()))
    s.findings.push_back({f.value("line", std::int64_t{0}), f.value("column", std::string()),
                          f.value("found", std::string()), f.value("expected", std::string())});
  return s;
}

}  // namespace

std::int64_t RunSummary::FlaggedValues() const {
  std::int64_t sum = 0;
  for (const auto& [channel, flags] : flagged)
    for (const auto& [flag, count] : flags) sum += count;
  return sum;
}

std::string FormatRunSummary(const RunSummary& s) {
  nlohmann::json findings = nlohmann::json::array();
  for (const LogFinding& f : s.findings)
    findings.push_back(
        {{"line", f.line}, {"column", f.column}, {"found", f.found}, {"expected", f.expected}});
  nlohmann::json json = {{"sample_period", s.sample_period},
                         {"rows", s.rows},
                         {"rejected_rows", s.rejected_rows},
                         {"gated", s.gated},
                         {"used", s.used},
                         {"discarded_strokes", s.discarded_strokes},
                         {"flagged", s.flagged},
                         {"absent", s.absent},
                         {"findings", findings},
                         {"warnings", s.warnings},
                         {"too_slow", s.too_slow},
                         {"impossible", s.impossible},
                         {"stopped", s.stopped}};
  if (s.noise_scale) json["noise_scale"] = *s.noise_scale;
  if (s.evidence_scale) json["evidence_scale"] = *s.evidence_scale;
  if (s.floor_scale) json["floor_scale"] = *s.floor_scale;
  return JsonText(json);
}

RunSummary ParseRunSummary(const std::string& text) {
  try {
    const auto json = nlohmann::json::parse(text);
    return json.is_object() ? ReadSummary(json) : RunSummary();
  } catch (const nlohmann::json::exception&) {  // no JSON, or values of another kind
    return {};
  }
}

std::string FindingText(const LogFinding& f) {
  std::string text = f.line > 0 ? fmt::format("line {}", f.line) : "";
  if (!f.column.empty()) text += fmt::format("{}column {}", text.empty() ? "" : ", ", f.column);
  if (!f.found.empty()) text += fmt::format(": found '{}'", f.found);
  if (!f.expected.empty()) text += fmt::format(", expected {}", f.expected);
  return text;
}

}  // namespace hydroscope
