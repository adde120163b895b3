#pragma once

#include <string>

namespace hydroscope {

/// What physics asks of two pressures of a machine, by which their columns are told from one another. By default: `lower` stands
/// above `higher` for moments at most.
struct PressureRule {
  std::string lower, higher;
  /// A signal, SI, of which more than `open` drives oil out of chamber `higher`, and less than -`open` into it: then `higher` is the
  /// chamber whose pressure rises as its oil leaves, being pressed out, and `lower` need not move. "": none.
  std::string driven_by = {};
  double open = 0;
};

}  // namespace hydroscope
