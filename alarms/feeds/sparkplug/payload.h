#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "alarms/feeds/feed_reader.h"
#include "alarms/feeds/tag.h"

/// Sparkplug B 3.0 payloads (docs/sparkplug.md), pure: what goes in comes out as bytes of sparkplug_b.proto.
/// Times are s since 1970.
namespace hydroscope::sparkplug {

std::string NodeBirth(std::uint8_t birth_death, double wall);
/// The same number as the birth before the connection's end.
std::string NodeDeath(std::uint8_t birth_death);
/// Everything that data of this axis may speak of, as it is now.
std::string DeviceBirth(const AxisPicture& axis, double wall);
/// Strokes, health, oil and parameters after a stroke.
std::string DeviceData(const AxisPicture& axis, double wall);
/// One row of the journal, with the state of its alarm.
std::string Event(const JournalRow& row);

/// The payload with the sequence number of this connection; `historical`: it could not be sent when it
/// happened. nullopt: these bytes are no payload.
std::optional<std::string> Sealed(const std::string& payload, std::uint8_t sequence, bool historical);
/// A command that asks the node to be born again. False for anything else, also for what is no payload.
bool AsksForRebirth(const std::string& payload);

/// What an event's payload says about the row it tells; nullopt: it is none.
struct ToldRow {
  std::int64_t sequence = 0;
  std::string alarm, comment;
};
std::optional<ToldRow> RowOf(const std::string& payload);
/// Health that a device's birth or data tells, "F" say; "" if it tells none.
std::string HealthOf(const std::string& payload);

/// The metrics of a payload as tags without feed, axis and address.
std::vector<Tag> TagsOf(const std::string& payload);

/// A name as topics allow it: without /, + and #.
std::string TopicPart(const std::string& name);

}  // namespace hydroscope::sparkplug
