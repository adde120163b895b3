#pragma once

#include <optional>
#include <string>

#include "alarms/feeds/dds/alarm_listener.h"
#include "studies/alarms/campaign_broker.h"
#include "studies/live/live_rig.h"

namespace hydroscope {

/// What of a fault is looked for.
struct FaultSign {
  std::string alarm;  ///< its rows, "" = none
  std::string log;    ///< words of a line of the log
};

/// s after a fault began at which each place told it; nullopt: it did not.
struct Sighting {
  std::optional<double> log, status, registers, sparkplug, dds;

  bool everywhere() const { return log && status && registers && sparkplug && dds; }
  /// "log 1.1 s, status 0.2 s, registers 0.3 s, Sparkplug 0.4 s, DDS never".
  std::string Text() const;
};

/// The places where an operator may see a fault of an axis: the service's log, its status, the registers of its
/// Modbus feed, Sparkplug and DDS. A place tells a fault when health there is F, or when it has a row of its alarm.
class OperatorView {
 public:
  /// Lines of the machine file for the feeds that it looks at.
  static std::string Feeds(const std::string& broker, int domain, int port);

  OperatorView(const LiveRig& rig, const CampaignBroker& broker, const AlarmListener& dds, int port)
      : rig_(rig), broker_(broker), dds_(dds), port_(port) {}

  /// What was told before does not count from here on; a fault begins. Alarms that stand are acknowledged.
  void Mark();
  /// Looks until all places told it, for at most `patience` s.
  Sighting Watch(const FaultSign& sign, double patience) const;
  /// Until no place says F any more, s since then; nullopt: not within `patience`.
  std::optional<double> WaitForHealth(double patience) const;
  /// Whether the log has these words since Mark.
  bool Logged(const std::string& words) const;
  /// A register of the feed; nullopt if it does not answer.
  std::optional<std::uint16_t> Register(int number) const;

 private:
  void AcknowledgeAll() const;
  bool StatusTells(const FaultSign& sign) const;
  bool RegistersTell() const;
  bool SparkplugTells(const FaultSign& sign) const;
  bool DdsTells(const FaultSign& sign) const;

  const LiveRig& rig_;
  const CampaignBroker& broker_;
  const AlarmListener& dds_;
  int port_;
  double begun_ = 0;
  std::size_t logged_ = 0, told_ = 0, heard_ = 0;
  std::uint16_t unacknowledged_ = 0;
};

}  // namespace hydroscope
