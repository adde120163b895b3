#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "models/effect.h"
#include "models/machine.h"
#include "models/machine_words.h"

namespace hydroscope {

/// One signal, known value or parameter of a kind of machine.
struct MachineInput {
  std::string_view name;
  std::string_view si;       ///< SI unit its value must have
  bool required;             ///< false: only some effects need it
  std::string_view meaning;  ///< for messages
  bool positive = false;     ///< must be greater than 0
  /// Of known values, where `highest` is above `lowest`: no machine has one outside, in `unit` for messages.
  double lowest = 0, highest = 0;
  std::string_view unit = "";
  bool toleranced = false;               ///< made, and so known, within a usual tolerance if none is stated
  std::optional<double> otherwise = {};  ///< SI, value where the machine file states none
};

/// All that is particular to one kind of machine: one folder of machines/ and one line in machines/kinds.cc.
struct MachineKind {
  std::string_view id;  ///< `model` of the machine file
  std::span<const MachineInput> signals, geometry, parameters;
  std::string_view output_unit;  ///< SI; "": [balance] of the machine file says
  bool own_library = false;      ///< balance and effects are those of the machine file
  MachineWords (*words)(const Machine&) = nullptr;
  /// nullptr: command and response only, nothing can be identified from strokes.
  Result<std::shared_ptr<ModelStructure>> (*build)(const Machine&) = nullptr;
  /// The built-in effects for one machine, in fixed order; nullptr: none. Of a Machine{} for what is said of them alone.
  std::vector<std::shared_ptr<const Effect>> (*effects)(const Machine&) = nullptr;
};

/// All kinds, the one first that a machine file without `model` means (machines/kinds.cc).
std::span<const MachineKind* const> MachineKinds();
/// nullptr if there is none of that id.
const MachineKind* FindKind(std::string_view id);
/// The kind that Machine::model names; one that can do nothing if it names none.
const MachineKind& KindOf(const Machine& machine);

/// The kind of machines with a balance of their own (MachineKind::own_library).
const MachineKind& OwnKind();
std::vector<std::string> KindNames();
/// SI unit of the output of a machine, which must outlive it.
std::string_view OutputSi(const Machine& machine);
MachineWords WordsOf(const Machine& machine);

}  // namespace hydroscope
