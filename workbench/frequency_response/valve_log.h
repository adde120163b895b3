#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "estimation/frequency_response/frequency_response.h"
#include "models/machine.h"
#include "workbench/frequency_response/frf_record.h"

namespace hydroscope {

/// A log of a valve's command and response and what was measured of it.
struct ValveLog {
  std::string name;
  FrfRecord log;
  FrequencyResponse response;

  /// Nothing was left out and there is a model.
  bool Complete() const;
  /// The points that take part in the fit, in order of frequency.
  std::vector<const FrequencyPoint*> Used() const;
};

/// Reads `path` and measures the response from the signal [valve] input to output. Errors: kUsage of options; kBadInput of a log
/// that cannot be read or tells nothing, with its name and what of it was left out.
Result<ValveLog> MeasureValveLog(const std::string& path, const Machine& machine,
                                 const FrequencyResponseOptions& options = {});

}  // namespace hydroscope
