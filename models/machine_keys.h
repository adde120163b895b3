#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hydroscope {

/// One section of a machine file and the keys it may hold.
struct MachineSection {
  std::string_view name;  ///< "log", "signals.<name>", "monitor.<parameter>", ...
  std::vector<std::string> keys;
};

/// Every section and key a machine file may hold; what is not here is refused by ParseMachine, and everything
/// here is described in docs/machine_file.md (a test compares).
const std::vector<MachineSection>& MachineFileSections();

/// Keys of the section `name`, empty if there is no such section.
const std::vector<std::string>& MachineFileKeys(std::string_view name);

/// One signal or known value that a built-in model reads.
struct ModelInput {
  std::string_view name;
  std::string_view si;       ///< SI unit its value must have
  bool required;             ///< false: only some effects need it
  std::string_view meaning;  ///< for messages
  bool positive = false;     ///< must be greater than 0
};

/// What a built-in model needs to know of the machine.
struct ModelInputs {
  std::string_view model;
  std::span<const ModelInput> signals;
  std::span<const ModelInput> geometry;
  std::span<const ModelInput> parameters;  ///< identified parameters and their units
};

/// The model of that name ("die_cushion", "valve", "expressions"), nullptr if there is none.
const ModelInputs* FindModelInputs(std::string_view model);
std::vector<std::string> ModelNames();

}  // namespace hydroscope
