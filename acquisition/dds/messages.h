#pragma once

#include <hydroscope_wire/hydroscope_live.h>

#include "acquisition/batch_assembler.h"

namespace hydroscope {

/// Messages of the wire as plain records.
inline LayoutMessage ToMessage(const hydroscope_wire::Layout& wire) {
  LayoutMessage message{
      .version = wire.version(), .session = wire.session(), .layout_id = wire.layout_id(), .channels = {}};
  for (const auto& name : wire.channels()) message.channels.emplace_back(name.c_str());
  return message;
}

inline BatchMessage ToMessage(hydroscope_wire::Batch&& wire) {
  return {.version = wire.version(),
          .session = wire.session(),
          .layout_id = wire.layout_id(),
          .first_sequence = wire.first_sequence(),
          .source_time_ns = wire.source_time_ns(),
          .period_ns = wire.period_ns(),
          .rows = wire.rows(),
          .values = std::move(wire.values())};
}

}  // namespace hydroscope
