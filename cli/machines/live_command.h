#pragma once

#include <string>

#include "core/result.h"
#include "simulator/die_cushion/press_server.h"

namespace hydroscope {

/// One line that tells a served press what to do; axes from 1, all if not given; times in s:
///   effect ID[=SIZE][,NAME=VALUE...] [axis=N] [ramp=S]
///   fault KIND:CHANNEL:IN:DURATION[:SIZE] [axis=N]     IN = s from now
///   pause | run | freeze | thaw | quit
///   dds mute|on
///   modbus hang|garbage|late=S|on
///   clock JUMP
Result<LiveCommand> ParseLiveCommand(const std::string& line);

/// The same as help for people.
std::string LiveCommandHelp();

}  // namespace hydroscope
