#include "models/live_spec.h"

#include <algorithm>
#include <string_view>

#include "models/machine.h"

namespace hydroscope {

bool HasNamedAxes(const Machine& machine) { return machine.live && !machine.live->axes.empty(); }

namespace {

constexpr std::string_view kAxisPlace = "{axis}";

/// Name of the axis; "" if the machine has no named axes.
std::string AxisName(const Machine& machine, int axis) {
  if (!HasNamedAxes(machine)) return "";
  return machine.live->axes[static_cast<std::size_t>(axis)];
}

}  // namespace

int AxisCount(const Machine& machine) {
  return machine.live ? std::max(1, static_cast<int>(machine.live->axes.size())) : 1;
}

std::string AxisMachineName(const Machine& machine, int axis) {
  const std::string name = AxisName(machine, axis);
  return name.empty() ? machine.name : machine.name + "/" + name;
}

std::vector<LiveChannel> LiveChannels(const Machine& machine) {
  std::vector<LiveChannel> channels;
  for (int axis = 0; axis < AxisCount(machine); ++axis) {
    const std::string name = AxisName(machine, axis);
    for (int signal = 0; signal < static_cast<int>(machine.signals.size()); ++signal) {
      const std::string& own = machine.signals[static_cast<std::size_t>(signal)].name;
      channels.push_back({name.empty() ? own : name + "/" + own, axis, signal});
    }
  }
  return channels;
}

std::string WithAxis(std::string text, const Machine& machine, int axis) {
  const std::string name = AxisName(machine, axis);
  for (std::size_t at = text.find(kAxisPlace); at != std::string::npos;
       at = text.find(kAxisPlace, at + name.size()))
    text.replace(at, kAxisPlace.size(), name);
  return text;
}

Machine MachineOfAxis(const Machine& machine, int axis) {
  Machine own = machine;
  own.name = AxisMachineName(machine, axis);
  if (HasNamedAxes(machine))
    for (SignalSpec& signal : own.signals) signal.column = WithAxis(signal.column, machine, axis);
  return own;
}

std::vector<Machine> MachinesOfAxes(const Machine& machine) {
  std::vector<Machine> axes;
  for (int axis = 0; axis < AxisCount(machine); ++axis) axes.push_back(MachineOfAxis(machine, axis));
  return axes;
}

bool LogHoldsAllAxes(const Machine& machine) {
  return std::any_of(machine.signals.begin(), machine.signals.end(), [](const SignalSpec& signal) {
    return signal.column.find(kAxisPlace) != std::string::npos;
  });
}

}  // namespace hydroscope
