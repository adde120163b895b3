#include "alarms/feeds/modbus/tags.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "alarms/alarm_machine.h"
#include "alarms/feeds/modbus/register_image.h"
#include "alarms/feeds/modbus/register_map.h"
#include "core/registers.h"

namespace hydroscope {
namespace {

using namespace register_map;

enum class Cell { kU16, kU32, kFloat, kText16, kText32 };
constexpr std::array<const char*, 5> kCellNames = {"u16", "u32", "float32", "text, 16 characters",
                                                   "text, 32 characters"};
constexpr std::array<std::size_t, 5> kCellRegisters = {1, 2, 2, 8, 16};

/// What stands at an offset of a part of the map.
struct Place {
  int offset;
  Cell cell;
  const char* name;  ///< in words of machines that count strokes, as `meaning`
  const char* unit;
  const char* meaning;
  bool of_service = false;  ///< says something only while a service serves it
};

constexpr Place kHeadPlaces[] = {
    {kMagic, Cell::kU32, "mark of the map", "", "1213809746, the letters HYDR; 0: nothing is current yet"},
    {kMapVersion, Cell::kU16, "map version", "", ""},
    {kHeartbeat, Cell::kU16, "heartbeat", "",
     "counts up some ten times a second; if it stands still for 2 s nothing is current", true},
    {kNewest, Cell::kU32, "newest journal row", "", "sequence number, 0: none", true},
    {kOldest, Cell::kU32, "oldest journal row", "", "sequence number in the ring", true},
    {register_map::kAxes, Cell::kU16, "axes", "", ""},
    {kAlarms, Cell::kU16, "alarms with a number", "", ""},
    {kStanding, Cell::kU16, "alarms not at rest", "", ""},
    {kUnacknowledged, Cell::kU16, "alarms not acknowledged", "", ""},
    {kClock, Cell::kU32, "time of this picture", "s", "since 1970", true},
    {kWaiting, Cell::kU16, "acknowledgements waiting", "", "not in the journal yet", true},
    {kTrouble, Cell::kU16, "trouble", "", "what keeps the service from storing or judging; 0 nothing", true},
    {kAcknowledge, Cell::kU16, "acknowledge", "",
     "write the number of an alarm; the only register that can be written", true},
    {kAcknowledgeOutcome, Cell::kU16, "outcome of acknowledging", "",
     "0 nothing asked, 1 asked, 2 acknowledged, 3 nothing to acknowledge, 4 not stored", true},
};
constexpr const char* kLayoutNames[] = {"first axis",
                                        "registers of an axis",
                                        "first parameter within an axis",
                                        "registers of a parameter",
                                        "first alarm",
                                        "registers of an alarm",
                                        "most alarms",
                                        "first record of the ring",
                                        "registers of a record",
                                        "records of the ring",
                                        "register to acknowledge"};
constexpr Place kAxisPlaces[] = {
    {kHealth, Cell::kU16, "health", "", "NE 107: 0 good, 1 M, 2 S, 3 C, 4 F"},
    {kParameters, Cell::kU16, "parameters", "", "that follow"},
    {kStrokeAge, Cell::kU16, "age of the last stroke", "s", "65535: longer, or none"},
    {kAxisStanding, Cell::kU16, "alarms not at rest", "", ""},
    {kStrokes, Cell::kU32, "strokes stored", "", ""},
    {kOilTemperature, Cell::kFloat, "oil temperature", "degC", "during the last stroke"},
    {kAxisName, Cell::kText16, "name", "", ""},
};
constexpr Place kHealthPlaces[] = {
    {kReason, Cell::kU16, "reason of health", "", "docs/register_map.md"},
    {kLearned, Cell::kU16, "strokes learned", "", "while learning"},
    {kNeeded, Cell::kU16, "strokes needed", "", "while learning"},
};
constexpr Place kAlarmPlaces[] = {
    {kFlags, Cell::kU16, "flags", "",
     "1 active, 2 acknowledged, 4 latched, 8 shelved, 16 suppressed, 32 out of service"},
    {kState, Cell::kU16, "state", "",
     "0 NORM, 1 UNACK, 2 ACKED, 3 RTNUN, 4 LTUNK, 5 LTACK, 6 SHLVD, 7 DSUPR, 8 OOSRV"},
    {kSeverity, Cell::kU16, "severity", "", "0 advisory, 1 warning, 2 alarm, 3 loss of signal"},
    {kAlarmAxis, Cell::kU16, "axis", "", "from 1"},
    {kRaised, Cell::kU32, "raised", "s", "since 1970"},
    {kRaisedStroke, Cell::kU32, "raised at stroke", "", ""},
    {kAlarmValue, Cell::kFloat, "value", nullptr, ""},
    {kAlarmStd, Cell::kFloat, "standard deviation", nullptr, ""},
    {kAlarmLimit, Cell::kFloat, "limit", nullptr, ""},
    {kAlarmSequence, Cell::kU32, "newest journal row", "", "about it", true},
    {kAlarmName, Cell::kText32, "id", "", ""},
};
constexpr Place kCausePlaces[] = {
    {0, Cell::kU16, "cause", "", "0 not sought, 1 named, 2 one of several, 3 not known, 4 not proven"}};
constexpr Place kRecordPlaces[] = {
    {kSequence, Cell::kU32, "sequence number", "", "row s stands in record s modulo 2048, 16 registers each",
     true},
    {kSeconds, Cell::kU32, "time", "s", "since 1970", true},
    {kMilliseconds, Cell::kU16, "milliseconds", "ms", "", true},
    {kAlarmNumber, Cell::kU16, "alarm", "", "its number; 0: the axis as a whole", true},
    {kRecordAxis, Cell::kU16, "axis", "", "from 1", true},
    {kEvent, Cell::kU16, "event", "", "docs/register_map.md", true},
    {kRecordState, Cell::kU16, "state", "", "as that of an alarm", true},
    {kRecordSeverity, Cell::kU16, "severity", "", "as that of an alarm", true},
    {kStroke, Cell::kU32, "stroke", "", "", true},
    {kRecordValue, Cell::kFloat, "value", "", "SI", true},
    {kRecordLimit, Cell::kFloat, "limit", "", "SI", true},
};

std::string ValueAt(std::span<const std::uint16_t> all, int at, Cell cell) {
  const auto registers = all.subspan(static_cast<std::size_t>(at));
  if (cell == Cell::kU16) return std::to_string(registers[0]);
  if (cell == Cell::kU32) return std::to_string(DecodeUnsigned(registers.first(2)));
  if (cell == Cell::kFloat) {
    const double value = DecodeRegisters(registers, RegisterType::kFloat32, WordOrder::kAbcd);
    return std::isfinite(value) ? fmt::format("{:.6g}", value) : "";
  }
  std::string text;
  for (std::size_t k = 0; k < kCellRegisters[static_cast<std::size_t>(cell)]; ++k)
    for (const int character : {registers[k] >> 8, registers[k] & 0xff})
      if (character != 0) text += static_cast<char>(character);
  return text;
}

/// Lists places of one picture after the other.
class TagList {
 public:
  TagList(const RegisterImage& image, const CountedWords& counted) : image_(image), counted_(counted) {}

  /// `si`: unit of places whose unit is that of a quantity.
  void Add(std::span<const Place> places, int first, const std::string& axis, const std::string& of,
           const std::string& si = "") {
    for (const Place& place : places)
      tags_.push_back(
          {"modbus", axis, std::to_string(first + place.offset),
           of.empty() ? Counted(place.name) : of + ", " + Counted(place.name),
           kCellNames[static_cast<std::size_t>(place.cell)], place.unit == nullptr ? si : place.unit,
           Counted(place.meaning),
           place.of_service ? "" : ValueAt(image_.registers(), first + place.offset, place.cell)});
  }
  /// In order of the registers.
  std::vector<Tag> Take() {
    std::ranges::sort(tags_, {}, [](const Tag& tag) { return std::stoi(tag.address); });
    return std::move(tags_);
  }

 private:
  /// The words with what the machine counts in place of strokes.
  std::string Counted(std::string words) const {
    constexpr std::string_view kStroke = CountedWords{}.one;
    for (std::size_t at = 0; (at = words.find(kStroke, at)) != std::string::npos; at += counted_.one.size())
      words.replace(at, kStroke.size(), counted_.one);
    return words;
  }

  const RegisterImage& image_;
  const CountedWords counted_;
  std::vector<Tag> tags_;
};

}  // namespace

std::vector<Tag> ModbusTags(const std::vector<AxisPicture>& axes,
                            const std::vector<std::pair<std::string, std::string>>& alarms_by_appearance,
                            double wall, const CountedWords& counted) {
  AlarmNumbers numbers;
  for (const auto& [machine, alarm] : alarms_by_appearance) numbers.Add(machine, alarm);
  RegisterImage image;
  RegisterImage::Counts counts;
  counts.axes = static_cast<int>(axes.size());
  counts.alarms = std::min(numbers.size(), kMostAlarms);
  for (std::size_t a = 0; a < axes.size(); ++a) {
    image.ShowAxis(static_cast<int>(a) + 1, axes[a], wall);
    for (const AlarmState& alarm : axes[a].alarms) {
      image.ShowAlarm(numbers.NumberOf(axes[a].machine, alarm.id), static_cast<int>(a) + 1, alarm, 0);
      counts.standing += AtRest(alarm) ? 0 : 1;
      counts.unacknowledged += alarm.acknowledged ? 0 : 1;
    }
  }
  image.ShowHead(counts, wall);
  TagList list(image, counted);
  list.Add(kHeadPlaces, 0, "", "");
  int layout = kLayout;
  for (const char* name : kLayoutNames) {
    const Place place[] = {{layout++, Cell::kU16, name, "", ""}};
    list.Add(place, 0, "", "layout");
  }
  for (std::size_t a = 0; a < axes.size() && a < kMostAxes; ++a) {
    const int first = kFirstAxis + static_cast<int>(a) * kAxisStride;
    list.Add(kAxisPlaces, first, axes[a].machine, "");
    list.Add(kHealthPlaces, kFirstHealth + static_cast<int>(a) * kHealthStride, axes[a].machine, "");
    for (std::size_t p = 0; p < axes[a].estimates.size() && p < kMostParameters; ++p) {
      const Estimate& estimate = axes[a].estimates[p].estimate;
      const Place places[] = {
          {kValue, Cell::kFloat, "value", nullptr, "after the last stroke"},
          {kStd, Cell::kFloat, "standard deviation", nullptr, "value +- 1.96 of it is the 95 % interval"},
          {kQuality, Cell::kU16, "quality", "",
           "0 identified in the last stroke, 4 not to be told from others, else older; 255 never"},
          {kEstimateAge, Cell::kU16, "age", "s", "since the data told something about it"},
          {kEstimateOil, Cell::kFloat, "oil temperature", "degC", "that the value stands for"},
          {kParameterName, Cell::kText16, "name", "", ""}};
      list.Add(places, first + kFirstParameter + static_cast<int>(p) * kParameterStride, axes[a].machine,
               estimate.parameter, estimate.unit);
    }
  }
  for (std::size_t a = 0; a < axes.size(); ++a)
    for (const AlarmState& alarm : axes[a].alarms) {
      const int number = numbers.NumberOf(axes[a].machine, alarm.id);
      if (number < 1 || number > kMostAlarms) continue;
      const std::string of = fmt::format("alarm {} {}", number, alarm.id);
      list.Add(kAlarmPlaces, kFirstAlarm + (number - 1) * kAlarmStride, axes[a].machine, of, alarm.unit);
      list.Add(kCausePlaces, kFirstCause + number - 1, axes[a].machine, of);
    }
  list.Add(kRecordPlaces, kFirstRecord, "", "record 0 of the ring");
  return list.Take();
}

std::optional<std::string> ServedValue(const std::vector<ServedRegisters>& served, int address,
                                       const std::string& type) {
  const auto cell = std::find(kCellNames.begin(), kCellNames.end(), type) - kCellNames.begin();
  if (cell == std::ssize(kCellNames)) return std::nullopt;
  for (const auto& [first, values] : served)
    if (address >= first &&
        static_cast<std::size_t>(address - first) + kCellRegisters[static_cast<std::size_t>(cell)] <=
            values.size())
      return ValueAt(values, address - first, static_cast<Cell>(cell));
  return std::nullopt;
}

}  // namespace hydroscope
