#include "page/watch/watcher.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "alarms/alarm_machine.h"
#include "alarms/feeds/dds/tags.h"
#include "alarms/feeds/modbus/tags.h"
#include "alarms/feeds/sparkplug/tags.h"
#include "alarms/press_health.h"
#include "core/effect_units.h"
#include "core/json_value.h"
#include "core/told_error.h"
#include "core/units.h"
#include "host/real_clock.h"
#include "models/counted_words.h"
#include "monitor/alarm_json.h"
#include "page/http/json_reply.h"
#include "storage/file_identity.h"

namespace hydroscope {
namespace {

constexpr int kNice = 10;  ///< pages can wait, a service beside them cannot
constexpr std::chrono::seconds kLookEvery(1);
constexpr std::int64_t kRowsAtATime = 2000;
constexpr std::size_t kMostMarks = 5000;  ///< of a machine, the newest

/// What the drift watch tells of an axis, with what the service warns of.
nlohmann::json WithWarnings(nlohmann::json told, const nlohmann::json& service) {
  for (const nlohmann::json& axis : service.value("axes", nlohmann::json::array()))
    if (axis.value("name", "") == told["name"])
      for (const char* key : {"warnings", "german"})
        if (axis.contains(key)) told[key] = axis[key];
  return told;
}

/// The axis of this name in what the service tells; null: it tells nothing of it.
nlohmann::json ServiceTold(const nlohmann::json& service, const std::string& machine) {
  if (!service.is_object() || !service.contains("drift")) return {};
  for (const nlohmann::json& axis : service["drift"].value("axes", nlohmann::json::array()))
    if (axis.value("name", "") == machine) return WithWarnings(axis, service);
  return {};
}

std::optional<TrendMark> MarkOf(const AlarmEvent& event) {
  if (event.stroke < 0) return std::nullopt;
  if (event.event == "raised" || event.event == "escalated")
    return TrendMark{"alarm", event.first_stroke >= 0 ? event.first_stroke : event.stroke, event.alarm,
                     event.text};
  if (event.event == "cleared") return TrendMark{"cleared", event.stroke, event.alarm, {}};
  if (event.event == "reference_learned")
    return TrendMark{"reference",
                     event.stroke,
                     {},
                     Tell("reference {} learned from {} to {}", "Referenz {} gelernt aus {} bis {}",
                          event.reference_version, event.first_stroke, event.last_stroke)};
  return std::nullopt;
}

}  // namespace

struct Watcher::Opened {
  explicit Opened(Database d) : database(std::move(d)) {}

  FileIdentity file, journal_file;
  Database database;
  std::optional<AlarmJournal> journal;
  std::vector<std::unique_ptr<WatchedMachine>> machines;
  std::map<std::string, std::vector<TrendMark>> marks;  ///< of the journal, by machine
  std::int64_t read_to = 0;                             ///< row of the journal
  std::optional<JournalRow> newest;                     ///< that row

  Status ReadRows() {
    for (;;) {
      const auto rows = TRY(journal->Rows("", read_to, kRowsAtATime));
      for (const JournalRow& row : rows) {
        read_to = row.sequence;
        std::vector<TrendMark>& kept = marks[row.machine];
        if (auto mark = MarkOf(row.event)) kept.push_back(std::move(*mark));
        if (kept.size() > kMostMarks) kept.erase(kept.begin(), kept.begin() + kMostMarks / 2);
      }
      if (!rows.empty()) newest = rows.back();
      if (static_cast<std::int64_t>(rows.size()) < kRowsAtATime) return {};
    }
  }

  /// The machine of this name as it is now; `told`: of it by the service. Another model, or the first strokes, is another machine
  /// to look at.
  Result<const WatchedMachine*> Refresh(const std::string& name, const WatchedMachine::Sources& sources,
                                        const nlohmann::json& told) {
    const auto id = TRY(database.MachineId(name));
    const auto known = std::find_if(machines.begin(), machines.end(),
                                    [&](const auto& machine) { return machine->name() == name; });
    if (known != machines.end()) {
      const int version = (*known)->model_version();
      const bool had_strokes = (*known)->end() > 0;
      TRY((*known)->Refresh(told));
      if ((*known)->model_version() == version && had_strokes) return known->get();
      machines.erase(known);
    }
    auto created = TRY(WatchedMachine::Create(sources, name, id));
    TRY(created->Refresh(told));
    return machines.emplace_back(std::move(created)).get();
  }
};

Watcher::Watcher(WatchOptions options, EventFeed& feed)
    : options_(std::move(options)), feed_(feed), state_(std::make_shared<WatchedState>()) {
  thread_ = std::thread([this] { Run(); });
}

Watcher::~Watcher() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

std::shared_ptr<const WatchedState> Watcher::state() {
  const std::lock_guard lock(mutex_);
  const std::int64_t now = RealTime().monotonic_ns;
  if (static_cast<double>(now - asked_) > kAttention * 1e9) look_now_ = true;
  asked_ = now;
  wake_.notify_all();
  return state_;
}

WatchedState Watcher::Seen() const {
  const std::lock_guard lock(mutex_);
  return *state_;
}

nlohmann::json Watcher::Service() const {
  const std::lock_guard lock(mutex_);
  return service_;
}

void Watcher::LookNow() {
  {
    const std::lock_guard lock(mutex_);
    look_now_ = true;
  }
  wake_.notify_all();
}

void Watcher::Publish(std::shared_ptr<const WatchedState> state) {
  {
    const std::lock_guard lock(mutex_);
    state_ = std::move(state);
  }
  feed_.Publish(R"({"state": "watched"})");
}

void Watcher::Run() {
  setpriority(PRIO_PROCESS, 0, kNice);  // of this thread
  std::string problem;
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      const auto attention = [this] {
        return stop_ || static_cast<double>(RealTime().monotonic_ns - asked_) < kAttention * 1e9;
      };
      wake_.wait(lock, attention);
      if (stop_) return;
    }
    const Status looked = Look();
    if (!looked) {
      opened_.reset();
      seen_.clear();
    }
    if (!looked && looked.error().text != problem) {
      auto failed = std::make_shared<WatchedState>(Seen());  // what was seen last stays, with the reason
      failed->overview["problem"] = ErrorJson(ToldOf(looked.error()));
      Publish(std::move(failed));
    }
    problem = looked ? "" : looked.error().text;
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, kLookEvery, [this] { return stop_ || look_now_; });
    look_now_ = false;
    if (stop_) return;
  }
}

Status Watcher::Open() {
  const std::string journal = AlarmJournal::PathFor(options_.database);
  const FileIdentity file = FileIdentity::Of(options_.database), journal_file = FileIdentity::Of(journal);
  if (opened_ && opened_->file == file && opened_->journal_file == journal_file) return {};
  opened_.reset();
  auto database = TRY(Database::OpenReadOnly(options_.database));
  opened_ = std::make_unique<Opened>(std::move(database));
  opened_->file = file;
  opened_->journal_file = journal_file;
  if (!journal_file.exists()) return {};
  auto opened = TRY(AlarmJournal::OpenReadOnly(journal));
  const auto of = opened.DatabaseIdentity(), own = opened_->database.Identity();
  if (of && own && (of->empty() || *of == *own)) opened_->journal = std::move(opened);
  return {};
}

Status Watcher::Look() {
  TRY(Open());
  Opened& opened = *opened_;
  const auto names = TRY(opened.database.MachineNames());
  nlohmann::json service = options_.service();
  {
    const std::lock_guard lock(mutex_);
    service_ = service;
  }
  // What makes a difference; the service's ages and counters change always.
  std::string seen = service.is_object() ? service.value("drift", nlohmann::json()).dump() : "";
  const StoredCounts stored = TRY(opened.database.CountStored());
  seen += fmt::format("{} runs {} strokes {} valve checks {}\n", fmt::join(names, "\n"), stored.runs,
                      stored.strokes, stored.valve_checks);
  if (opened.journal) {
    const auto last = TRY(opened.journal->LastSequence());
    seen += fmt::format("rows {}\n", last);
  }
  if (seen == seen_) return {};
  TRY(Read(opened, service));
  seen_ = std::move(seen);
  return {};
}

namespace {

/// "x 1e-05 = bar": how a value in this SI unit becomes what people read.
std::string ScalingOf(const std::string& si) {
  const DisplayUnit unit = DisplayUnitFor(si);
  if (si.empty() || si == unit.name || unit.name.empty()) return "";
  return fmt::format("x {:.6g}{} = {}", unit.factor,
                     unit.offset == 0 ? "" : fmt::format(" {:+.6g}", unit.offset), unit.name);
}

/// What the feeds of the machine would tell of these axes. The feeds a machine file does not ask for are shown
/// with their defaults.
nlohmann::json TagsJson(const std::vector<AxisPicture>& axes, const Machine& machine,
                        const AlarmJournal* journal, const std::optional<JournalRow>& newest, double wall) {
  const auto alarms = journal == nullptr ? Result<std::vector<std::pair<std::string, std::string>>>()
                                         : journal->AlarmsByAppearance();
  std::vector<Tag> tags =
      ModbusTags(axes, alarms.value_or(std::vector<std::pair<std::string, std::string>>()), wall,
                 CountedWordsOf(machine));
  const SparkplugFeedSpec* spec = machine.feeds ? machine.feeds->Of<SparkplugFeedSpec>() : nullptr;
  for (Tag& tag : SparkplugTags(spec == nullptr ? SparkplugFeedSpec() : *spec, machine.name, axes, wall))
    tags.push_back(std::move(tag));
  const DdsFeedSpec* dds = machine.feeds ? machine.feeds->Of<DdsFeedSpec>() : nullptr;
  for (Tag& tag : DdsTags(dds == nullptr ? DdsFeedSpec() : *dds, axes, newest))
    tags.push_back(std::move(tag));
  nlohmann::json list = nlohmann::json::array();
  for (const Tag& tag : tags)
    list.push_back({{"feed", tag.feed},
                    {"axis", tag.axis},
                    {"address", tag.address},
                    {"name", tag.name},
                    {"type", tag.type},
                    {"unit", tag.unit},
                    {"scaling", ScalingOf(tag.unit)},
                    {"meaning", tag.meaning},
                    {"value", tag.value}});
  return list;
}

/// A press, which has alarms but no strokes of its own.
AxisPicture PressPicture(const std::string& machine, std::vector<AlarmState> alarms,
                         const std::vector<AxisPicture>& axes) {
  AxisPicture press;
  press.machine = press.name = machine;
  std::vector<Health> healths;
  for (const AxisPicture& axis : axes) healths.push_back(axis.health);
  press.health = JudgePressHealth(alarms, {}, healths);
  press.alarms = std::move(alarms);
  return press;
}

/// In the order of a running service, which feeds go by; those of other machines in the database are left out.
std::vector<AxisPicture> AsServed(std::vector<AxisPicture> axes, const nlohmann::json& service) {
  if (!service.is_object() || !service.contains("drift")) return axes;
  std::vector<AxisPicture> served;
  for (const nlohmann::json& told : service["drift"].value("axes", nlohmann::json::array()))
    for (AxisPicture& axis : axes)
      if (axis.machine == told.value("name", "")) served.push_back(std::move(axis));
  return served;
}

/// null of an alarm that is told in English alone.
nlohmann::json GermanJson(const AlarmState& alarm) {
  const AlarmWords& words = alarm.words;
  if (words.finding.german.empty()) return {};
  return {{"finding", words.finding.german},
          {"evidence", words.evidence.InGerman()},
          {"action", words.action.InGerman()},
          {"cause", CauseTold(alarm.cause).german}};
}

/// All alarms the journal knows; `standing` gets the number of those not at rest, by machine.
Result<nlohmann::json> AlarmsJson(const AlarmJournal& journal, std::map<std::string, int>& standing) {
  nlohmann::json list = nlohmann::json::array();
  const auto machines = TRY(journal.Machines());
  for (const std::string& machine : machines) {
    const auto axis = TRY(journal.Axis(machine));
    for (const AlarmState& alarm : axis.alarms) {
      const AlarmWords& words = alarm.words;
      nlohmann::json json = AlarmJson(machine, alarm);
      const EffectUnit shown = alarm.unit == "1" ? EffectUnit{100, "%"} : EffectUnitFor(alarm.unit);
      json.update({{"at_rest", AtRest(alarm)},
                   {"shown", {{"factor", shown.factor}, {"name", shown.name}}},
                   {"raised_time_s", JsonNumber(alarm.raised_time)},
                   {"finding", words.finding.empty() ? alarm.text : words.finding.english},
                   {"evidence", words.evidence.english},
                   {"action", words.action.english},
                   {"german", GermanJson(alarm)}});
      list.push_back(std::move(json));
      standing[machine] += AtRest(alarm) ? 0 : 1;
    }
  }
  return list;
}

}  // namespace

Status Watcher::Read(Opened& opened, const nlohmann::json& service) {
  auto state = std::make_shared<WatchedState>();
  state->alarms = nlohmann::json::array();
  std::map<std::string, int> standing;
  if (opened.journal) {
    TRY(opened.ReadRows());
    state->alarms = TRY(AlarmsJson(*opened.journal, standing));
  }
  nlohmann::json list = nlohmann::json::array(), effects = nlohmann::json::array();
  std::vector<AxisPicture> axes;
  const auto names = TRY(opened.database.MachineNames());
  const WatchedMachine::Sources sources{opened.database, options_.database,
                                        opened.journal ? &*opened.journal : nullptr, options_.machine_file};
  for (const std::string& name : names) {
    const auto known = TRY(opened.Refresh(name, sources, ServiceTold(service, name)));
    const WatchedMachine& machine = *known;
    WatchedState::MachineState& shown = state->machines[name];
    shown = {machine.id(), machine.end(), machine.dated(), machine.parameters(), opened.marks[name], {}};
    for (const SignalSpec& signal : machine.described().signals)
      shown.signal_units[signal.name] = FindUnit(signal.unit).value_or(Unit{}).si;
    shown.marks.insert(shown.marks.end(), machine.marks().begin(), machine.marks().end());
    std::stable_sort(shown.marks.begin(), shown.marks.end(),
                     [](const TrendMark& a, const TrendMark& b) { return a.stroke < b.stroke; });
    machine.AddTitles(effects);
    list.push_back(machine.json());
    list.back()["alarms"] = standing[name];
    axes.push_back(machine.picture());
    if (!opened.journal) continue;
    auto content = TRY(opened.journal->Axis(name));
    axes.back().alarms = std::move(content.alarms);
  }
  nlohmann::json presses = nlohmann::json::array();
  for (const auto& [machine, count] : standing) {
    if (state->machines.contains(machine)) continue;
    presses.push_back({{"machine", machine}, {"alarms", count}});
    auto content = TRY(opened.journal->Axis(machine));
    axes.push_back(PressPicture(machine, std::move(content.alarms), axes));
  }
  state->tags = TagsJson(AsServed(std::move(axes), service),
                         opened.machines.empty() ? Machine() : opened.machines.front()->described(),
                         opened.journal ? &*opened.journal : nullptr, opened.newest, WallSeconds());
  state->overview = {{"database", std::filesystem::path(options_.database).filename().string()},
                     {"service", service.is_object()},
                     {"journal", opened.journal.has_value()},
                     {"user", options_.user},
                     {"effects", std::move(effects)},
                     {"machines", std::move(list)},
                     {"presses", std::move(presses)},
                     {"problem", nullptr}};
  Publish(std::move(state));
  return {};
}

}  // namespace hydroscope
