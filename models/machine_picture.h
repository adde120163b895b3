#pragma once

#include <string>
#include <vector>

namespace hydroscope {

struct Machine;

/// Where the name of a signal stands in the picture of its machine, and the place its line leads to: sensor or input.
struct SignalPlace {
  std::string signal;
  double x = 0, y = 0;        ///< middle of the name
  double to_x = 0, to_y = 0;  ///< where it is measured
};

/// Room that a name takes about the middle of its place.
inline constexpr double kNameHeight = 34;
double NameWidth(const std::string& signal);

/// A machine as it is drawn. Lengths are those of the drawing, x to the right and y down from its upper left corner.
struct MachinePicture {
  double width = 480, height = 270;
  /// SVG elements without colours; whoever shows them draws lines, and by class `body` (walls), `fill` (pistons, solids), `rod`,
  /// `pipe`, `thin`, `signal` (wires) and `sign` (letters).
  std::string drawing;
  std::vector<SignalPlace> places;
};

/// Any machine by its signals: what drives it on the left, what it gives on the right, its states inside.
MachinePicture PictureOfSignals(const Machine& machine);

}  // namespace hydroscope
