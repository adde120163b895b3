#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "models/machine.h"
#include "models/machine_file/keys.h"
#include "models/machine_file/section_text.h"
#include "models/machine_file/table.h"

namespace hydroscope {

/// How the values of a live signal arrive.
struct Delivery {
  bool streamed =
      true;  ///< as rows of the machine's grid with the sender's clock; else as single readings, by ours
  double period = 0;  ///< s between two readings, where they are single
};

/// What is known of a kind of live source before it runs, all from the source's own folder (acquisition/<source>/settings.cc).
/// In a machine file it has a section [live.<name>], and signals that come from there a key <name>.
struct SourceKind {
  std::string_view name;     ///< "modbus"
  std::string_view comment;  ///< above the section in files that the program writes
  std::vector<MachineSection>
      sections;  ///< keys of "live.<name>", of tables in it and of "signals.<name>.<source>"
  PartSettings (*read)(TableReader& section) = nullptr;
  Pairs (*write)(const PartSettings& settings) = nullptr;
  /// The key <name> of a signal, which is there; what is wrong with it is noted at `signal`.
  PartSettings (*read_origin)(TableReader& signal) = nullptr;
  std::string (*write_origin)(const PartSettings& origin) = nullptr;
  /// Notes where a signal's place and the section do not fit each other; nullptr: they always do.
  void (*check)(TableReader& file, const Machine& machine, const SignalSpec& signal) = nullptr;
  /// Whether two signals of the kind read the same values, at any axes; nullptr: where their places are the same.
  bool (*overlap)(const Machine& machine, const SignalSpec& a, const SignalSpec& b) = nullptr;
  Delivery (*delivery)(const Machine& machine, const SignalSpec& signal) = nullptr;
  std::string_view
      silent;  ///< what to look at when nothing comes: "are host, port, unit and register right?"
};

/// All of them, in the order of files (acquisition/source_kinds.cc).
std::span<const SourceKind* const> SourceKinds();
/// nullptr if there is none of that name.
const SourceKind* FindSourceKind(std::string_view name);
/// Of a signal that has an origin.
Delivery DeliveryOf(const Machine& machine, const SignalSpec& signal);

}  // namespace hydroscope
