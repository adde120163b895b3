#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/told.h"
#include "models/machine.h"
#include "replay/log_reader.h"

namespace hydroscope {

/// Signals that are new every few rows only, while others are new in each: a slower bus or task wrote them. Held readings are
/// late by half the rows between new ones, which looks like a delay of the sensor.
struct HeldSignals {
  std::vector<std::size_t> signals;
  Told why;  ///< which they are, and what is done
};

/// Looks at the first rows of a log. Commands are held by the controller itself, and a model with states says how its inputs
/// are held: neither counts.
std::optional<HeldSignals> FindHeldSignals(const SampleBlock& head, const Machine& machine);

/// Draws straight lines between the new readings of those signals in all rows of a log.
void DrawHeldSignals(const HeldSignals& held, SampleBlock& rows);
/// The same of rows as they are read.
std::unique_ptr<LogReader> WithDrawnSignals(std::unique_ptr<LogReader> reader, HeldSignals held);

}  // namespace hydroscope
