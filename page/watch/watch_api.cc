#include "page/watch/watch_api.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "alarms/alarm_action.h"
#include "alarms/feeds/modbus/tags.h"
#include "core/constants.h"
#include "core/json_value.h"
#include "core/units.h"
#include "host/real_clock.h"
#include "monitor/alarm_json.h"
#include "page/http/json_reply.h"
#include "page/watch/requests.h"
#include "page/watch/trend_cache.h"
#include "page/watch/watcher.h"
#include "storage/alarm_journal.h"
#include "storage/valve_check_words.h"

namespace hydroscope {
namespace {

constexpr int kPointsOfCurve = 60;
constexpr double kBeyond = 3;  ///< K that the curve is drawn beyond what was learned
constexpr std::size_t kMostMarksShown = 400;

nlohmann::json CurveJson(const drift::TemperatureModel& curve) {
  nlohmann::json json = {
      {"form", curve.FormName()}, {"low_K", JsonNumber(curve.low())}, {"high_K", JsonNumber(curve.high())}};
  for (const char* list : {"oil_temperature_K", "value", "std"}) json[list] = nlohmann::json::array();
  for (int k = 0; k <= kPointsOfCurve; ++k) {
    const double t = curve.low() - kBeyond + (curve.high() - curve.low() + 2 * kBeyond) * k / kPointsOfCurve;
    const auto p = curve.At(t);
    json["oil_temperature_K"].push_back(JsonNumber(t));
    json["value"].push_back(JsonNumber(p.value));
    json["std"].push_back(JsonNumber(p.std));
  }
  return json;
}

/// Healthy value at each bin's oil, and what the oil accounts for against its middle temperature.
void AddHealthy(const drift::TemperatureModel& curve, const TrendPicture& picture, nlohmann::json& json) {
  const double middle = (curve.low() + curve.high()) / 2;
  const double at_middle = curve.At(middle).value;
  nlohmann::json value = nlohmann::json::array(), std = nlohmann::json::array(),
                 by_oil = nlohmann::json::array();
  for (const TrendBin& bin : picture.bins) {
    const auto p = curve.At(bin.oil_temperature);
    value.push_back(JsonNumber(p.value));
    std.push_back(JsonNumber(p.std));
    by_oil.push_back(JsonNumber(p.value - at_middle));
  }
  json["healthy"] = {
      {"value", std::move(value)},      {"std", std::move(std)},
      {"by_oil", std::move(by_oil)},    {"compensates", curve.tells_slope()},
      {"middle_K", JsonNumber(middle)}, {"curve", curve.tells_slope() ? CurveJson(curve) : nlohmann::json()}};
}

/// Those of strokes first to end - 1; who looks at the newest stroke sees what was since, too.
nlohmann::json MarksJson(const std::vector<TrendMark>& marks, std::int64_t first, std::int64_t end,
                         bool newest) {
  nlohmann::json list = nlohmann::json::array();
  for (auto mark = marks.rbegin(); mark != marks.rend() && list.size() < kMostMarksShown; ++mark)
    if (mark->stroke >= first && (mark->stroke < end || newest))
      list.push_back({{"kind", mark->kind},
                      {"stroke", mark->stroke},
                      {"time_s", JsonNumber(mark->time)},
                      {"name", mark->name.english},
                      {"text", mark->text.english},
                      {"german", {{"name", mark->name.german}, {"text", mark->text.german}}}});
  return list;
}

/// docs/page.md, `watch/trend`: SI units, one entry per bin. Bins, marks, limits, and of what was learned the healthy
/// value, what the oil temperature accounts for, and the curve over it.
nlohmann::json TrendJson(const TrendQuestion& question, const TrendPicture& picture,
                         const WatchedState::MachineState& machine) {
  nlohmann::json json = {{"machine", question.machine}, {"parameter", question.parameter},
                         {"first", question.first},     {"end", question.end},
                         {"strokes", machine.end},      {"width", picture.width},
                         {"exact", picture.exact},      {"dated", machine.dated},
                         {"healthy", nullptr},          {"limits", nlohmann::json::array()}};
  nlohmann::json bins;
  for (const char* list :
       {"first", "last", "run", "begin_s", "end_s", "low", "high", "mean", "std", "oil_temperature_K"})
    bins[list] = nlohmann::json::array();
  for (const TrendBin& bin : picture.bins) {
    bins["first"].push_back(bin.first);
    bins["last"].push_back(bin.last);
    bins["run"].push_back(bin.run);
    bins["begin_s"].push_back(JsonNumber(bin.begin));
    bins["end_s"].push_back(JsonNumber(bin.end));
    bins["low"].push_back(JsonNumber(bin.low));
    bins["high"].push_back(JsonNumber(bin.high));
    bins["mean"].push_back(JsonNumber(bin.mean));
    bins["std"].push_back(JsonNumber(bin.std));
    bins["oil_temperature_K"].push_back(JsonNumber(bin.oil_temperature));
  }
  json["bins"] = std::move(bins);
  json["marks"] = MarksJson(machine.marks, question.first, question.end, question.end >= machine.end);
  const auto known = machine.parameters.find(question.parameter);
  if (known == machine.parameters.end()) return json;
  for (const auto& [name, value] : known->second.limits)
    json["limits"].push_back({{"name", name}, {"value", value}});
  if (known->second.healthy) AddHealthy(*known->second.healthy, picture, json);
  return json;
}

constexpr std::int64_t kMostRowsListed = 20'000;  ///< of the journal that are searched, the newest
constexpr std::size_t kMostRowsShown = 500;       ///< and told
constexpr std::size_t kMostSamples = 1500;        ///< of a signal of a stroke
constexpr double kMargin = 0.2;                   ///< s shown before and behind a stroke

HttpReply UnknownMachine(const std::string& machine) {
  return ErrorReply(
      404, Tell("the database has no machine \"{}\"", "die Datenbank hat keine Maschine „{}“", machine));
}

/// Raw signals around a stroke, every so many rows where there are more than can be seen.
nlohmann::json SignalsJson(const RawWindow& raw, const std::map<std::string, std::string>& units) {
  const std::size_t step = raw.time.size() / kMostSamples + 1;
  nlohmann::json json = {{"time_s", nlohmann::json::array()}, {"signals", nlohmann::json::array()}};
  for (std::size_t row = 0; row < raw.time.size(); row += step)
    json["time_s"].push_back(JsonNumber(raw.time[row]));
  for (std::size_t s = 0; s < raw.signals.size(); ++s) {
    nlohmann::json values = nlohmann::json::array();
    for (std::size_t row = 0; row < raw.time.size(); row += step)
      values.push_back(JsonNumber(raw.values[s][row]));
    const auto si = units.find(raw.signals[s]);
    const DisplayUnit unit = DisplayUnitFor(si == units.end() ? "" : si->second);
    json["signals"].push_back(
        {{"name", raw.signals[s]},
         {"unit", {{"factor", unit.factor}, {"offset", unit.offset}, {"name", unit.name}}},
         {"values", std::move(values)}});
  }
  return json;
}

AlarmAction ActionOf(const AlarmRequest& request, const AlarmUser& user, double wall) {
  return [=](AlarmState& alarm, const AlarmMoment& now) -> alarm_machine::Events {
    switch (request.action) {
      case AlarmRequest::Action::kAcknowledge:
        return alarm_machine::Acknowledge(alarm, user, now);
      case AlarmRequest::Action::kShelve:
        return alarm_machine::Shelve(alarm, wall + request.seconds, user, now);
      case AlarmRequest::Action::kUnshelve:
        return alarm_machine::Unshelve(alarm, user, now);
      case AlarmRequest::Action::kComment:
        return alarm_machine::Comment(alarm, user, now);
    }
    return {};
  };
}

nlohmann::json ValveCheckJson(const ValveCheckRecord& record) {
  const ValveCheck& c = record.check;
  const auto figure = [](const ValueWithStd& f) {
    return nlohmann::json{{"value", JsonNumber(f.value)}, {"std", JsonNumber(f.std)}};
  };
  return {{"time_s", JsonNumber(c.time)},
          {"outcome", record.outcome},
          {"detail", record.detail},
          {"german", {{"detail", valve_check::ToldOf(record.detail).german}}},
          {"f0_hz", figure(c.natural_frequency)},
          {"damping", figure(c.damping)},
          {"gain", figure(c.gain)},
          {"dead_time_s", figure(c.dead_time)},
          {"bandwidth_hz", figure(c.bandwidth)},
          {"amplitude", JsonNumber(c.amplitude)},
          {"supply_pressure_Pa", JsonNumber(c.supply_pressure)},
          {"oil_temperature_K", JsonNumber(c.oil_temperature)}};
}

}  // namespace

WatchApi::WatchApi(WatchOptions options, EventFeed& feed, JobQueue& jobs)
    : options_(options),
      trends_(options.database, [&feed] { feed.Publish(R"({"state": "trend"})"); }),
      learning_(options, jobs),
      watcher_(std::move(options), feed) {}

struct WatchApi::Route : ApiRoute {
  HttpReply (WatchApi::*answer)(const HttpRequest&);
};

const std::vector<WatchApi::Route>& WatchApi::Table() {
  static const std::vector<Route> kTable = {
      {{"GET", "watch/overview"}, &WatchApi::Overview},
      {{"GET", "watch/trend"}, &WatchApi::Trend},
      {{"GET", "watch/stroke"}, &WatchApi::Stroke},
      {{"GET", "watch/alarms"}, &WatchApi::Alarms},
      {{"GET", "watch/journal"}, &WatchApi::Journal},
      {{"GET", "watch/valve_checks"}, &WatchApi::ValveChecks},
      {{"GET", "watch/tags"}, &WatchApi::Tags},
      {{"GET", "watch/service"}, &WatchApi::Service},
      {{"GET", "watch/learning"}, &WatchApi::LastLearned},
      {{"POST", "watch/alarms", UserRole::kOperate, true}, &WatchApi::Act},
      {{"POST", "watch/learning", UserRole::kOperate, true}, &WatchApi::Learn},
      {{"POST", "watch/valve_checks", UserRole::kOperate, true}, &WatchApi::AskForValveCheck},
  };
  return kTable;
}

std::vector<ApiRoute> WatchApi::Routes() { return {Table().begin(), Table().end()}; }

HttpReply WatchApi::Answer(const HttpRequest& request) {
  for (const Route& route : Table())
    if (request.method == route.method && request.path == std::string(kApi) + route.path)
      return (this->*route.answer)(request);
  return ErrorReply(404, "there is nothing at " + request.path);
}

HttpReply WatchApi::Overview(const HttpRequest&) {
  const auto state = watcher_.state();
  return state->overview.is_null()
             ? ErrorReply(404, Told("the database is being read", "die Datenbank wird gerade gelesen"))
             : JsonReply(state->overview);
}

HttpReply WatchApi::Alarms(const HttpRequest&) {
  const auto state = watcher_.state();
  if (state->overview.is_null())
    return ErrorReply(404, Told("the database is being read", "die Datenbank wird gerade gelesen"));
  return JsonReply({{"alarms", state->alarms}, {"now_s", WallSeconds()}});
}

namespace {

/// Registers say what the running feed serves.
void ShowServed(const nlohmann::json& links, nlohmann::json& tags) {
  std::vector<ServedRegisters> served;
  for (const nlohmann::json& link : links)
    for (const nlohmann::json& part : link.value("registers", nlohmann::json::array()))
      served.push_back({part.value("first", 0), part.value("values", std::vector<std::uint16_t>())});
  for (nlohmann::json& tag : tags) {
    if (tag["feed"] != "modbus") continue;
    const int address = std::stoi(tag["address"].get_ref<const std::string&>());
    if (const auto value = ServedValue(served, address, tag["type"])) tag["value"] = *value;
  }
}

}  // namespace

HttpReply WatchApi::Tags(const HttpRequest&) {
  const auto state = watcher_.state();
  auto tags = state->tags.is_null() ? nlohmann::json::array() : state->tags;
  const nlohmann::json service = watcher_.Service();
  auto links =
      service.is_object() ? service.value("feeds", nlohmann::json::array()) : nlohmann::json::array();
  ShowServed(links, tags);
  for (nlohmann::json& link : links) link.erase("registers");
  return JsonReply({{"tags", std::move(tags)}, {"links", links}});
}

HttpReply WatchApi::Service(const HttpRequest&) {
  static_cast<void>(watcher_.state());  // somebody asks: it goes on looking
  return JsonReply({{"service", watcher_.Service()}});
}

HttpReply WatchApi::Trend(const HttpRequest& request) {
  auto question = ParseTrendQuestion(request.query);
  if (!question) return FailureReply(question.error());
  const auto state = watcher_.state();
  const auto machine = state->machines.find(question->machine);
  if (machine == state->machines.end()) return UnknownMachine(question->machine);
  question->end = question->end < 0 ? machine->second.end : std::min(question->end, machine->second.end);
  question->first = std::min(question->first, question->end);
  const auto database = Database::OpenReadOnly(options_.database);
  if (!database) return FailureReply(database.error());
  const auto picture = trends_.Picture(*database, machine->second.id, question->parameter, question->first,
                                       question->end, question->bins);
  if (!picture) return FailureReply(picture.error());
  return JsonReply(TrendJson(*question, *picture, machine->second));
}

HttpReply WatchApi::Stroke(const HttpRequest& request) {
  const auto number = WholeNumberOf(request.query, "stroke");
  if (!number) return FailureReply(number.error());
  const auto state = watcher_.state();
  const auto machine = state->machines.find(request.Query("machine"));
  if (machine == state->machines.end()) return UnknownMachine(request.Query("machine"));
  const std::int64_t stroke = number->value_or(machine->second.end - 1), id = machine->second.id;
  const auto database = Database::OpenReadOnly(options_.database);
  if (!database) return FailureReply(database.error());
  const auto summary = database->SummariesOf(id, stroke, stroke + 1, 1);
  if (!summary) return FailureReply(summary.error());
  if (summary->empty()) return ErrorReply(404, Told("there is no such stroke", "diesen Hub gibt es nicht"));
  const auto runs = database->Runs(id);
  if (!runs) return FailureReply(runs.error());
  std::int64_t run_of_it = 0;
  for (const RunInfo& run : *runs)
    if (run.first_sequence <= stroke) run_of_it = run.id;
  const StrokeSummary& s = summary->front();
  const auto raw = database->LoadRaw(run_of_it, s.begin - kMargin, s.end + kMargin);
  if (!raw) return FailureReply(raw.error());
  if (raw->time.empty())
    return ErrorReply(404, Told("the raw signals of this stroke are not kept",
                                "die Rohsignale dieses Hubs sind nicht aufbewahrt"));
  nlohmann::json json = SignalsJson(*raw, machine->second.signal_units);
  json.update({{"stroke", stroke}, {"begin_s", JsonNumber(s.begin)}, {"end_s", JsonNumber(s.end)}});
  return JsonReply(std::move(json));
}

/// Newest first.
HttpReply WatchApi::Journal(const HttpRequest& request) {
  const std::string machine = request.Query("machine"), alarm = request.Query("alarm");
  const auto journal = AlarmJournal::OpenReadOnly(AlarmJournal::PathFor(options_.database));
  if (!journal)
    return ErrorReply(404, Told("there is no alarm journal beside the database",
                                "neben der Datenbank liegt kein Alarmjournal"));
  const auto last = journal->LastSequence();
  if (!last) return FailureReply(last.error());
  const auto rows = journal->Rows(machine, std::max<std::int64_t>(0, *last - kMostRowsListed));
  if (!rows) return FailureReply(rows.error());
  nlohmann::json list = nlohmann::json::array();
  for (auto row = rows->rbegin(); row != rows->rend() && list.size() < kMostRowsShown; ++row)
    if (alarm.empty() || row->event.alarm == alarm) list.push_back(JournalRowJson(*row));
  return JsonReply({{"journal", std::move(list)}});
}

HttpReply WatchApi::ValveChecks(const HttpRequest& request) {
  const auto state = watcher_.state();
  const auto machine = state->machines.find(request.Query("machine"));
  if (machine == state->machines.end()) return UnknownMachine(request.Query("machine"));
  const auto database = Database::OpenReadOnly(options_.database);
  if (!database) return FailureReply(database.error());
  const auto checks = database->ValveChecks(machine->second.id);
  if (!checks) return FailureReply(checks.error());
  nlohmann::json list = nlohmann::json::array();
  for (const ValveCheckRecord& check : *checks) list.push_back(ValveCheckJson(check));
  return JsonReply({{"valve_checks", std::move(list)}});
}

HttpReply WatchApi::AskForValveCheck(const HttpRequest& request) {
  const auto machine = ParseText(request.body, "machine");
  if (!machine) return FailureReply(machine.error());
  if (!watcher_.state()->machines.contains(*machine)) return UnknownMachine(*machine);
  const Status asked = options_.valve_check(*machine);
  return asked ? JsonReply({{"machine", *machine}}) : FailureReply(asked.error());
}

HttpReply WatchApi::LastLearned(const HttpRequest& request) {
  return JsonReply({{"learning", learning_.Last(request.Query("machine"))}});
}

HttpReply WatchApi::Learn(const HttpRequest& request) {
  auto asked = ParseLearnRequest(request.body);
  if (!asked) return FailureReply(asked.error());
  asked->user = Acting(request, asked->user);
  const auto job = learning_.Start(*asked);
  return job ? JsonReply({{"job", *job}}, 202) : FailureReply(job.error());
}

std::string WatchApi::Acting(const HttpRequest& request, const std::string& said) const {
  return options_.user == request.who.name && !said.empty() ? said : request.who.name;
}

/// One transaction of the journal, as `hydroscope alarms` makes it: a running service takes it over (ActOnAlarm).
HttpReply WatchApi::Act(const HttpRequest& request) {
  const auto asked = ParseAlarmRequest(request.body);
  if (!asked) return FailureReply(asked.error());
  auto journal = AlarmJournal::OpenExisting(AlarmJournal::PathFor(options_.database));
  if (!journal) return FailureReply(journal.error());
  const double wall = WallSeconds();
  const AlarmUser user{Acting(request, asked->user), asked->comment};
  const auto changed = ActOnAlarm(*journal, asked->machine, asked->alarm, wall, ActionOf(*asked, user, wall));
  if (!changed) return FailureReply(changed.error());
  watcher_.LookNow();
  return JsonReply({{"machine", asked->machine}, {"alarm", asked->alarm}, {"changed", *changed}});
}

}  // namespace hydroscope
