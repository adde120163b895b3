#pragma once

#include <string>

#include "core/result.h"
#include "models/machine.h"
#include "simulator/die_cushion/press_server.h"

namespace hydroscope {

/// What `simulate press --serve` says beyond the press itself.
struct ServedPress {
  std::string machine;         ///< machine file whose [live] tells where to serve
  int axes = 0;                ///< 0: those of the machine file
  double speed = 1;            ///< times real time
  double work = 0, pause = 0;  ///< s
  double clock_drift = 0;      ///< ppm
};

/// The server's settings: names, network and addresses of the machine file. Errors: no [live], or a ring that
/// the simulated press does not have.
Result<PressServer::Options> ServeOptions(const ServedPress& arguments, const PressOptions& press,
                                          const Machine& machine);

/// Serves until `press.seconds` are over, SIGINT, SIGTERM or the line "quit"; reads commands line by line
/// from stdin and answers each on stdout with "ok ..." or "error ...".
Status ServePress(const ServedPress& arguments, PressOptions press);

}  // namespace hydroscope
