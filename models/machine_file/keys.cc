#include "models/machine_file/keys.h"

#include <algorithm>

#include "models/machine_file/feed_section.h"
#include "models/machine_kind.h"
#include "models/source_kind.h"

namespace hydroscope {
namespace {

/// What all kinds of machines may be asked for; that of other kinds is refused by name.
std::vector<std::string> ExperimentKeys() {
  std::vector<std::string> keys = {"max_strokes", "signals"};
  for (const MachineKind* kind : MachineKinds())
    for (const StrokeSetting& setting : kind->experiment.settings) keys.emplace_back(setting.key);
  return keys;
}

MachineSection& Named(std::vector<MachineSection>& sections, std::string_view name) {
  return *std::find_if(sections.begin(), sections.end(), [&](const auto& s) { return s.name == name; });
}

/// The sections of sources and feeds added to the others.
std::vector<MachineSection> WithParts(std::vector<MachineSection> sections) {
  for (const SourceKind* source : SourceKinds()) {
    for (const char* holder : {"live", "signals.<name>"})
      Named(sections, holder).keys.emplace_back(source->name);
    sections.insert(sections.end(), source->sections.begin(), source->sections.end());
  }
  std::vector<std::string> feeds;
  for (const FeedSection* feed : FeedSections()) {
    feeds.emplace_back(feed->name);
    sections.push_back({fmt::format("feeds.{}", feed->name), feed->keys});
  }
  sections.push_back({"feeds", feeds});
  return sections;
}

}  // namespace

const std::vector<MachineSection>& MachineFileSections() {
  static const std::vector<MachineSection> sections = WithParts({
      {"", {"machine",    "log",           "signals", "geometry", "gate",       "conditions", "window",
            "estimator",  "monitor",       "valve",   "balance",  "effect",     "live",       "feeds",
            "experiment", "model_history", "states",  "outputs",  "parameters", "episodes"}},
      {"machine", {"name", "model", "description", "model_version", "effects", "effect_values"}},
      {"log",
       {"separator", "decimal", "skip_lines", "header", "unit_row", "time", "sample_period", "hold",
        "outputs_late"}},
      {"log.time", {"column", "unit"}},
      {"signals.<name>",
       {"column", "unit", "scale", "offset", "min", "max", "noise", "stuck_time", "required"}},
      {"geometry.<name>", {"value", "std", "unit"}},
      {"gate", {"conditions", "stroke_gap", "min_stroke", "max_stroke"}},
      {"gate.conditions.<signal>", {"min", "max", "unit"}},
      {"window", {"block", "span", "half_width"}},
      {"estimator",
       {"equation", "form", "forgetting_factor", "time_constant", "time_constants", "initial_covariance",
        "initial_parameter", "initial_from_first_stroke", "max_covariance", "dead_zone", "clip",
        "moving_average", "symmetrical_derivative", "update_period"}},
      {"monitor.<parameter>", {"unit", "reference", "warn_low", "warn_high", "alarm_low", "alarm_high"}},
      {"valve", {"input", "output", "full_scale"}},
      {"experiment", ExperimentKeys()},
      {"experiment.<range>", {"min", "max", "unit"}},
      {"balance", {"output", "unit", "terms", "derived"}},
      {"effect",
       {"id", "description", "german", "terms", "unit", "min", "max", "typical", "shape", "adds",
        "parameters"}},
      {"states.<name>", {"ddt", "initial", "near", "min", "max", "unit"}},
      {"parameters.<name>", {"start", "min", "max", "unit"}},
      {"episodes", {"seconds", "marker", "shaft"}},
      {"shape.<name>", {"min", "max", "unit"}},
      {"terms.<parameter>", {"expression", "unit"}},
      {"live", {"grid_period", "axes"}},
      {"model_history",
       {"version", "name", "effects", "source", "strokes", "rms_holdout", "noise_floor", "unit",
        "parameters"}},
      {"model_history.parameters.<name>", {"value", "std", "unit"}},
      {"<quantity>", {"value", "unit"}},
  });
  return sections;
}

const std::vector<std::string>& MachineFileKeys(std::string_view name) {
  static const std::vector<std::string> none;
  for (const MachineSection& section : MachineFileSections())
    if (section.name == name) return section.keys;
  return none;
}

}  // namespace hydroscope
