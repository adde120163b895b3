#pragma once

#include <string>
#include <vector>

#include "core/records/alarm_records.h"
#include "models/counted_words.h"
#include "report/report.h"
#include "report/report_parameters.h"
#include "workbench/history/trend_analysis.h"

namespace hydroscope {

/// How a parameter stands, worst last.
enum class Standing { kSteady, kOil, kUnknown, kHint, kChanged, kWarned, kAlarmed };

/// What the report says about one parameter, as HTML (all names escaped). No sentence names a cause: a change
/// may be the machine's, the oil's or a sensor's.
struct ParameterWords {
  Standing standing = Standing::kUnknown;
  std::string pill;     ///< two or three words for `standing`
  std::string value;    ///< "14120 ± 210 bar" or "not identified"
  std::string reading;  ///< one or two sentences, the verdict
  std::string change;   ///< over the record
  std::string oil;      ///< dependence on oil temperature
  std::string
      confounded;      ///< HTML: what the newest estimate rests on, "" = nothing that the strokes do not show
  std::string limits;  ///< against the machine file
  bool by_alarm = false;  ///< `standing` is what an alarm says, not the record as a whole
};
/// Alarms that stand and speak of the parameter override what the record as a whole does not show: a young change, a slow one.
ParameterWords DescribeParameter(const ParameterAnalysis& analysis, const ParameterInfo& info,
                                 const CountedWords& counted = {},
                                 const std::vector<AlarmState>& alarms = {});

/// The verdict over all parameters.
struct ReportVerdict {
  Standing standing = Standing::kUnknown;
  std::string headline;                ///< HTML
  std::vector<std::string> sentences;  ///< HTML
};
ReportVerdict DescribeVerdict(const ReportInput& input, const TrendAnalysis& analysis,
                              const std::vector<ParameterInfo>& infos,
                              const std::vector<ParameterWords>& words);

}  // namespace hydroscope
