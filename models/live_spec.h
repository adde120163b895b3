#pragma once

#include <string>
#include <vector>

#include "models/part_settings.h"

namespace hydroscope {

struct Machine;

/// The [live] part of a machine file: one press with axes of the same physics.
struct LiveSpec {
  double grid_period = 1e-3;      ///< s, grid onto which all channels are aligned
  std::vector<std::string> axes;  ///< "cushion_1", ...; empty: the machine is its only axis
  PartsSpec sources;              ///< [live.<source>] of each

  bool operator==(const LiveSpec&) const = default;
};

/// One channel of a live machine: a signal of an axis. A signal that all axes share is a channel of every axis.
struct LiveChannel {
  std::string name;  ///< "cushion_1/p_A"; "p_A" if the machine has no named axes
  int axis = 0;      ///< index in LiveSpec::axes
  int signal = 0;    ///< index in Machine::signals
};

/// Whether the machine is a press whose axes have names.
bool HasNamedAxes(const Machine& machine);
/// Number of axes, at least 1.
int AxisCount(const Machine& machine);
/// "press/cushion_1"; the machine's name if it has no named axes.
std::string AxisMachineName(const Machine& machine, int axis);
/// The machine as the database has one axis of it: under the axis's name, and with columns of its own in a
/// log of all axes ("{axis}" replaced). The machine itself if it has no named axes.
Machine MachineOfAxis(const Machine& machine, int axis);
/// One for each axis.
std::vector<Machine> MachinesOfAxes(const Machine& machine);
/// Whether a log holds all axes side by side: columns have "{axis}" in their names.
bool LogHoldsAllAxes(const Machine& machine);
/// All channels; the one of a signal of an axis has the index axis * signals + signal. Signals without a live
/// origin have a channel that stays silent.
std::vector<LiveChannel> LiveChannels(const Machine& machine);
/// The text with the axis's name in each place for it, "{axis}".
std::string WithAxis(std::string text, const Machine& machine, int axis);

}  // namespace hydroscope
