#include "models/live_spec.h"

#include <algorithm>

#include "models/machine.h"

namespace hydroscope {
namespace {

/// Name of the axis; "" if the machine has no named axes.
std::string AxisName(const Machine& machine, int axis) {
  if (!machine.live || machine.live->axes.empty()) return "";
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

std::string DdsChannelName(const Machine& machine, int signal, int axis) {
  static const std::string place = "{axis}";
  std::string name = machine.signals[static_cast<std::size_t>(signal)].dds;
  const std::string axis_name = AxisName(machine, axis);
  for (std::size_t at = name.find(place); at != std::string::npos;
       at = name.find(place, at + axis_name.size()))
    name.replace(at, place.size(), axis_name);
  return name;
}

}  // namespace hydroscope
