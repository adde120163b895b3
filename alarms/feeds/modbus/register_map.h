#pragma once

#include <array>
#include <cstdint>
#include <string_view>

/// The register map of the Modbus feed, version 1, as docs/register_map.md describes it. Whole numbers and
/// float32 have the most significant word first; text has two ASCII characters a register, zeros behind.
namespace hydroscope::register_map {

inline constexpr std::uint16_t kMagic0 = 0x4859, kMagic1 = 0x4452;  // "HYDR"
inline constexpr std::uint16_t kVersion = 1;
inline constexpr int kRegisters = 65536;

/// Head.
enum Head {
  kMagic = 0,  ///< two registers
  kMapVersion = 2,
  kHeartbeat = 3,
  kNewest = 4,  ///< uint32, sequence of the newest row of the ring; 0: none
  kOldest = 6,  ///< uint32, of the oldest
  kAxes = 8,
  kAlarms = 9,     ///< alarms that have a number: 1 to this
  kStanding = 10,  ///< of these not at rest
  kUnacknowledged = 11,
  kClock = 12,    ///< uint32, s since 1970, of this picture
  kWaiting = 14,  ///< acknowledgements not yet in the journal
  kTrouble = 15,  ///< what keeps the service from storing or judging, a HealthReason; 0: nothing
  kLayout = 16,   ///< eleven registers: where the parts lie
  kHeadSize = 32,
};
/// The one register that may be written: the number of the alarm to acknowledge.
inline constexpr int kAcknowledge = 100;
inline constexpr int kAcknowledgeOutcome = 101;
enum Outcome : std::uint16_t { kNothingAsked, kAsked, kAcknowledged, kNothingToAcknowledge, kNotStored };

/// Why the health of axis a is what it is, from kFirstHealth + kHealthStride (a - 1).
inline constexpr int kFirstHealth = 128, kHealthStride = 4;
enum HealthDetail {
  kReason = 0,   ///< a HealthReason
  kLearned = 1,  ///< strokes commissioning has; 65535: more; 0 once there is a reference
  kNeeded = 2,   ///< strokes it needs
};

/// How far the cause of alarm n is known, a CauseKind, at kFirstCause + n - 1.
inline constexpr int kFirstCause = 512;

/// Axes.
inline constexpr int kFirstAxis = 1024, kAxisStride = 240, kMostAxes = 64;
enum Axis {
  kHealth = 0,
  kParameters = 1,
  kStrokeAge = 2,  ///< s, 65535: longer, or never a stroke
  kAxisStanding = 3,
  kStrokes = 4,         ///< uint32
  kOilTemperature = 6,  ///< float32, degC
  kAxisName = 8,        ///< 16 characters
  kFirstParameter = 16,
};
inline constexpr int kParameterStride = 16, kMostParameters = 14;
enum Parameter {
  kValue = 0,  ///< float32, SI
  kStd = 2,    ///< float32, SI
  kQuality = 4,
  kEstimateAge = 5,    ///< s since it was last excited
  kEstimateOil = 6,    ///< float32, degC
  kParameterName = 8,  ///< 16 characters
};
/// Quality word of a parameter: 0 identified in the newest stroke; else an older value and why, in the order
/// of EstimateReason.
inline constexpr std::uint16_t kNeverIdentified = 255;

/// Alarms.
inline constexpr int kFirstAlarm = 16384, kAlarmStride = 32, kMostAlarms = 512;
enum Alarm {
  kFlags = 0,
  kState = 1,
  kSeverity = 2,
  kAlarmAxis = 3,
  kRaised = 4,          ///< uint32, s since 1970
  kRaisedStroke = 6,    ///< uint32
  kAlarmValue = 8,      ///< float32, SI
  kAlarmStd = 10,       ///< float32, SI
  kAlarmLimit = 12,     ///< float32, SI
  kAlarmSequence = 14,  ///< uint32, newest row about it that the ring got
  kAlarmName = 16,      ///< 32 characters
};
enum Flag : std::uint16_t {
  kActive = 1,
  kIsAcknowledged = 2,
  kLatched = 4,
  kShelved = 8,
  kSuppressed = 16,
  kOutOfService = 32
};

/// The ring of journal rows: row s in record s modulo kRingRecords.
inline constexpr int kFirstRecord = 32768, kRecordWidth = 16, kRingRecords = 2048;
enum Record {
  kSequence = 0,  ///< uint32
  kSeconds = 2,   ///< uint32, s since 1970
  kMilliseconds = 4,
  kAlarmNumber = 5,  ///< 0: the axis as a whole
  kRecordAxis = 6,   ///< 0: none of these axes
  kEvent = 7,
  kRecordState = 8,
  kRecordSeverity = 9,
  kStroke = 10,       ///< uint32
  kRecordValue = 12,  ///< float32, SI
  kRecordLimit = 14,  ///< float32, SI
};

/// Codes are places in these lists; those of health are the numbers of HealthState.
inline constexpr std::array<std::string_view, 9> kStateCodes = {"NORM",  "UNACK", "ACKED", "RTNUN", "LTUNK",
                                                                "LTACK", "SHLVD", "DSUPR", "OOSRV"};
/// Any other event is 0.
inline constexpr std::array<std::string_view, 14> kEventCodes = {
    "other",     "raised",     "cleared",           "acknowledged",   "shelved",
    "unshelved", "suppressed", "unsuppressed",      "out_of_service", "in_service",
    "reset",     "escalated",  "reference_learned", "explained"};

static_assert(kFirstHealth + kMostAxes * kHealthStride <= kFirstCause);
static_assert(kFirstAxis + kMostAxes * kAxisStride <= kFirstAlarm);
static_assert(kFirstCause + kMostAlarms <= kFirstAxis);
static_assert(kFirstParameter + kMostParameters * kParameterStride <= kAxisStride);
static_assert(kFirstAlarm + kMostAlarms * kAlarmStride <= kFirstRecord);
static_assert(kFirstRecord + kRingRecords * kRecordWidth <= kRegisters);

}  // namespace hydroscope::register_map
