#include "studies/manipulator/benchmark.h"

#include <fmt/format.h>

#include "studies/manipulator/identification.h"

namespace hydroscope {

int RunManipulatorBenchmark(const ManipulatorBenchmarkOptions& options) {
  bool reached = true;
  if (options.cases > 0) {
    reached = PrintIdentification(options);
    reached = PrintTracking(options) && reached;
    reached = PrintTrajectories(options) && reached;
  }
  if (options.effects > 0) reached = PrintManipulatorEffects(options) && reached;
  fmt::print("{}\n", reached ? "all goals reached" : "NOT all goals reached");
  return reached ? 0 : 1;
}

}  // namespace hydroscope
