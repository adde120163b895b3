#pragma once

#include <string>
#include <vector>

#include "core/told.h"
#include "estimation/states/simulation.h"
#include "pipeline/log_pass.h"

namespace hydroscope {

/// Logs of a machine that is described by states, cut into episodes.
struct EpisodeLog {
  Machine machine;
  std::vector<Episode> episodes;
  std::int64_t rows = 0, used = 0;
  double period = 0;  ///< s
  std::vector<Told> warnings;
  LogPass pass;  ///< of the last log

  double Seconds() const;
};

/// Reads logs. Rows without a good reading of an input end an episode, so do gaps, steps of the clock and changes of
/// Machine::episode_marker; readings of outputs that are no good are left out. Long pieces are cut as [episodes] says. Readings
/// that repeat or stand out count as good on inputs, which may rest and jump. Errors: a log cannot be read,
/// readings of a size that no such machine has (a wrong unit), a log given twice, a signal that counts the other way round, no episode is left (says
/// why), a rate in [gate].
Result<EpisodeLog> ReadEpisodes(const std::vector<std::string>& logs, const Machine& machine);

/// What ReadEpisodes leaves out of a log, for a pass that takes its rows one by one: readings where sensors end or have frozen, and of
/// inputs that hung, with what is said of them. Nothing of a log that cannot be read.
LogPassHooks KnownOfEpisodes(const std::string& log, const Machine& machine);

/// Error where a signal of a log counts the other way round (ReversedSignalIn); what else keeps it from being read is no matter here.
Status JudgeSigns(const std::string& log, const Machine& machine);

}  // namespace hydroscope
