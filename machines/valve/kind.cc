#include "machines/valve/kind.h"

namespace hydroscope {
namespace {

MachineWords ValveWords(const Machine&) {
  return {"response", "sweep", "frequency and amplitude of the command", "", true};
}

}  // namespace

const MachineKind kValve = {.id = "valve",
                            .signals = {},
                            .geometry = {},
                            .parameters = {},
                            .output_unit = "m3/s",
                            .own_library = false,
                            .words = ValveWords,
                            .build = nullptr,
                            .effects = nullptr};

}  // namespace hydroscope
