#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/told.h"
#include "models/closed_loop.h"
#include "models/effect.h"
#include "models/experimenter.h"
#include "models/linear_form.h"
#include "models/machine.h"
#include "models/machine_draft.h"
#include "models/machine_picture.h"
#include "models/machine_words.h"
#include "models/oil_law.h"
#include "models/pressure_rule.h"
#include "models/standstill_rule.h"

namespace hydroscope {

/// A size of a signal's readings, SI, that no machine lies outside.
struct PlausibleSize {
  double low = 0, high = 0;
  enum Of { kLargest, kTravel, kMean } of = kLargest;  ///< largest magnitude, travel from end to end, mean
};

/// One signal, known value or parameter of a kind of machine.
struct MachineInput {
  std::string_view name;
  std::string_view si;    ///< SI unit its value must have
  bool required;          ///< false: only some effects need it
  Wording meaning;        ///< for messages
  bool positive = false;  ///< must be greater than 0
  /// Of known values, where `highest` is above `lowest`: no machine has one outside, in `unit` for messages.
  double lowest = 0, highest = 0;
  std::string_view unit = "";
  /// Of what is made, and so known, within a usual tolerance if none is stated: parameters in proportion to it, "V0 and Q_vn".
  std::string_view shared_by = "";
  std::optional<double> otherwise = {};  ///< SI, value where the machine file states none
  std::string_view travel_of = "";       ///< of known lengths: the signal that travels no farther
  /// Of signals; nothing: what every machine keeps to with a signal of its unit.
  std::optional<PlausibleSize> size = {};
  /// Of signals: what logs call it beside its name and meaning; small letters and digits, blanks between names.
  std::string_view columns = "";
};

/// A physical parameter that is identified.
struct MachineParameter {
  std::string_view name, si;
  Wording meaning;
  std::string_view symbol = "";  ///< for plots, "Q_{vn}"; "" = the name
  Wording sentence = "";         ///< for reports: what it is, what moves it
  std::string_view shown = "";   ///< unit of plots where the usual one of `si` does not do, ...
  double factor = 1;             ///< ... shown = SI * factor
  bool relative = true;          ///< changes are told in per cent
  OilLaw over_oil = OilLaw::kSmooth;
  /// Name of a known value: what its data sheet says of it, where the machine file states that.
  std::string_view stated_as = "";
};

/// All that is particular to one kind of machine: one folder of machines/ and one line in machines/kinds.cc.
struct MachineKind {
  std::string_view id;  ///< `model` of the machine file
  Wording title;        ///< "die cushion"
  std::span<const MachineInput> signals = {}, geometry = {};
  std::span<const MachineParameter> parameters = {};
  std::string_view output_unit = "";  ///< SI; "": [balance] of the machine file says
  bool own_library = false;           ///< balance and effects are those of the machine file
  /// Described by states (models/state_model.h), fitted by simulation; `build` is nullptr.
  bool has_states = false;
  /// The equations of a built-in machine with states, of one whose required signals and geometry are there. Outputs whose
  /// signal it does not measure are left out. nullptr: the machine file says. `effects` are texts then (Effect::adds).
  StatesSpec (*states)(const Machine&) = nullptr;
  MachineWords (*words)(const Machine&) = nullptr;
  /// How it is drawn; nullptr: as its signals (PictureOfSignals).
  MachinePicture (*picture)() = nullptr;
  /// Signal of the temperature, K, that parameters are compensated for; "" = none.
  std::string_view temperature = "";
  std::string_view supply = "";                ///< signal of the supply pressure, Pa; "" = none
  std::span<const Condition> conditions = {};  ///< of its strokes
  std::span<const StandstillRule> standstill = {};
  std::span<const PressureRule> pressures = {};
  DraftRules draft = {};
  /// nullptr: command and response only, nothing can be identified from strokes.
  Result<std::shared_ptr<ModelStructure>> (*build)(const Machine&) = nullptr;
  /// The built-in effects for one machine, in fixed order; nullptr: none. Of a Machine{} for what is said of them alone.
  std::vector<std::shared_ptr<const Effect>> (*effects)(const Machine&) = nullptr;
  /// Bounds that every gate has which says nothing of their signal's sign: where a signal's sign decides what the machine does,
  /// values close to zero do not. nullptr: none.
  std::vector<GateBound> (*gate)(const Machine&) = nullptr;
  /// Names of the channels that those effects mean by Effect::channels.
  std::span<const std::string_view> channels = {};
  ExperimentRules experiment = {};
  /// How a plant that a controller drives is measured; nullptr: it is none.
  const ClosedLoopPlant* closed_loop = nullptr;
  /// Its equations as far as they are linear in their parameters; nullptr: there are none.
  LinearForm (*linear_form)(const Machine&) = nullptr;
};

/// All kinds, the one first that a machine file without `model` means (machines/kinds.cc).
std::span<const MachineKind* const> MachineKinds();
/// nullptr if there is none of that id.
const MachineKind* FindKind(std::string_view id);
/// The kind that Machine::model names; one that can do nothing if it names none.
const MachineKind& KindOf(const Machine& machine);

/// The kind of machines with a balance of their own (MachineKind::own_library).
const MachineKind& OwnKind();
/// The kind of machines whose file describes their states.
const MachineKind& OwnStatesKind();
/// What a built-in kind says of the states of a machine; nothing if it says nothing.
StatesSpec BuiltInStates(const Machine& machine);
std::vector<std::string> KindNames();
/// SI unit of the output of a machine, which must outlive it.
std::string_view OutputSi(const Machine& machine);
MachineWords WordsOf(const Machine& machine);
/// Adds the bounds of MachineKind::gate that the machine's gate has not.
void CompleteGate(Machine& machine);
MachinePicture PictureOf(const Machine& machine);
/// Whether its rows are judged episode by episode, each as a whole: machines with states and plants in closed loop. What an
/// episode leaves behind is linearised in the parameters (models/episode_structure.h).
inline bool InEpisodes(const MachineKind& kind) { return kind.has_states || kind.closed_loop != nullptr; }
/// Whether it has a command and a response alone: nothing is fitted to its strokes, frf measures it.
inline bool MeasuredByResponse(const MachineKind& kind) { return kind.build == nullptr && !kind.has_states; }
/// nullptr if the kind has no parameter of that name.
const MachineParameter* FindParameter(const MachineKind& kind, std::string_view name);
/// What strokes of the machine are driven at: conditions of its kind, then those of its file.
std::vector<Condition> ConditionsOf(const Machine& machine);

}  // namespace hydroscope
