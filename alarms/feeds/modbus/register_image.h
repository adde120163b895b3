#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "alarms/feeds/feed.h"
#include "alarms/feeds/feed_reader.h"

namespace hydroscope {

/// Numbers of alarms for those who know no names: 1, 2, ... in the order in which the journal first speaks of
/// them. Since rows are only ever appended, a number never changes.
class AlarmNumbers {
 public:
  /// Gives the next number to an alarm that has none.
  void Add(const std::string& machine, const std::string& alarm);
  /// 0 if it has none.
  int NumberOf(const std::string& machine, const std::string& alarm) const;
  int size() const { return static_cast<int>(alarms_.size()); }
  /// Machine and alarm of a number from 1 to size().
  const std::pair<std::string, std::string>& operator[](int number) const { return alarms_[number - 1]; }

 private:
  std::vector<std::pair<std::string, std::string>> alarms_;
  std::map<std::pair<std::string, std::string>, int> numbers_;
};

/// The registers of docs/register_map.md, pure: what it shows is what it was told.
class RegisterImage {
 public:
  RegisterImage();

  /// `axis` from 1; 0 and beyond the last axis of the map are left out. `now`: s, as strokes count time.
  void ShowAxis(int axis, const AxisPicture& picture, double now);
  /// `number` from 1; beyond the last alarm of the map it is left out. `sequence`: newest row about it.
  void ShowAlarm(int number, int axis, const AlarmState& alarm, std::int64_t sequence);
  /// Rows in order of sequence.
  void ShowRow(const JournalRow& row, int number, int axis);
  struct Counts {
    int axes = 0, alarms = 0, standing = 0, unacknowledged = 0, waiting = 0;
    HealthReason trouble = HealthReason::kJudgedGood;
  };
  /// Completes the picture: counts up the heartbeat. `wall` in s since 1970.
  void ShowHead(const Counts& counts, double wall);
  void ShowAcknowledge(std::uint16_t number, std::uint16_t outcome);

  std::span<const std::uint16_t> registers() const { return registers_; }
  /// The head, what there is of axes and alarms, and the first record of the ring.
  std::vector<ServedRegisters> Filled() const;

 private:
  std::span<std::uint16_t> At(int first, int count) {
    return std::span(registers_).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
  }
  void ShowHealth(int axis, const Health& health);
  void Put32(int first, std::uint64_t value);
  void PutFloat(int first, double value);
  void PutText(int first, int registers, const std::string& text);

  std::vector<std::uint16_t> registers_;
  std::int64_t newest_ = 0, rows_ = 0;
};

}  // namespace hydroscope
