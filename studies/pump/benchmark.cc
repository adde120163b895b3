#include "studies/pump/benchmark.h"

#include <fmt/format.h>

#include "studies/pump/effects.h"
#include "studies/pump/identification.h"

namespace hydroscope {

int RunPumpBenchmark(const PumpBenchmarkOptions& options) {
  bool reached = PrintPumpIdentification(options);
  if (options.effects > 0) reached = PrintPumpEffects(options) && reached;
  fmt::print("{}\n", reached ? "all goals reached" : "NOT all goals reached");
  return reached ? 0 : 1;
}

}  // namespace hydroscope
