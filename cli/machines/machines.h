#pragma once

namespace CLI {
class App;
}

namespace hydroscope {

/// `simulate press` and `simulate valve`.
void AddSimulatePress(CLI::App& simulate, int& exit_code);
void AddSimulateValve(CLI::App& simulate, int& exit_code);

/// The other simulated machines. Each lives in cli/machines/<name>.cc and adds `simulate <name>`, a log
/// whose truth is known, and `benchmark <name>`, our figures beside published ones: one line here.
#define HYDROSCOPE_SIMULATED_MACHINES(_) \
  _(TestCylinder)                        \
  _(Manipulator)                         \
  _(FlexibleAxis)                        \
  _(Pump)

#define HYDROSCOPE_DECLARE_MACHINE(Name)                      \
  void AddSimulate##Name(CLI::App& simulate, int& exit_code); \
  void AddBenchmark##Name(CLI::App& benchmark, int& exit_code);
HYDROSCOPE_SIMULATED_MACHINES(HYDROSCOPE_DECLARE_MACHINE)
#undef HYDROSCOPE_DECLARE_MACHINE

}  // namespace hydroscope
