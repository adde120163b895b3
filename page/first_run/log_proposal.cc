#include "page/first_run/log_proposal.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/contains.h"
#include "core/units.h"
#include "models/machine_kind.h"
#include "page/first_run/log_picture.h"
#include "page/http/json_reply.h"
#include "page/work/machine_info.h"
#include "setup/column_meaning.h"
#include "setup/kind_columns.h"

namespace hydroscope {
namespace {

constexpr std::size_t kThumbnailPoints = 120;

const LogColumn* FindColumn(const LogColumns& log, const std::string& reference) {
  for (const LogColumn& column : log.columns)
    if (column.reference == reference) return &column;
  return nullptr;
}

struct Extremes {
  double low = kNaN, high = kNaN;
};

/// Of every row that was looked at, as `check` tells them.
Extremes ExtremesOf(const LogColumn& column) {
  Extremes extremes;
  for (const double value : column.value) {
    extremes.low = std::fmin(extremes.low, value);
    extremes.high = std::fmax(extremes.high, value);
  }
  return extremes;
}

/// Whether the column's own name says that it is `signal` of a machine of this kind (nullptr: not known): what its name says of the
/// unit then counts too.
bool Means(const LogColumns& log, const LogColumn& column, const MachineKind* kind,
           const std::string& signal) {
  if (kind != nullptr && kind->draft.suits == nullptr && signal != "time") {
    const std::vector<KindColumn> named = ColumnsByName(log, *kind);
    return std::any_of(named.begin(), named.end(), [&](const KindColumn& known) {
      return known.signal->name == signal && &log.columns[known.column] == &column;
    });
  }
  const auto role = RoleByName(column.name);
  return role && (*role == Role::kTime ? "time" : SignalNameOf(*role)) == signal;
}

/// Reference of the column that the proposal reads as `signal`; "" if none.
std::string ColumnOf(const MachineProposal& proposal, const std::string& signal) {
  if (signal == "time") return proposal.machine.log.time_column;
  const int index = proposal.machine.SignalIndex(signal);
  return index < 0 ? "" : proposal.machine.signals[static_cast<std::size_t>(index)].column;
}

nlohmann::json PinJson(const LogColumns& log, const MachineProposal& proposal, const std::string& signal,
                       const Wording& meaning, bool required, std::string_view si) {
  nlohmann::json pin = {{"signal", signal},
                        {"meaning", meaning.english},
                        {"german", {{"meaning", meaning.german}}},
                        {"required", required},
                        {"si", si},
                        {"column", nullptr},
                        {"unit", nullptr},
                        {"why", nullptr},
                        {"sure", false}};
  const std::string reference = ColumnOf(proposal, signal);
  const LogColumn* column = FindColumn(log, reference);
  if (column == nullptr) return pin;
  pin["column"] = reference;
  for (const ProposedColumn& proposed : proposal.columns)
    if (proposed.signal == signal)
      pin.update({{"unit", proposed.unit},
                  {"why", proposed.why.english},
                  {"german", {{"meaning", meaning.german}, {"why", proposed.why.german}}},
                  {"sure", proposed.sure}});
  const int index = proposal.machine.SignalIndex(signal);
  if (index < 0) return pin;
  const SignalSpec& spec = proposal.machine.signals[static_cast<std::size_t>(index)];
  const Unit unit = FindUnit(spec.unit).value_or(Unit{});
  const DisplayUnit shown = DisplayUnitFor(unit.si);
  const auto show = [&](double raw) {
    return ((raw * spec.scale + spec.offset) * unit.scale + unit.offset) * shown.factor + shown.offset;
  };
  const Extremes raw = ExtremesOf(*column);
  pin.update({{"low", std::fmin(show(raw.low), show(raw.high))},
              {"high", std::fmax(show(raw.low), show(raw.high))},
              {"shown_unit", shown.name}});
  return pin;
}

/// What the machine's kind reads, then signals of its own.
nlohmann::json PinsJson(const LogColumns& log, const MachineProposal& proposal) {
  nlohmann::json pins = nlohmann::json::array();
  pins.push_back(PinJson(log, proposal, "time", {"time", "Zeit"}, false, "s"));
  const MachineKind& kind = KindOf(proposal.machine);
  for (const MachineInput& input : kind.signals)
    pins.push_back(PinJson(log, proposal, std::string(input.name), input.meaning, input.required, input.si));
  for (const SignalSpec& spec : proposal.machine.signals) {
    const bool known = std::any_of(kind.signals.begin(), kind.signals.end(),
                                   [&](const MachineInput& input) { return input.name == spec.name; });
    const auto unit = FindUnit(spec.unit);
    if (!known) pins.push_back(PinJson(log, proposal, spec.name, "", spec.required, unit ? unit->si : "1"));
  }
  return pins;
}

nlohmann::json ColumnsJson(const LogColumns& log, const nlohmann::json& pins) {
  nlohmann::json out = nlohmann::json::array();
  for (const LogColumn& column : log.columns) {
    nlohmann::json signal;
    for (const nlohmann::json& pin : pins)
      if (pin["column"] == column.reference) signal = pin["signal"];
    const Extremes extremes = ExtremesOf(column);
    out.push_back({{"column", column.reference},
                   {"name", column.name},
                   {"unit", column.unit},
                   {"low", extremes.low},
                   {"high", extremes.high},
                   {"numeric", column.numeric()},
                   {"thumbnail", ThumbnailJson(column.value, kThumbnailPoints)},
                   {"signal", signal}});
  }
  return out;
}

/// The unit in which people read a known value: that of its kind, else the usual one.
DisplayUnit ShownOf(const MachineInput& input) {
  const auto own = FindUnit(input.unit);
  if (!own || own->scale == 1) return DisplayUnitFor(input.si);
  return {1 / own->scale, -own->offset / own->scale, input.unit};
}

nlohmann::json KindsJson(const Machine& machine) {
  std::vector<const MachineKind*> kinds = KindsToChoose();
  if (const MachineKind* own = &KindOf(machine); !Contains(kinds, own)) kinds.push_back(own);
  nlohmann::json out = nlohmann::json::array();
  for (const MachineKind* kind : kinds)
    out.push_back({{"id", kind->id},
                   {"title", kind->title.english},
                   {"german", {{"title", kind->title.german}}},
                   {"own", kind->own_library}});
  return out;
}

/// null of a machine whose balance is built in.
nlohmann::json BalanceJson(const Machine& machine) {
  if (!KindOf(machine).own_library) return nullptr;
  nlohmann::json terms = nlohmann::json::array();
  for (const TermSpec& term : machine.balance.terms)
    terms.push_back({{"name", term.parameter}, {"expression", term.expression}});
  return {{"output", machine.balance.output}, {"terms", terms}};
}

/// Of a machine of one's own; null of others.
nlohmann::json OwnEffectsJson(const Machine& machine) {
  if (!KindOf(machine).own_library) return nullptr;
  nlohmann::json out = nlohmann::json::array();
  for (const UserEffectSpec& effect : machine.user_effects)
    if (effect.terms.size() == 1)
      out.push_back({{"id", effect.id},
                     {"expression", effect.terms.front().expression},
                     {"not_negative", effect.min.value_or(-1) >= 0}});
  return out;
}

/// Those written by hand; what was proposed and is as it was keeps its words and units.
std::vector<UserEffectSpec> WithWords(std::vector<UserEffectSpec> written,
                                      const std::vector<UserEffectSpec>& proposed) {
  for (UserEffectSpec& effect : written)
    for (const UserEffectSpec& before : proposed) {
      if (before.id != effect.id || before.terms.size() != 1 ||
          before.terms.front().expression != effect.terms.front().expression)
        continue;
      const auto min = effect.min;
      effect = before;
      effect.min = min;
      break;
    }
  return written;
}

/// What is wrong with a machine file, without the place in a text that nobody looks at.
Told WithoutPlace(const Error& error) {
  const auto from_section = [](const std::string& problem) {
    const std::size_t section = problem.find('[');
    return section == problem.npos ? problem : problem.substr(section);
  };
  return {from_section(error.text), from_section(error.german)};
}

nlohmann::json GeometryJson(const Machine& machine) {
  nlohmann::json out = nlohmann::json::array();
  for (const MachineInput& input : KindOf(machine).geometry) {
    const auto known = machine.Geometry(std::string(input.name));
    const DisplayUnit shown = ShownOf(input);
    out.push_back({{"name", input.name},
                   {"unit", {{"factor", shown.factor}, {"offset", shown.offset}, {"name", shown.name}}},
                   {"otherwise", input.otherwise ? nlohmann::json(*input.otherwise) : nlohmann::json()},
                   {"meaning", input.meaning.english},
                   {"german", {{"meaning", input.meaning.german}}},
                   {"required", input.required},
                   {"si", input.si},
                   {"value", known ? nlohmann::json(known->value) : nlohmann::json()},
                   {"lowest", input.lowest},
                   {"highest", input.highest}});
  }
  return out;
}

nlohmann::json GateJson(const Machine& machine) {
  nlohmann::json out = nlohmann::json::array();
  for (const GateBound& bound : machine.gate.bounds) {
    const int index = machine.SignalIndex(bound.signal);
    const auto unit =
        index < 0 ? std::nullopt : FindUnit(machine.signals[static_cast<std::size_t>(index)].unit);
    out.push_back({{"signal", bound.signal},
                   {"rate", bound.rate},
                   {"magnitude", bound.magnitude},
                   {"si", unit ? unit->si : "1"},
                   {"min", bound.min ? nlohmann::json(*bound.min) : nlohmann::json()},
                   {"max", bound.max ? nlohmann::json(*bound.max) : nlohmann::json()}});
  }
  return out;
}

/// s from the first row looked at to the last, by the proposed time column; NaN without one.
double DurationOf(const LogColumns& log, const Machine& machine) {
  const LogColumn* time = FindColumn(log, machine.log.time_column);
  if (time == nullptr || time->value.size() < 2) return std::nan("");
  const double scale = FindUnit(machine.log.time_unit).value_or(Unit{}).scale;
  return (time->value.back() - time->value.front()) * scale;
}

const ProposedColumn* FindProposed(const MachineProposal& proposal, const std::string& signal) {
  const auto found = std::ranges::find(proposal.columns, signal, &ProposedColumn::signal);
  return found == proposal.columns.end() ? nullptr : &*found;
}

/// A column that a person left where the plain proposal has it is as sure as there, and for the same reason.
void KeepReasons(const ColumnMapping& mapping, const MachineProposal& plain, MachineProposal& proposal) {
  for (ProposedColumn& proposed : proposal.columns) {
    const auto entry = std::ranges::find(mapping.columns, proposed.signal, &ColumnMapping::Entry::signal);
    const ProposedColumn* before = FindProposed(plain, proposed.signal);
    if (entry == mapping.columns.end() || before == nullptr || !entry->unit.empty()) continue;
    if (ColumnOf(plain, proposed.signal) != entry->column) continue;
    proposed.why = before->why;
    proposed.sure = before->sure;
  }
}

}  // namespace

MachineProposal ProposeMapped(const LogColumns& log, const ColumnMapping& mapping) {
  ProposalOptions options;
  options.known = mapping.geometry;
  options.model = mapping.model;
  const MachineKind* kind = FindKind(mapping.model);
  const MachineProposal plain = ProposeMachine(log, options);
  LogColumns mapped = log;
  if (!mapping.columns.empty()) {
    mapped.columns.clear();
    for (const ColumnMapping::Entry& entry : mapping.columns) {
      const LogColumn* column = FindColumn(log, entry.column);
      if (column == nullptr || entry.signal.empty()) continue;
      mapped.columns.push_back(*column);
      LogColumn& put = mapped.columns.back();
      if (!Means(log, *column, kind, entry.signal)) {
        if (put.unit.empty()) put.unit = UnitInName(put.name);
        put.name = entry.signal == "time" ? "t" : entry.signal;
        options.placed.insert(entry.signal);
      }
      if (entry.unit.empty()) continue;
      put.unit = entry.unit;
      put.unit_chosen = true;
    }
  }
  MachineProposal proposal = ProposeMachine(mapped, options);
  KeepReasons(mapping, plain, proposal);
  Machine& machine = proposal.machine;
  for (const MachineInput& input : KindOf(machine).geometry)  // also what the draft had a usual value for
    if (const auto known = mapping.geometry.find(std::string(input.name)); known != mapping.geometry.end())
      machine.geometry[known->first] = {known->second, 0};
  if (mapping.gate) {
    machine.gate.bounds = *mapping.gate;
    CompleteGate(machine);
  }
  if (mapping.balance && KindOf(machine).own_library) machine.balance = *mapping.balance;
  if (mapping.effects && KindOf(machine).own_library)
    machine.user_effects = WithWords(*mapping.effects, machine.user_effects);
  if (!mapping.columns.empty() || mapping.gate || mapping.balance || mapping.effects ||
      !mapping.geometry.empty())
    proposal.text = FormatMachine(machine);
  return proposal;
}

std::string TextWithoutBalance(Machine machine, const std::string& output) {
  if (!KindOf(machine).own_library || machine.signals.empty()) return "";
  const bool is_signal =
      std::ranges::any_of(machine.signals, [&](const SignalSpec& signal) { return signal.name == output; });
  // A product: any term may read the signal.
  machine.balance = {is_signal ? output : "1*" + machine.signals.front().name, "", {{"k", "1"}}};
  machine.user_effects.clear();
  return FormatMachine(machine);
}

nlohmann::json ProposalJson(const LogColumns& log, const MachineProposal& proposal) {
  const Machine& machine = proposal.machine;
  const nlohmann::json pins = PinsJson(log, proposal);
  const auto usable = ParseMachine(proposal.text, machine.name);
  nlohmann::json problem;
  if (!usable)
    problem = ErrorJson(WithoutPlace(usable.error()));
  else if (KindOf(machine).build != nullptr)
    if (const auto built = KindOf(machine).build(*usable); !built)
      problem = ErrorJson(WithoutPlace(built.error()));
  return {{"machine", machine.name},
          {"model", machine.model},
          {"title", KindOf(machine).title.english},
          {"german",
           {{"title", KindOf(machine).title.german},
            {"decided", InGerman(proposal.decided)},
            {"open", InGerman(proposal.open)}}},
          {"kinds", KindsJson(machine)},
          {"balance", BalanceJson(machine)},
          {"effects", OwnEffectsJson(machine)},
          {"picture", PictureJson(machine)},
          {"pins", pins},
          {"columns", ColumnsJson(log, pins)},
          {"geometry", GeometryJson(machine)},
          {"gate", GateJson(machine)},
          {"units", UnitNames()},
          {"decided", InEnglish(proposal.decided)},
          {"open", InEnglish(proposal.open)},
          {"rows", log.rows},
          {"whole", log.rows < kRowsLookedAt},
          {"duration_s", DurationOf(log, machine)},
          {"text", proposal.text},
          {"problem", problem}};
}

}  // namespace hydroscope
