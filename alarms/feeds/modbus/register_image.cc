#include "alarms/feeds/modbus/register_image.h"

#include <algorithm>
#include <cmath>

#include "alarms/feeds/modbus/register_map.h"
#include "core/constants.h"
#include "core/registers.h"

namespace hydroscope {
namespace {

using namespace register_map;

/// Place in a list of codes; 0 if it is not there.
template <typename Codes, typename Value>
std::uint16_t CodeOf(const Codes& codes, const Value& value) {
  const auto found = std::ranges::find(codes, value);
  return found == codes.end() ? std::uint16_t{0} : static_cast<std::uint16_t>(found - codes.begin());
}

/// Whole seconds in 16 bits; 65535 for more and for what never was.
std::uint16_t Seconds16(double seconds) {
  return seconds >= 0 && seconds < 65535 ? static_cast<std::uint16_t>(seconds) : std::uint16_t{65535};
}

std::uint64_t WholeSeconds(double wall) { return wall > 0 ? static_cast<std::uint64_t>(wall) : 0; }

std::uint16_t QualityOf(const Estimate& estimate) {
  if (!std::isfinite(estimate.last_excited)) return kNeverIdentified;
  return static_cast<std::uint16_t>(estimate.reason);
}

std::uint16_t FlagsOf(const AlarmState& a) {
  return static_cast<std::uint16_t>((a.active ? kActive : 0) | (a.acknowledged ? kIsAcknowledged : 0) |
                                    (a.latched ? kLatched : 0) | (a.shelved_until ? kShelved : 0) |
                                    (a.suppressed != 0 ? kSuppressed : 0) |
                                    (a.out_of_service ? kOutOfService : 0));
}

}  // namespace

void AlarmNumbers::Add(const std::string& machine, const std::string& alarm) {
  if (numbers_.try_emplace({machine, alarm}, size() + 1).second) alarms_.emplace_back(machine, alarm);
}

int AlarmNumbers::NumberOf(const std::string& machine, const std::string& alarm) const {
  const auto found = numbers_.find({machine, alarm});
  return found == numbers_.end() ? 0 : found->second;
}

RegisterImage::RegisterImage() : registers_(kRegisters, 0) {}

void RegisterImage::Put32(int first, std::uint64_t value) {
  EncodeUnsigned(value & 0xffffffff, At(first, 2));
}

void RegisterImage::PutFloat(int first, double value) {
  EncodeRegisters(value, RegisterType::kFloat32, WordOrder::kAbcd, At(first, 2));
}

void RegisterImage::PutText(int first, int count, const std::string& text) {
  const auto character = [&](std::size_t i) {
    return static_cast<std::uint16_t>(i < text.size() ? static_cast<unsigned char>(text[i]) : 0);
  };
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    registers_[static_cast<std::size_t>(first) + i] =
        static_cast<std::uint16_t>(character(2 * i) << 8 | character(2 * i + 1));
}

void RegisterImage::ShowHealth(int axis, const Health& health) {
  const auto strokes = [](std::int64_t count) {
    return static_cast<std::uint16_t>(std::clamp<std::int64_t>(count, 0, 65535));
  };
  const int detail = kFirstHealth + (axis - 1) * kHealthStride;
  registers_[kFirstAxis + (axis - 1) * kAxisStride + kHealth] = static_cast<std::uint16_t>(health.state);
  registers_[detail + kReason] = static_cast<std::uint16_t>(health.reason);
  registers_[detail + kLearned] = strokes(health.learned);
  registers_[detail + kNeeded] = strokes(health.needed);
}

void RegisterImage::ShowAxis(int axis, const AxisPicture& picture, double now) {
  if (axis < 1 || axis > kMostAxes) return;
  const int first = kFirstAxis + (axis - 1) * kAxisStride;
  const auto shown = std::min<std::size_t>(picture.estimates.size(), kMostParameters);
  const bool stroke = !picture.estimates.empty();
  ShowHealth(axis, picture.health);
  registers_[first + kParameters] = static_cast<std::uint16_t>(shown);
  registers_[first + kStrokeAge] = stroke ? Seconds16(now - picture.estimates[0].time) : std::uint16_t{65535};
  registers_[first + kAxisStanding] = static_cast<std::uint16_t>(std::ranges::count_if(
      picture.alarms, [](const AlarmState& a) { return StateName(a) != kStateCodes[0]; }));
  Put32(first + kStrokes, static_cast<std::uint64_t>(picture.strokes));
  PutFloat(first + kOilTemperature,
           stroke ? picture.estimates[0].oil_temperature - kZeroCelsius : std::nan(""));
  PutText(first + kAxisName, 8, picture.name);
  for (std::size_t p = 0; p < shown; ++p) {
    const Estimate& estimate = picture.estimates[p].estimate;
    const int place = first + kFirstParameter + static_cast<int>(p) * kParameterStride;
    PutFloat(place + kValue, estimate.value);
    PutFloat(place + kStd, estimate.std);
    registers_[place + kQuality] = QualityOf(estimate);
    registers_[place + kEstimateAge] = Seconds16(now - estimate.last_excited);
    PutFloat(place + kEstimateOil, estimate.oil_temperature - kZeroCelsius);
    PutText(place + kParameterName, 8, estimate.parameter);
  }
}

void RegisterImage::ShowAlarm(int number, int axis, const AlarmState& alarm, std::int64_t sequence) {
  if (number < 1 || number > kMostAlarms) return;
  const int first = kFirstAlarm + (number - 1) * kAlarmStride;
  registers_[first + kFlags] = FlagsOf(alarm);
  registers_[first + kState] = CodeOf(kStateCodes, std::string_view(StateName(alarm)));
  registers_[first + kSeverity] = static_cast<std::uint16_t>(alarm.severity);
  registers_[first + kAlarmAxis] = static_cast<std::uint16_t>(axis);
  Put32(first + kRaised, WholeSeconds(alarm.raised_wall));
  Put32(first + kRaisedStroke, static_cast<std::uint64_t>(alarm.raised_stroke));
  PutFloat(first + kAlarmValue, alarm.value);
  PutFloat(first + kAlarmStd, alarm.std);
  PutFloat(first + kAlarmLimit, alarm.limit);
  Put32(first + kAlarmSequence, static_cast<std::uint64_t>(sequence));
  PutText(first + kAlarmName, 16, alarm.id);
  registers_[kFirstCause + number - 1] = static_cast<std::uint16_t>(alarm.cause.kind);
}

void RegisterImage::ShowRow(const JournalRow& row, int number, int axis) {
  const int first = kFirstRecord + static_cast<int>(row.sequence % kRingRecords) * kRecordWidth;
  const AlarmEvent& event = row.event;
  Put32(first + kSequence, static_cast<std::uint64_t>(row.sequence));
  Put32(first + kSeconds, WholeSeconds(row.wall));
  registers_[first + kMilliseconds] = static_cast<std::uint16_t>((row.wall - std::floor(row.wall)) * 1000);
  registers_[first + kAlarmNumber] = static_cast<std::uint16_t>(number);
  registers_[first + kRecordAxis] = static_cast<std::uint16_t>(axis);
  registers_[first + kEvent] = CodeOf(kEventCodes, std::string_view(event.event));
  registers_[first + kRecordState] = CodeOf(kStateCodes, std::string_view(event.state));
  registers_[first + kRecordSeverity] = static_cast<std::uint16_t>(event.severity);
  Put32(first + kStroke, static_cast<std::uint64_t>(event.stroke));
  PutFloat(first + kRecordValue, event.value);
  PutFloat(first + kRecordLimit, event.limit);
  newest_ = row.sequence;
  rows_ = std::min<std::int64_t>(rows_ + 1, kRingRecords);
}

void RegisterImage::ShowHead(const Counts& counts, double wall) {
  registers_[kMagic] = kMagic0;
  registers_[kMagic + 1] = kMagic1;
  registers_[kMapVersion] = kVersion;
  ++registers_[kHeartbeat];
  Put32(kNewest, static_cast<std::uint64_t>(newest_));
  Put32(kOldest, static_cast<std::uint64_t>(rows_ == 0 ? 0 : newest_ - rows_ + 1));
  registers_[kAxes] = static_cast<std::uint16_t>(std::min(counts.axes, kMostAxes));
  registers_[kAlarms] = static_cast<std::uint16_t>(std::min(counts.alarms, 65535));
  registers_[kStanding] = static_cast<std::uint16_t>(counts.standing);
  registers_[kUnacknowledged] = static_cast<std::uint16_t>(counts.unacknowledged);
  Put32(kClock, WholeSeconds(wall));
  registers_[kWaiting] = static_cast<std::uint16_t>(counts.waiting);
  registers_[kTrouble] = static_cast<std::uint16_t>(counts.trouble);
  constexpr std::array<std::uint16_t, 11> kParts = {
      kFirstAxis,  kAxisStride,  kFirstParameter, kParameterStride, kFirstAlarm, kAlarmStride,
      kMostAlarms, kFirstRecord, kRecordWidth,    kRingRecords,     kAcknowledge};
  std::ranges::copy(kParts, registers_.begin() + kLayout);
}

void RegisterImage::ShowAcknowledge(std::uint16_t number, std::uint16_t outcome) {
  registers_[kAcknowledge] = number;
  registers_[kAcknowledgeOutcome] = outcome;
}

std::vector<ServedRegisters> RegisterImage::Filled() const {
  std::vector<ServedRegisters> parts;
  const auto add = [&](int first, int count) {
    parts.push_back({first, {registers_.begin() + first, registers_.begin() + first + count}});
  };
  add(0, kAcknowledgeOutcome + 1);
  const int axes = registers_[kAxes], alarms = std::min<int>(registers_[kAlarms], kMostAlarms);
  add(kFirstHealth, axes * kHealthStride);
  for (int a = 0; a < axes; ++a) {
    const int first = kFirstAxis + a * kAxisStride;
    add(first, kFirstParameter + registers_[first + kParameters] * kParameterStride);
  }
  add(kFirstCause, alarms);
  add(kFirstAlarm, alarms * kAlarmStride);
  add(kFirstRecord, kRecordWidth);
  return parts;
}

}  // namespace hydroscope
