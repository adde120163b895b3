#include "setup/machine_proposal.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/contains.h"
#include "core/units.h"
#include "models/machine_file/format.h"
#include "models/machine_kind.h"
#include "replay/column_plan.h"
#include "setup/column_meaning.h"
#include "setup/kind_columns.h"
#include "setup/unit_guess.h"

namespace hydroscope {
namespace {

constexpr double kRepeating = 0.2;  ///< share of repeated readings above which a signal is coarse
constexpr double kSmooth = 0.12,
                 kNoisy = 1;             ///< LogColumn::roughness of what moves alone, of what is noise alone
constexpr double kSlowestPeriod = 0.02;  ///< s, rows farther apart are too slow for valves and pressures

class Proposer {
 public:
  Proposer(const LogColumns& head, const ProposalOptions& options) : head_(head), options_(options) {}

  MachineProposal Propose() {
    roles_ = AssignRoles(head_);
    if (const MachineKind* chosen = FindKind(options_.model); chosen != nullptr && chosen->own_library)
      std::erase_if(roles_, [](const ColumnRole& role) { return role.role != Role::kTime && !role.sure; });
    machine().name = std::filesystem::path(head_.path).stem().string();
    if (!head_.layout.header) machine().log.header = false;
    FindTime();
    DecideModel();
    AddSignals();
    if (KindOf(machine()).own_library) AddOtherColumns();
    Complete();
    ListUnused();
    WriteNotes();
    result_.text = FormatMachine(machine(), notes_);
    return std::move(result_);
  }

 private:
  Machine& machine() { return result_.machine; }
  const ColumnRole* Find(Role role) const {
    for (const ColumnRole& found : roles_)
      if (found.role == role) return &found;
    return nullptr;
  }
  bool Has(Role role) const { return Find(role) != nullptr; }

  void FindTime() {
    const ColumnRole* time = Find(Role::kTime);
    if (time == nullptr) {
      machine().log.time_column = "";
      result_.open.emplace_back(
          "[log] sample_period: no column of times found (a counter of rows is none); write the time between rows in s",
          "[log] sample_period: keine Zeitspalte gefunden (ein Zeilenzähler ist keine); den Zeitabstand der Zeilen in s "
          "angeben");
      notes_.section["log"] = {
          "<-- FILL IN the time between rows in s and remove the leading '# ' of the next line:",
          "sample_period = 0.001"};
      return;
    }
    const LogColumn& column = head_.columns[time->column];
    const UnitGuess guess = GuessUnit(Role::kTime, column, FindSharedSizes(head_, roles_));
    machine().log.time_column = column.reference;
    machine().log.time_unit = guess.unit;
    seconds_ = column.step * FindUnit(guess.unit).value_or(Unit{}).scale;
    Told why = Tell("{}; {}", "{}; {}", time->why, guess.why);
    bool sure = time->sure && guess.sure;
    AddTwins(column, why, sure);
    result_.columns.push_back({"time", column.name, guess.unit, why, sure});
    result_.decided.push_back(
        Tell("rows are {:.3g} ms apart", "die Zeilen liegen {:.3g} ms auseinander", seconds_ * 1e3));
    if (seconds_ > kSlowestPeriod)
      result_.open.push_back(Tell(
          "the log has only {:.3g} rows per second; valve and pressure dynamics need 100 or more",
          "der Log hat nur {:.3g} Zeilen je Sekunde; Ventil und Druck brauchen 100 oder mehr", 1 / seconds_));
  }

  /// The columns with a role, or with one that is sure alone.
  LogSample SampleOfRoles(bool sure_alone) const {
    LogSample sample;
    sample.period = seconds_;
    for (const ColumnRole& found : roles_) {
      if (found.role == Role::kTime || (sure_alone && !found.sure)) continue;
      const LogColumn& column = head_.columns[found.column];
      sample.signals[SignalNameOf(found.role)] = {column.value, column.high};
    }
    return sample;
  }
  /// The signals as the machine file being made reads them.
  LogSample SampleOfSignals() {
    LogSample sample;
    sample.period = seconds_;
    for (const SignalSpec& spec : machine().signals) {
      const LogColumn& column = *std::ranges::find_if(
          head_.columns, [&](const LogColumn& c) { return c.reference == spec.column; });
      LogSample::Signal& signal = sample.signals[spec.name];
      signal = {column.value, column.high};
      const Unit unit = FindUnit(spec.unit).value_or(Unit{});
      const auto si = [&](double raw) { return (raw * spec.scale + spec.offset) * unit.scale + unit.offset; };
      for (double& value : signal.value) value = si(value);
      signal.high = si(signal.high);
    }
    return sample;
  }

  void DecideModel() {
    if (const MachineKind* chosen = FindKind(options_.model))
      return Take(*chosen, {"chosen by hand", "von Hand gewählt"});
    const MachineKind& first = *MachineKinds().front();
    if (const Told why = first.draft.suits(SampleOfRoles(true)); !why.empty()) return Take(first, why);
    if (const MachineKind* named = KindByColumnNames(head_)) return Take(*named, ByNames(*named));
    const LogSample sample = SampleOfRoles(false);
    for (const MachineKind* kind : MachineKinds()) {
      if (kind->draft.suits == nullptr) continue;
      const Told why = kind->draft.suits(sample);
      if (why.empty()) continue;
      return Take(*kind, kind->own_library ? Tell("{}; {}", "{}; {}", why, Missing(sample)) : why);
    }
  }
  /// In a machine of the user's own a column has a role only if its name tells one: what it looks like says what it would be
  /// in the machines that are known.
  void Take(const MachineKind& kind, const Told& why) {
    machine().model = kind.id;
    if (kind.own_library)
      std::erase_if(roles_, [this](const ColumnRole& role) {
        return role.role != Role::kTime && !role.sure && !RoleByName(head_.columns[role.column].name);
      });
    result_.decided.push_back(Tell("model {}: {}", "Modell {}: {}", std::string(kind.id), why));
    const bool any = std::ranges::any_of(roles_, [](const ColumnRole& r) { return r.role != Role::kTime; });
    if (kind.own_library && !any)
      result_.decided.emplace_back(
          "no column is called like a signal of a machine that is known: see whether this is the log of one",
          "keine Spalte heißt wie ein Signal einer bekannten Maschine: nachsehen, ob dies das Log einer Maschine ist");
  }
  Told ByNames(const MachineKind& kind) const {
    std::vector<std::string> names;
    for (const KindColumn& found : ColumnsByName(head_, kind))
      names.push_back(head_.columns[found.column].name);
    return Tell("its columns are called so: {}", "seine Spalten heißen so: {}",
                fmt::to_string(fmt::join(names, ", ")));
  }
  /// What the first kind would have needed.
  static Told Missing(const LogSample& sample) {
    std::vector<Told> missing;
    for (const MachineInput& input : MachineKinds().front()->signals)
      if (input.required && !sample.signals.contains(input.name)) missing.emplace_back(input.meaning);
    return Tell("a {} needs what was not found: {}", "für {} wurde nicht gefunden: {}",
                Told(MachineKinds().front()->title), Joined(missing));
  }

  bool Required(const std::string& name) {
    const MachineKind& kind = KindOf(machine());
    for (const MachineInput& input : kind.signals)
      if (input.name == name) return input.required;
    return kind.own_library || name == machine().valve.input || name == machine().valve.output;
  }

  /// Of a kind whose signals go by name: these alone.
  void AddSignalsByName(const MachineKind& kind) {
    std::vector<ColumnRole> time;
    for (const ColumnRole& role : roles_)
      if (role.role == Role::kTime) time.push_back(role);
    roles_ = time;
    for (const KindColumn& found : ColumnsByName(head_, kind)) {
      if (IsUsed(found.column)) continue;
      AddSignal(
          std::string(found.signal->name), head_.columns[found.column], found.unit,
          Tell("{}; {}", "{}; {}", WhyThere(std::string(found.signal->name), found.why), found.unit.why),
          found.unit.sure);
      others_.push_back(found.column);
    }
  }
  void AddSignals() {
    if (const MachineKind& kind = KindOf(machine()); kind.draft.suits == nullptr && !kind.signals.empty())
      return AddSignalsByName(kind);
    const SharedSizes sizes = FindSharedSizes(head_, roles_);
    for (const ColumnRole& found : roles_) {
      if (found.role == Role::kTime) continue;
      const LogColumn& column = head_.columns[found.column];
      const UnitGuess guess = GuessUnit(found.role, column, sizes);
      const char* name = SignalNameOf(found.role);
      AddSignal(name, column, guess, Tell("{}; {}", "{}; {}", WhyThere(name, found.why), guess.why),
                found.sure && guess.sure);
    }
  }
  Told WhyThere(const std::string& signal, const Told& why) const {
    return options_.placed.contains(signal) ? Told("put here by hand", "von Hand hierher gelegt") : why;
  }
  /// One of several columns of the same name may not be the one that is meant.
  void AddTwins(const LogColumn& column, Told& why, bool& sure) const {
    const Told twins = TwinsText(head_.layout, column.reference);
    if (twins.empty()) return;
    why = Tell("{}; {}", "{}; {}", why, twins);
    sure = false;
  }
  void AddSignal(const std::string& name, const LogColumn& column, const UnitGuess& guess, Told why,
                 bool sure) {
    AddTwins(column, why, sure);
    SignalSpec spec;
    spec.name = name;
    spec.column = column.reference;
    spec.unit = guess.unit;
    spec.scale = guess.scale;
    spec.offset = guess.offset;
    spec.required = Required(name);
    if (column.repeated > kRepeating) {
      spec.stuck_time = 0;
      why = Tell("{}; often repeats a reading, so it is never taken for stuck",
                 "{}; wiederholt oft einen Wert, gilt darum nie als hängend", why);
    }
    notes_.signals[name] =
        why.english + (!guess.to_fill_in.empty() ? "  <-- FILL IN its unit, scale and offset, as said above"
                       : sure                    ? ""
                                                 : "  <-- check");
    machine().signals.push_back(spec);
    result_.columns.push_back({name, column.name, guess.unit, why, sure});
  }

  void Complete() {
    const DraftRules& rules = KindOf(machine()).draft;
    if (rules.suits == nullptr) TakeGeometry();
    if (rules.complete == nullptr) return;
    MachineDraft draft{std::move(result_.machine), std::move(notes_), std::move(result_.decided),
                       std::move(result_.open)};
    result_.machine = draft.machine;
    const LogSample sample = SampleOfSignals();
    rules.complete(sample, options_.known, draft);
    result_.machine = std::move(draft.machine);
    notes_ = std::move(draft.notes);
    result_.decided = std::move(draft.decided);
    result_.open = std::move(draft.open);
  }

  /// What is known of the machine; what has to be known and is not is asked for.
  void TakeGeometry() {
    for (const MachineInput& input : KindOf(machine()).geometry) {
      const std::string name(input.name);
      if (const auto known = options_.known.find(name); known != options_.known.end()) {
        machine().geometry[name] = {known->second, 0};
        continue;
      }
      if (!input.required) continue;
      result_.open.push_back(Tell("[geometry] {}: {}; write it from drawing or data sheet",
                                  "[geometry] {}: {}; aus Zeichnung oder Datenblatt eintragen", name,
                                  Told(input.meaning)));
      const std::string unit(input.unit.empty() ? input.si : input.unit);
      notes_.section["geometry"].push_back(fmt::format(
          "<-- FILL IN the value: {} = {{ value = ..., unit = \"{}\" }}  {}", name, unit, input.meaning));
    }
  }

  /// In a machine of the user's own every column of numbers is a signal, under its name made fit for expressions.
  void AddOtherColumns() {
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < head_.columns.size(); ++i) {
      const LogColumn& column = head_.columns[i];
      const bool row_counter = column.rising && column.step == 1;
      if (column.numeric() && !column.date && !row_counter && !IsUsed(i)) others.push_back(i);
    }
    const bool loops = AreCurrentLoops(head_, others);
    Told to_fill_in;
    for (const std::size_t i : others) {
      const LogColumn& column = head_.columns[i];
      const std::string written = WrittenUnit(column);
      const bool loop = loops && (written.empty() || written == "mA");
      const bool known = !written.empty() && !loop;
      const UnitGuess guess = loop ? UnknownCurrentLoop(column)
                              : known
                                  ? AsWritten(written, column)
                                  : UnitGuess{"1", 1, 0, Told("unit unknown", "Einheit unbekannt"), false};
      if (to_fill_in.empty()) to_fill_in = guess.to_fill_in;
      AddSignal(FreeName(column.name), column, guess, guess.why, known);
      others_.push_back(i);
    }
    if (!to_fill_in.empty()) result_.open.push_back(to_fill_in);
  }
  std::string FreeName(const std::string& column) {
    std::string name;
    for (const char c : WithoutUmlauts(NameWithoutUnit(column))) {
      const bool letter =
          (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
      if (letter) name += c;
      if (c == ' ') name += '_';
    }
    if (name.empty() || (name[0] >= '0' && name[0] <= '9')) name = "c" + name;
    std::string free = name;
    for (int n = 2; machine().SignalIndex(free) >= 0; ++n) free = fmt::format("{}_{}", name, n);
    return free;
  }
  bool IsUsed(std::size_t column) const {
    return std::ranges::any_of(roles_, [&](const ColumnRole& r) { return r.column == column; }) ||
           Contains(others_, column);
  }
  void ListUnused() {
    for (std::size_t i = 0; i < head_.columns.size(); ++i) {
      if (IsUsed(i)) continue;
      const LogColumn& column = head_.columns[i];
      result_.unused.push_back(column.name);
      if (column.numeric() && !column.date && !RoleByName(column.name))
        result_.decided.push_back(Tell("column {} is not used; it looks like: {}",
                                       "Spalte {} wird nicht gebraucht; sie sieht so aus: {}", column.name,
                                       Look(column)));
    }
  }
  /// What a column looks like, for a person to recognise it.
  static Told Look(const LogColumn& column) {
    std::vector<Told> parts = {Tell("{:.4g} ... {:.4g}", "{:.4g} ... {:.4g}", column.low, column.high)};
    if (!(column.span() > 0)) {
      parts.emplace_back("never changes", "ändert sich nie");
    } else if (column.rising) {
      parts.push_back(Tell("rises in every row by {:.4g}", "steigt in jeder Zeile um {:.4g}", column.step));
    } else {
      parts.push_back(column.roughness < kSmooth  ? Told("smooth", "glatt")
                      : column.roughness > kNoisy ? Told("noise about a level", "Rauschen um einen Wert")
                                                  : Told("moves and is noisy", "bewegt sich und rauscht"));
      if (column.repeated > kRepeating)
        parts.emplace_back("often repeats a reading", "wiederholt oft einen Wert");
    }
    return Joined(parts);
  }

  void WriteNotes() {
    notes_.head = {fmt::format("Proposed from {}: {} rows looked at.",
                               std::filesystem::path(head_.path).filename().string(), head_.rows)};
    for (const Told& line : result_.decided) notes_.head.push_back("- " + line.english);
    for (const Told& line : result_.open) notes_.head.push_back("- TO DO BY YOU: " + line.english);
    if (!result_.unused.empty())
      notes_.head.push_back(fmt::format("- columns not used: {}", fmt::join(result_.unused, ", ")));
    notes_.head.emplace_back("Lines marked \"<-- check\" are guesses.");
    notes_.head.emplace_back();
  }

  const LogColumns& head_;
  const ProposalOptions& options_;
  std::vector<ColumnRole> roles_;
  std::vector<std::size_t> others_;
  double seconds_ = 0;
  MachineNotes notes_;
  MachineProposal result_;
};

}  // namespace

MachineProposal ProposeMachine(const LogColumns& head, const ProposalOptions& options) {
  return Proposer(head, options).Propose();
}

}  // namespace hydroscope
