#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace hydroscope {

/// What is wrong with one value of one channel; a value may carry several flags. 0 is a good value.
/// A flagged value ends the estimation window of every model that reads the channel; it is counted, never
/// silently interpolated.
using Quality = std::uint16_t;

namespace quality {
inline constexpr Quality kGood = 0;
inline constexpr Quality kMissing = 1 << 0;     ///< empty field, NaN or infinity
inline constexpr Quality kStuck = 1 << 1;       ///< the very same reading for longer than the channel's limit
inline constexpr Quality kSpike = 1 << 2;       ///< a single reading far off both neighbours
inline constexpr Quality kOutOfRange = 1 << 3;  ///< outside the channel's min/max in the machine file
inline constexpr Quality kGap = 1 << 4;         ///< samples are missing before this one
inline constexpr Quality kTimeBackwards = 1 << 5;  ///< time stamp not after the one before
inline constexpr Quality kClockJump = 1 << 6;      ///< clock stepped (more than a gap: seconds or more)
inline constexpr Quality kLate = 1 << 7;           ///< arrived after its frame was closed (live only)
inline constexpr Quality kDuplicate = 1 << 8;      ///< same sequence number or time stamp again
inline constexpr Quality kOffsetDrift = 1 << 9;    ///< zero of the channel wandered off
inline constexpr Quality kStale = 1 << 10;   ///< a held reading older than its channel allows (live only)
inline constexpr Quality kFuture = 1 << 11;  ///< beyond what the sender's clock allows (live only)
/// An expression of the machine file is no finite number here.
inline constexpr Quality kExpression = 1 << 12;
/// On a straight line that a logger drew between two readings.
inline constexpr Quality kInterpolated = 1 << 13;

struct FlagName {
  Quality flag;
  std::string_view name;
};
/// Every flag with the name used in messages, JSON and the database.
inline constexpr std::array<FlagName, 14> kFlagNames = {{{kMissing, "missing"},
                                                         {kStuck, "stuck"},
                                                         {kSpike, "spike"},
                                                         {kOutOfRange, "out_of_range"},
                                                         {kGap, "gap"},
                                                         {kTimeBackwards, "time_backwards"},
                                                         {kClockJump, "clock_jump"},
                                                         {kLate, "late"},
                                                         {kDuplicate, "duplicate"},
                                                         {kOffsetDrift, "offset_drift"},
                                                         {kStale, "stale"},
                                                         {kFuture, "future"},
                                                         {kExpression, "expression"},
                                                         {kInterpolated, "interpolated"}}};
}  // namespace quality

}  // namespace hydroscope
