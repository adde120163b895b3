#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "monitor/axis_monitor.h"
#include "monitor/common_cause.h"

namespace hydroscope {

/// Axes of one press, judged side by side, and the rules about several axes at once: what all cylinders show
/// together is told once, as an alarm of the press itself ("press" beside "press/cushion_1"), and suppresses
/// those of its axes. Live service and replay judge by this object; it makes no difference whether the axes'
/// strokes come together or one axis after the other. One object belongs to one thread.
class PressMonitor {
 public:
  /// `axes`: the machines as the database names them (MachinesOfAxes, or fewer of them), `name` that of the
  /// press. Opens database and journal for itself. Errors: rules file, database, journal.
  static Result<std::unique_ptr<PressMonitor>> Create(const std::string& machine_file,
                                                      const std::string& name, std::vector<Machine> axes,
                                                      const std::string& database);

  /// AxisMonitor::watchable of every axis.
  Status watchable() const;
  /// AxisMonitor::CatchUp of every axis, then the rules about several axes; next to nothing is read while neither database
  /// nor journal has anything new. Errors: database or journal.
  Status CatchUp(double wall);
  /// Ends shelves whose time is over.
  Status Tick(double wall);

  int axis_count() const { return static_cast<int>(axes_.size()); }
  AxisMonitor& axis(int index) { return *axes_[index]; }
  const AxisMonitor& axis(int index) const { return *axes_[index]; }
  /// The axis of this name; nullptr if it is not among them.
  const AxisMonitor* Find(const std::string& machine) const;
  const drift::RuleBook& rules() const { return rules_; }
  /// Alarms of the press itself.
  const std::vector<AlarmState>& alarms() const { return alarms_; }
  const std::string& name() const { return name_; }
  struct Notice {
    const char* event;  ///< for logs
    std::string text;
  };
  /// Of the database, so far.
  std::int64_t PagesAsked() const { return database_.PagesAsked(); }
  /// What those who opened it should know: that a journal of another database was set aside, that rules and machine differ.
  const std::vector<Notice>& notices() const { return notices_; }

 private:
  struct Seen {
    StoredCounts stored;
    AlarmJournal::Version journal;
    bool operator==(const Seen&) const = default;
  };
  PressMonitor(std::string name, drift::RuleBook rules, std::vector<Machine> machines, Database database,
               AlarmJournal journal)
      : name_(std::move(name)),
        rules_(std::move(rules)),
        database_(std::move(database)),
        journal_(std::move(journal)),
        machines_(std::move(machines)) {}
  Status OpenAxes(const std::string& database);
  Status JudgeTogether(double wall);
  Status TellPress(const drift::Rule& rule, const std::vector<CommonCause>& causes, double wall);
  AlarmCondition ConditionOf(const drift::Rule& rule, const CommonCause& cause) const;

  std::string name_;
  std::vector<Notice> notices_;
  drift::RuleBook rules_;
  Database database_;
  AlarmJournal journal_;
  std::vector<Machine> machines_;  ///< one per axis, named as in the database
  std::vector<std::unique_ptr<AxisMonitor>> axes_;
  std::vector<AlarmState> alarms_;
  std::optional<Seen> caught_up_to_;
  /// By rule: strokes from and to of what stood together, as far as the journal tells it.
  std::map<std::string, std::vector<std::pair<std::int64_t, std::int64_t>>> told_;
};

}  // namespace hydroscope
