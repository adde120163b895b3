#include "setup/machine_proposal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/units.h"
#include "models/machine_file/format.h"
#include "models/machine_file/keys.h"
#include "models/machine_kind.h"
#include "setup/column_meaning.h"
#include "setup/unit_guess.h"

namespace hydroscope {
namespace {

constexpr double kRepeating = 0.2;       ///< share of repeated readings above which a signal is coarse
constexpr double kSlowestPeriod = 0.02;  ///< s, rows farther apart are too slow for valves and pressures

class Proposer {
 public:
  Proposer(const LogColumns& head, const ProposalOptions& options) : head_(head), options_(options) {}

  MachineProposal Propose() {
    roles_ = AssignRoles(head_);
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
      machine().log.sample_period = 0.001;
      result_.open.emplace_back(
          "[log] sample_period: no time column found; write the time between rows in s (0.001 is a guess)");
      notes_.section["log"].emplace_back(
          "<-- FILL IN sample_period: the log has no time column, 0.001 s is a guess");
      return;
    }
    const LogColumn& column = head_.columns[time->column];
    const UnitGuess guess = GuessUnit(Role::kTime, column, FindSharedSizes(head_, roles_));
    machine().log.time_column = column.reference;
    machine().log.time_unit = guess.unit;
    seconds_ = column.step * FindUnit(guess.unit).value_or(Unit{}).scale;
    result_.columns.push_back({"time", column.name, guess.unit,
                               Tell("{}; {}", "{}; {}", time->why, guess.why), time->sure && guess.sure});
    result_.decided.push_back(fmt::format("rows are {:.3g} ms apart", seconds_ * 1e3));
    if (seconds_ > kSlowestPeriod)
      result_.open.push_back(
          fmt::format("the log has only {:.3g} rows per second; valve and pressure dynamics need 100 or more",
                      1 / seconds_));
  }

  /// The columns with a role, as the machine file being made reads them.
  LogSample Sample() {
    LogSample sample;
    sample.period = seconds_;
    for (const ColumnRole& found : roles_) {
      if (found.role == Role::kTime) continue;
      const LogColumn& column = head_.columns[found.column];
      LogSample::Signal& signal = sample.signals[SignalNameOf(found.role)];
      signal = {column.value, column.high};
      const int index = machine().SignalIndex(SignalNameOf(found.role));
      if (index < 0) continue;  // the kind is not decided yet
      const SignalSpec& spec = machine().signals[static_cast<std::size_t>(index)];
      const Unit unit = FindUnit(spec.unit).value_or(Unit{});
      const auto si = [&](double raw) { return (raw * spec.scale + spec.offset) * unit.scale + unit.offset; };
      for (double& value : signal.value) value = si(value);
      signal.high = si(signal.high);
    }
    return sample;
  }

  void DecideModel() {
    const LogSample sample = Sample();
    for (const MachineKind* kind : MachineKinds()) {
      if (kind->draft.suits == nullptr) continue;
      const std::string why = kind->draft.suits(sample);
      if (why.empty()) continue;
      machine().model = kind->id;
      result_.decided.push_back(
          fmt::format("model {}: {}{}", kind->id, why, kind->own_library ? Missing(sample) : ""));
      return;
    }
  }
  /// What the first kind would have needed.
  static std::string Missing(const LogSample& sample) {
    std::vector<std::string_view> missing;
    for (const MachineInput& input : MachineKinds().front()->signals)
      if (input.required && !sample.signals.contains(input.name)) missing.push_back(input.meaning);
    return fmt::format("; a {} needs what was not found: {}", MachineKinds().front()->title,
                       fmt::join(missing, ", "));
  }

  bool Required(const std::string& name) {
    const MachineKind& kind = KindOf(machine());
    if (kind.build == nullptr) return name == machine().valve.input || name == machine().valve.output;
    for (const MachineInput& input : kind.signals)
      if (input.name == name) return input.required;
    return kind.own_library;
  }

  void AddSignals() {
    const SharedSizes sizes = FindSharedSizes(head_, roles_);
    for (const ColumnRole& found : roles_) {
      if (found.role == Role::kTime) continue;
      const LogColumn& column = head_.columns[found.column];
      const UnitGuess guess = GuessUnit(found.role, column, sizes);
      AddSignal(SignalNameOf(found.role), column, guess, Tell("{}; {}", "{}; {}", found.why, guess.why),
                found.sure && guess.sure);
    }
  }
  void AddSignal(const std::string& name, const LogColumn& column, const UnitGuess& guess, Told why,
                 bool sure) {
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
    notes_.signals[name] = why.english + (sure ? "" : "  <-- check");
    machine().signals.push_back(spec);
    result_.columns.push_back({name, column.name, guess.unit, why, sure});
  }

  void Complete() {
    const DraftRules& rules = KindOf(machine()).draft;
    if (rules.complete == nullptr) return;
    MachineDraft draft{std::move(result_.machine), std::move(notes_), std::move(result_.decided),
                       std::move(result_.open)};
    result_.machine = draft.machine;
    const LogSample sample = Sample();
    rules.complete(sample, options_.known, draft);
    result_.machine = std::move(draft.machine);
    notes_ = std::move(draft.notes);
    result_.decided = std::move(draft.decided);
    result_.open = std::move(draft.open);
  }

  /// In a machine of the user's own every column of numbers is a signal, under its name made fit for expressions.
  void AddOtherColumns() {
    for (std::size_t i = 0; i < head_.columns.size(); ++i) {
      const LogColumn& column = head_.columns[i];
      const bool row_counter = column.rising && column.step == 1;
      if (!column.numeric() || column.date || row_counter || IsUsed(i)) continue;
      const bool known = FindUnit(column.unit).has_value();
      const UnitGuess guess{known ? column.unit : "1", 1, 0,
                            known ? Told("unit in the header", "Einheit in der Kopfzeile")
                                  : Told("unit unknown", "Einheit unbekannt"),
                            known};
      AddSignal(FreeName(column.name), column, guess, guess.why, known);
      others_.push_back(i);
    }
  }
  std::string FreeName(const std::string& column) {
    std::string name;
    for (const char c : column)
      if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_') name += c;
    if (name.empty() || (name[0] >= '0' && name[0] <= '9')) name = "c" + name;
    std::string free = name;
    for (int n = 2; machine().SignalIndex(free) >= 0; ++n) free = fmt::format("{}_{}", name, n);
    return free;
  }
  bool IsUsed(std::size_t column) const {
    return std::any_of(roles_.begin(), roles_.end(),
                       [&](const ColumnRole& r) { return r.column == column; }) ||
           std::find(others_.begin(), others_.end(), column) != others_.end();
  }
  void ListUnused() {
    for (std::size_t i = 0; i < head_.columns.size(); ++i) {
      if (IsUsed(i)) continue;
      const LogColumn& column = head_.columns[i];
      result_.unused.push_back(column.name);
      if (column.numeric() && !column.date && !RoleByName(column.name))
        result_.decided.push_back(
            fmt::format("column {} is not used; it looks like: {}", column.name, Look(column)));
    }
  }
  /// What a column looks like, for a person to recognise it.
  static std::string Look(const LogColumn& column) {
    std::string text = fmt::format("{:.4g} ... {:.4g}", column.low, column.high);
    if (!(column.span() > 0)) return text + ", never changes";
    if (column.rising) return text + fmt::format(", rises in every row by {:.4g}", column.step);
    text += column.roughness < 0.12 ? ", smooth"
            : column.roughness > 1  ? ", noise about a level"
                                    : ", moves and is noisy";
    return text + (column.repeated > kRepeating ? ", often repeats a reading" : "");
  }

  void WriteNotes() {
    notes_.head = {fmt::format("Proposed from {}: {} rows looked at.",
                               std::filesystem::path(head_.path).filename().string(), head_.rows)};
    for (const std::string& line : result_.decided) notes_.head.push_back("- " + line);
    for (const std::string& line : result_.open) notes_.head.push_back("- TO DO BY YOU: " + line);
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
