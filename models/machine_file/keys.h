#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hydroscope {

/// One section of a machine file and the keys it may hold.
struct MachineSection {
  std::string name;  ///< "log", "signals.<name>", "monitor.<parameter>", ...
  std::vector<std::string> keys;
};

/// Every section and key a machine file may hold; what is not here is refused by ParseMachine, and everything
/// here is described in docs/machine_file.md (a test compares).
const std::vector<MachineSection>& MachineFileSections();

/// Keys of the section `name`, empty if there is no such section.
const std::vector<std::string>& MachineFileKeys(std::string_view name);

}  // namespace hydroscope
