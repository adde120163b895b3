#pragma once

#include <map>
#include <string>
#include <vector>

#include "models/machine.h"

namespace hydroscope {

/// Remarks that a writer of machine files adds for the reader.
struct MachineNotes {
  std::vector<std::string> head;                            ///< comment lines at the top of the file
  std::map<std::string, std::string> signals;               ///< signal name -> comment behind its line
  std::map<std::string, std::vector<std::string>> section;  ///< section name -> comment lines at its end
  std::vector<std::string> tail;                            ///< comment lines at the end of the file
};

/// FormatMachine with `notes` as comments; without notes the comments are general ones.
std::string FormatMachine(const Machine& machine, const MachineNotes& notes);

}  // namespace hydroscope
