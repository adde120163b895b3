#include "models/machine_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "models/expressions/check.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

constexpr double kLetter = 7.4;       ///< mean width of a letter of a name
constexpr double kNarrowest = 44;     ///< of a name
constexpr double kMargin = 10;        ///< about names
constexpr double kRow = 44;           ///< from name to name
constexpr double kBoxWidth = 150;     ///< of the machine
constexpr double kStateRow = 20;      ///< from state to state inside
constexpr double kLeastHeight = 130;  ///< of the picture

struct Sides {
  std::vector<std::string> inputs, outputs, states;
};

/// Signals that the expression reads.
std::set<std::string> ReadBy(const std::string& expression) {
  const auto tree = ParseExpression(expression);
  return tree ? NamesIn(**tree) : std::set<std::string>{};
}

Sides SidesOf(const Machine& machine) {
  const StatesSpec states = machine.states.states.empty() ? BuiltInStates(machine) : machine.states;
  std::set<std::string> given = ReadBy(machine.balance.output);
  for (const OutputSpec& output : states.outputs) given.insert(output.signal);
  if (KindOf(machine).build == nullptr && states.outputs.empty()) given.insert(machine.valve.output);
  Sides sides;
  for (const SignalSpec& signal : machine.signals)
    (given.contains(signal.name) ? sides.outputs : sides.inputs).push_back(signal.name);
  for (const StateSpec& state : states.states)
    if (machine.SignalIndex(state.name) < 0) sides.states.push_back(state.name);
  return sides;
}

double WidestOf(const std::vector<std::string>& names) {
  double widest = 0;
  for (const std::string& name : names) widest = std::max(widest, NameWidth(name));
  return widest;
}

/// Rows of names beside each other's middle.
double RowOf(std::size_t k, std::size_t count, double height) {
  return 0.5 * height + kRow * (static_cast<double>(k) - 0.5 * static_cast<double>(count - 1));
}

/// A wire to or from the box that ends in an arrow.
std::string Wire(double from, double to, double y) {
  return fmt::format("<path class=\"signal\" d=\"M{0:g} {2:g}H{1:g}m-6 -4l6 4l-6 4\"/>", from, to, y);
}

}  // namespace

double NameWidth(const std::string& signal) {
  return std::max(kNarrowest, kLetter * static_cast<double>(signal.size()) + 2 * kMargin);
}

MachinePicture PictureOfSignals(const Machine& machine) {
  const Sides sides = SidesOf(machine);
  const std::size_t rows = std::max({sides.inputs.size(), sides.outputs.size(), std::size_t{1}});
  MachinePicture picture;
  picture.height = std::max({kLeastHeight, kRow * static_cast<double>(rows) + kMargin,
                             kStateRow * static_cast<double>(sides.states.size() + 3)});
  const double left = WidestOf(sides.inputs), right = WidestOf(sides.outputs);
  const double box = left + 4 * kMargin, end = box + kBoxWidth;
  picture.width = end + 4 * kMargin + right;
  picture.drawing =
      fmt::format("<rect class=\"body\" x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\" rx=\"8\"/>", box,
                  kMargin, kBoxWidth, picture.height - 2 * kMargin);
  for (std::size_t k = 0; k < sides.inputs.size(); ++k) {
    const double y = RowOf(k, sides.inputs.size(), picture.height);
    picture.drawing += Wire(left + kMargin, box, y);
    picture.places.push_back({sides.inputs[k], kMargin + 0.5 * left, y, left + kMargin, y});
  }
  for (std::size_t k = 0; k < sides.outputs.size(); ++k) {
    const double y = RowOf(k, sides.outputs.size(), picture.height), edge = picture.width - kMargin - right;
    picture.drawing += Wire(end, edge, y);
    picture.places.push_back({sides.outputs[k], edge + 0.5 * right, y, end, y});
  }
  for (std::size_t k = 0; k < sides.states.size(); ++k)
    picture.drawing += fmt::format(
        "<text class=\"sign\" x=\"{:g}\" y=\"{:g}\">{}</text>", box + 0.5 * kBoxWidth,
        0.5 * picture.height +
            kStateRow * (static_cast<double>(k) - 0.5 * static_cast<double>(sides.states.size()) + 0.7),
        sides.states[k]);
  return picture;
}

}  // namespace hydroscope
