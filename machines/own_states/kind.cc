#include "machines/own_states/kind.h"

namespace hydroscope {
namespace {

MachineWords StatesWords(const Machine& machine) {
  std::string output;
  for (const OutputSpec& o : machine.states.outputs) output += (output.empty() ? "" : ", ") + o.signal;
  return {output, "episode", "the inputs", "", false};
}

}  // namespace

const MachineKind kOwnStates = {.id = "states",
                                .title = "machine with states of its own",
                                .signals = {},
                                .geometry = {},
                                .parameters = {},
                                .output_unit = "",
                                .has_states = true,
                                .words = StatesWords};

}  // namespace hydroscope
