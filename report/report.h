#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/records/alarm_records.h"
#include "core/result.h"
#include "pipeline/stroke_overlays.h"
#include "workbench/explain/confounding.h"
#include "workbench/explain/headline.h"
#include "workbench/history/trend_analysis.h"

namespace hydroscope {

/// What was left out and why: "values flagged stuck, p_A", 1234 rows.
struct SkippedItem {
  std::string what;
  std::int64_t rows = 0;
  std::string why;
};

struct ReportInput : RecordedHistory {
  std::vector<StrokeOverlay> overlays;  ///< one or a few chosen strokes
  std::vector<SkippedItem> skipped;
  std::string explanation_verdict;          ///< HTML of VerdictSection, "" = nothing was explained
  bool explanation_leads = false;           ///< it stands before the verdict on the parameters
  std::vector<AlarmState> alarms;           ///< of the axis, as far as they stand: no verdict denies them
  std::string drift_verdict;                ///< HTML of AlarmsBox, "" = no alarm stands
  std::string drift;                        ///< HTML of DriftSection
  std::string explanation;                  ///< HTML of ExplainSections
  std::int64_t rows = 0;                    ///< rows read
  double noise_floor = 0, rms_holdout = 0;  ///< SI of the output; 0 = take the medians over the strokes
  std::vector<Estimate> latest;             ///< after the last stroke, as they are stated (StateEstimates)
  std::vector<Confounding> confounded;      ///< of them
  std::vector<Told> unusual;                ///< of them, what makes them doubtful
  /// Why the error of the model says nothing (ImpossibleFigures, Explanation::no_verdict), "" if it does.
  std::string not_judged;
  std::optional<ErrorFinding> found;  ///< by the explanation; nothing = no verdict
  std::string program_version;        ///< "" = not shown
  std::string created;                ///< date and time as text, "" = not shown
  /// One sentence about a parameter the report does not know by itself, shown in the glossary.
  std::map<std::string, std::string> parameter_notes;
};

/// The page as text; the same input gives the same bytes.
std::string FormatReport(const ReportInput& input);

/// Writes one self-contained HTML page (inline SVG and CSS, light and dark, prints on A4): verdict first,
/// trends over strokes and over oil temperature with 95 % bands, model against measurement, what was skipped
/// and why. Fails if the file cannot be written.
Status WriteReport(const std::string& path, const ReportInput& input);

}  // namespace hydroscope
