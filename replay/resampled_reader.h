#pragma once

#include <memory>
#include <string>

#include "replay/log_reader.h"

namespace hydroscope {

/// Rows of loggers whose clocks differ by less are as far apart; results of both go together as they are.
inline constexpr double kSamePeriod = 0.05;
/// Rows whose distances differ by more are not interpolated: one of the logs then knows less than the other shows.
inline constexpr double kNearPeriod = 0.25;

/// `reader` with rows `period` s apart: as it is where they are (kSamePeriod), interpolated between neighbours where they
/// are nearly (kNearPeriod; `note` then says so), as it is otherwise. A bad value spoils the rows beside it; behind a gap
/// the grid begins anew. Rows are counted as they are given out, everything else as it was read. Interpolation takes up to a third of white noise away.
std::unique_ptr<LogReader> AtPeriod(std::unique_ptr<LogReader> reader, double period, std::string& note);

}  // namespace hydroscope
