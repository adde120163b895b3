#include "machines/own_states/kind.h"

namespace hydroscope {
namespace {

MachineWords StatesWords(const Machine& machine) {
  std::string output;
  for (const OutputSpec& o : machine.states.outputs) output += (output.empty() ? "" : ", ") + o.signal;
  return {.output = output, .stroke = {"episode", "Episode"}, .vary = {"the inputs", "die Eingänge"}};
}

}  // namespace

const MachineKind kOwnStates = {.id = "states",
                                .title = {"machine with states of its own", "Maschine mit eigenen Zuständen"},
                                .has_states = true,
                                .words = StatesWords};

}  // namespace hydroscope
