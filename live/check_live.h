#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "acquisition/aligner.h"
#include "acquisition/source.h"
#include "core/clock.h"
#include "live/live_service.h"
#include "models/machine.h"

namespace hydroscope {

/// One channel after some seconds of listening.
struct CheckedChannel {
  std::string name, unit;                            ///< unit: SI
  double rate = 0;                                   ///< values per s
  double age = 0;                                    ///< s, of the newest at the end; NaN: none came
  double min = 0, max = 0, mean = 0, noise_std = 0;  ///< SI; NaN if not known
  std::int64_t flagged = 0;
  std::vector<std::string> hints;  ///< what does not make sense, and what to do
};

struct LiveCheck {
  double seconds = 0;
  std::vector<SourceStatus> sources;
  std::vector<StreamState> streams;
  std::vector<CheckedChannel> channels;

  bool Clean() const;  ///< no hint
};

/// Listens for `seconds`; stores nothing. Errors: a source whose settings can never work.
Result<LiveCheck> CheckLive(const Machine& machine, double seconds, const LiveService::SourceFactory& sources,
                            const Clock& clock);

std::string LiveCheckText(const LiveCheck& check);
nlohmann::json LiveCheckJson(const LiveCheck& check);

}  // namespace hydroscope
