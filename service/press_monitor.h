#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "service/axis_monitor.h"

namespace hydroscope {

/// All axes of one machine file, judged side by side, and the rules about several axes at once: what all
/// cylinders show together is told once, as an alarm of the press itself ("press" beside "press/cushion_1"),
/// and suppresses those of its axes. One object belongs to one thread.
class PressMonitor {
 public:
  /// `machine`: as the file has it, with all axes. Opens database and journal for itself. Errors: rules file,
  /// database, journal.
  static Result<std::unique_ptr<PressMonitor>> Create(const std::string& machine_file, const Machine& machine,
                                                      const std::string& database);

  /// AxisMonitor::CatchUp of every axis, then the rules about several axes. Errors: database or journal.
  Status CatchUp(double wall);
  /// Ends shelves whose time is over.
  Status Tick(double wall);

  int axis_count() const { return static_cast<int>(axes_.size()); }
  AxisMonitor& axis(int index) { return *axes_[static_cast<std::size_t>(index)]; }
  const AxisMonitor& axis(int index) const { return *axes_[static_cast<std::size_t>(index)]; }
  const drift::RuleBook& rules() const { return rules_; }
  /// Alarms of the press itself.
  const std::vector<AlarmState>& alarms() const { return alarms_; }
  const std::string& name() const { return name_; }

 private:
  struct Member {
    int axis = 0;
    std::int64_t since = 0;
    std::string alarm;
  };
  PressMonitor(std::string name, drift::RuleBook rules, Database database, AlarmJournal journal)
      : name_(std::move(name)),
        rules_(std::move(rules)),
        database_(std::move(database)),
        journal_(std::move(journal)) {}
  std::vector<Member> Together(const drift::Rule& rule) const;
  Status JudgeTogether(double wall);
  Status TellPress(const drift::Rule& rule, const std::vector<Member>& members, double wall);

  std::string name_;
  drift::RuleBook rules_;
  Database database_;
  AlarmJournal journal_;
  std::vector<Machine> machines_;  ///< one per axis, named as in the database
  std::vector<std::unique_ptr<AxisMonitor>> axes_;
  std::vector<AlarmState> alarms_;
};

}  // namespace hydroscope
