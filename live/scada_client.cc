#include "live/scada_client.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <span>
#include <thread>

#include "alarms/feeds/modbus/register_map.h"
#include "core/records/alarm_records.h"
#include "core/registers.h"
#include "core/told_error.h"

namespace hydroscope {
namespace {

using namespace register_map;
using Registers = std::span<const std::uint16_t>;

constexpr int kMostRead = 125;
constexpr double kTimeout = 2;          // s
constexpr double kOutcomePatience = 5;  // s

Registers Part(Registers words, int first, int count) {
  return words.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
}
std::int64_t Whole(Registers words, int at) {
  return static_cast<std::int64_t>(DecodeUnsigned(Part(words, at, 2)));
}
double Float(Registers words, int at) {
  return DecodeRegisters(Part(words, at, 2), RegisterType::kFloat32, WordOrder::kAbcd);
}
std::string Text(Registers words, int at, int registers) {
  std::string text;
  for (const std::uint16_t word : Part(words, at, registers))
    for (const int c : {word >> 8, word & 0xff})
      if (c != 0) text += static_cast<char>(c);
  return text;
}
template <typename Codes>
auto Coded(const Codes& codes, std::uint16_t code) {
  return codes[code < codes.size() ? code : 0];
}

/// A code this program does not know counts as nothing known.
Health HealthOf(std::uint16_t state, Registers detail) {
  Health health;
  if (state <= static_cast<std::uint16_t>(HealthState::kFailure))
    health.state = static_cast<HealthState>(state);
  if (detail[kReason] <= static_cast<std::uint16_t>(HealthReason::kNotWatched))
    health.reason = static_cast<HealthReason>(detail[kReason]);
  health.learned = detail[kLearned];
  health.needed = detail[kNeeded];
  health.text = HealthReasonName(health.reason);
  if (health.needed > 0) health.text += fmt::format(", {} of {} learned from", health.learned, health.needed);
  health.german.clear();  // registers carry no sentences
  return health;
}

ScadaRow RowOf(Registers record) {
  return {Whole(record, kSequence),
          static_cast<double>(Whole(record, kSeconds)) + record[kMilliseconds] * 1e-3,
          record[kAlarmNumber],
          record[kRecordAxis],
          std::string(Coded(kEventCodes, record[kEvent])),
          std::string(Coded(kStateCodes, record[kRecordState])),
          Whole(record, kStroke),
          Float(record, kRecordValue)};
}

}  // namespace

Result<ScadaClient> ScadaClient::Connect(const std::string& host, int port) {
  ScadaClient client(std::make_unique<ModbusLink>(host, port, 1, kTimeout));
  if (client.link_->Connect() != LinkOutcome::kDone)
    return BadInput("{}; does `hydroscope serve` run with [feeds.modbus] in its machine file?",
                    client.link_->problem().english);
  const auto head = TRY(client.Read(0, kHeadSize));
  if (head[kMagic] != kMagic0 || head[kMagic + 1] != kMagic1)
    return BadInput("{}:{} answers, but not with Hydroscope's register map", host, port);
  if (head[kMapVersion] != kVersion)
    return BadInput("{}:{} has version {} of the register map, this program knows version {}", host, port,
                    head[kMapVersion], kVersion);
  return client;
}

Result<ScadaClient::Words> ScadaClient::Read(int first, int count) {
  Words words(static_cast<std::size_t>(count));
  for (int at = 0; at < count; at += kMostRead) {
    const int now = std::min(kMostRead, count - at);
    if (link_->Read(first + at,
                    std::span(words).subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(now))) !=
        LinkOutcome::kDone)
      return BadInput(link_->problem());
  }
  return words;
}

Result<std::vector<ScadaAxis>> ScadaClient::Axes() {
  const auto head = TRY(Read(0, kHeadSize));
  std::vector<ScadaAxis> axes;
  for (int a = 0; a < head[kAxes]; ++a) {
    const auto words = TRY(Read(kFirstAxis + a * kAxisStride, kAxisStride));
    const auto detail = TRY(Read(kFirstHealth + a * kHealthStride, kHealthStride));
    ScadaAxis axis{Text(words, kAxisName, 8), HealthOf(words[kHealth], detail), words[kStrokeAge],
                   Whole(words, kStrokes),    Float(words, kOilTemperature),    {}};
    for (int p = 0; p < std::min<int>(words[kParameters], kMostParameters); ++p) {
      const int at = kFirstParameter + p * kParameterStride;
      axis.parameters.push_back({Text(words, at + kParameterName, 8), Float(words, at + kValue),
                                 Float(words, at + kStd), words[static_cast<std::size_t>(at + kQuality)]});
    }
    axes.push_back(std::move(axis));
  }
  return axes;
}

Result<std::vector<ScadaAlarm>> ScadaClient::Alarms() {
  const auto head = TRY(Read(0, kHeadSize));
  std::vector<ScadaAlarm> alarms;
  for (int number = 1; number <= std::min<int>(head[kAlarms], kMostAlarms); ++number) {
    const auto words = TRY(Read(kFirstAlarm + (number - 1) * kAlarmStride, kAlarmStride));
    const std::uint16_t state = words[kState];
    if (state == 0) continue;
    alarms.push_back(
        {number, words[kAlarmAxis], Text(words, kAlarmName, 16), std::string(Coded(kStateCodes, state)),
         SeverityName(static_cast<AlarmSeverity>(std::min<int>(words[kSeverity], 3))), Whole(words, kRaised),
         Float(words, kAlarmValue), Float(words, kAlarmStd), Float(words, kAlarmLimit)});
  }
  return alarms;
}

Result<std::vector<ScadaRow>> ScadaClient::NewRows() {
  const auto head = TRY(Read(0, kHeadSize));
  const std::int64_t newest = Whole(head, kNewest), oldest = Whole(head, kOldest);
  std::vector<ScadaRow> rows;
  if (newest == 0) return rows;
  if (next_ == 0) next_ = oldest;
  while (next_ <= newest) {
    const auto record = static_cast<int>(next_ % kRingRecords);
    const auto count = static_cast<int>(
        std::min<std::int64_t>({newest - next_ + 1, kRingRecords - record, kMostRead / kRecordWidth}));
    const auto words = TRY(Read(kFirstRecord + record * kRecordWidth, count * kRecordWidth));
    for (int k = 0; k < count; ++k, ++next_) {
      ScadaRow row = RowOf(Part(words, k * kRecordWidth, kRecordWidth));
      // A record that was overwritten meanwhile bears another number: never taken for the one expected.
      if (row.sequence == next_)
        rows.push_back(std::move(row));
      else
        ++missed_;
    }
  }
  return rows;
}

Result<bool> ScadaClient::Acknowledge(int number) {
  if (number < 1 || number > 65535) return UsageError("alarms have numbers from 1 to 65535, not {}", number);
  const LinkOutcome outcome = link_->WriteRegister(kAcknowledge, static_cast<std::uint16_t>(number));
  if (outcome == LinkOutcome::kException)
    return BadInput("alarm {} was refused ({}); the list shows the numbers there are", number,
                    link_->problem().english);
  if (outcome != LinkOutcome::kDone) return BadInput(link_->problem());
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kOutcomePatience);
  while (std::chrono::steady_clock::now() < end) {
    const auto words = TRY(Read(kAcknowledge, 2));
    switch (words[0] == number ? words[1] : std::uint16_t{kAsked}) {
      case kAcknowledged:
        return true;
      case kNothingToAcknowledge:
        return false;
      case kNotStored:
        return InternalError("the service could not store the acknowledgement; `hydroscope status` says why");
      default:
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  return InternalError("no outcome of the acknowledgement within {} s", kOutcomePatience);
}

}  // namespace hydroscope
