#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "alarms/alarm_action.h"
#include "alarms/alarm_metrics.h"
#include "cli/alarms_learning.h"
#include "cli/alarms_scada.h"
#include "cli/command_answer.h"
#include "cli/commands.h"
#include "cli/user_name.h"
#include "core/contains.h"
#include "core/counted_words.h"
#include "core/printable.h"
#include "core/shell_word.h"
#include "core/time_text.h"
#include "host/real_clock.h"
#include "live/service_socket.h"
#include "monitor/alarm_json.h"
#include "storage/alarm_journal.h"
#include "storage/database.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {
namespace {

using Json = nlohmann::json;

struct AlarmsArguments {
  std::string db, modbus, machine, json, alarm, user, comment, duration = "8h";
  std::int64_t after = 0, last = 0;
  int modbus_acknowledge = 0;
};

AlarmUser UserOf(const AlarmsArguments& a) { return {a.user.empty() ? UserName() : a.user, a.comment}; }

/// "8h", "30m", "90s", "2d" in s.
Result<double> Duration(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  const std::string unit(end);
  const double factor = unit == "s" ? 1 : unit == "m" ? 60 : unit == "h" ? 3600 : unit == "d" ? 86400 : 0;
  if (!(number > 0) || !std::isfinite(number) || factor == 0)
    return UsageError("--for {}: expected a time such as 30m, 8h or 2d", text);
  return number * factor;
}

/// When the alarm was raised, and until when it is put aside; "" if neither is known.
std::string Since(const AlarmState& alarm) {
  std::string text;
  if (CountsFrom1970(alarm.raised_wall)) text = ", since " + LocalTimeText(alarm.raised_wall);
  if (alarm.shelved_until) text += ", shelved until " + LocalTimeText(*alarm.shelved_until);
  return text;
}

struct Listed {
  std::string machine;
  AlarmState alarm;
};

/// Every alarm that the journal knows, at rest or not.
Result<std::vector<Listed>> KnownAlarms(const AlarmJournal& journal, const AlarmsArguments& a) {
  const auto machines = TRY(journal.Machines());
  // A journal that nothing ever came into knows no machine, and none of them has an alarm.
  if (!a.machine.empty() && !machines.empty() && !Contains(machines, a.machine))
    return BadInput("the journal has no machine \"{}\"; it has: {}", a.machine, fmt::join(machines, ", "));
  std::vector<Listed> alarms;
  for (const std::string& machine : machines) {
    if (!a.machine.empty() && machine != a.machine) continue;
    const auto axis = TRY(journal.Axis(machine));
    for (const AlarmState& alarm : axis.alarms) alarms.push_back({machine, alarm});
  }
  return alarms;
}

/// Those that are not at rest, as the list numbers them.
Result<std::vector<Listed>> ListedAlarms(const AlarmJournal& journal, const AlarmsArguments& a) {
  auto alarms = KnownAlarms(journal, a);
  if (alarms) std::erase_if(*alarms, [](const Listed& l) { return AtRest(l.alarm); });
  return alarms;
}

Result<AlarmJournal> OpenJournal(const AlarmsArguments& a, bool to_change = false) {
  if (a.db.empty()) return UsageError("--db is missing: the database that replay or serve fills");
  const std::string path = AlarmJournal::PathFor(a.db);
  return to_change ? AlarmJournal::OpenExisting(path) : AlarmJournal::OpenReadOnly(path);
}

/// Machines of which the list is no all-clear: the healthy machine is being learned, and nothing is judged. The journal
/// speaks of a machine from the first judgement on.
Result<std::vector<LearningMachine>> NotJudged(AlarmJournal& journal, const AlarmsArguments& a) {
  auto database = Database::OpenReadOnly(a.db);
  if (!database) return std::vector<LearningMachine>{};  // moved away, and the journal speaks for itself
  const auto machines = TRY(database->MachineNames());
  std::vector<std::string> learning;
  for (const std::string& machine : machines) {
    if (!a.machine.empty() && machine != a.machine) continue;
    const auto axis = TRY(journal.Axis(machine));
    if (!axis.monitor.judges()) learning.push_back(machine);
  }
  return LearningOf(*database, a.db, journal, learning);
}

Status List(const AlarmsArguments& a) {
  auto journal = TRY(OpenJournal(a));
  const auto alarms = TRY(ListedAlarms(journal, a));
  const auto not_judged = TRY(NotJudged(journal, a));
  const std::string not_stored = WhyNothingIsStored(a.db);
  Json document = {{"alarms", Json::array()},
                   {"not_judged", Json::array()},
                   {"learning", Json::array()},
                   {"not_stored", not_stored}};
  std::string text = !not_stored.empty()
                         ? fmt::format("THIS IS OLD: the service stores nothing now, alarms neither: {}\n",
                                       Printable(not_stored))
                     : alarms.empty() ? "no alarm stands\n"
                                      : "";
  if (!not_judged.empty()) text += "not judged yet, the healthy machine is being learned:";
  for (const LearningMachine& one : not_judged) {
    document["not_judged"].push_back(one.machine);
    document["learning"].push_back(
        {{"machine", one.machine}, {"learned", one.learned}, {"needed", one.needed}});
    text += not_judged.size() == 1 ? " " : "\n     ";
    text += Printable(LearningText(one));
  }
  if (!not_judged.empty()) text += "\n";
  for (std::size_t i = 0; i < alarms.size(); ++i) {
    const auto& [machine, alarm] = alarms[i];
    document["alarms"].push_back(AlarmJson(machine, alarm));
    document["alarms"].back()["number"] = i + 1;
    text += fmt::format("{:>3}  {:<5} {:<11} {} / {}{}\n     {}\n", i + 1, StateName(alarm),
                        SeverityName(alarm.severity), Printable(machine), Printable(alarm.id), Since(alarm),
                        Printable(alarm.text));
  }
  if (!alarms.empty())
    text += "acknowledge with `hydroscope alarms --db " + ShellWord(a.db) +
            " ack NUMBER`, or by name MACHINE/ALARM\n";
  return Answer(text, document, a.json);
}

enum class Which { kStanding, kKnown };

/// The alarm meant by a number of the list, by "machine/alarm" or by an id that only one machine has; by name
/// one that is at rest too, if `which` says so.
Result<Listed> Find(const AlarmJournal& journal, const AlarmsArguments& a, Which which) {
  const bool number =
      !a.alarm.empty() && std::ranges::all_of(a.alarm, [](char c) { return c >= '0' && c <= '9'; });
  const auto alarms =
      TRY(number || which == Which::kStanding ? ListedAlarms(journal, a) : KnownAlarms(journal, a));
  std::vector<Listed> found;
  for (std::size_t i = 0; i < alarms.size(); ++i) {
    const auto& [machine, alarm] = alarms[i];
    if (number ? a.alarm == std::to_string(i + 1)
               : a.alarm == alarm.id || a.alarm == machine + "/" + alarm.id)
      found.push_back(alarms[i]);
  }
  if (found.size() == 1) return found.front();
  if (found.size() > 1) return UsageError("several machines have {}; say MACHINE/{}", a.alarm, a.alarm);
  return UsageError(
      "no {} alarm {}; `hydroscope alarms --db {} {}",
      number || which == Which::kStanding ? "standing" : "known", a.alarm, ShellWord(a.db),
      number || which == Which::kStanding ? "list` shows them" : "journal` shows those that ever stood");
}

Status Act(const AlarmsArguments& a, const char* done, const AlarmAction& act,
           Which which = Which::kStanding) {
  auto journal = TRY(OpenJournal(a, true));
  const auto found = TRY(Find(journal, a, which));
  const auto changed = TRY(ActOnAlarm(journal, found.machine, found.alarm.id, WallSeconds(), act));
  return Answer(fmt::format("{} / {}{}\n", Printable(found.machine), Printable(found.alarm.id),
                            changed ? std::string(" ") + done : ": nothing to do"),
                {{"machine", found.machine}, {"alarm", found.alarm.id}, {"changed", changed}}, a.json);
}

Status Acknowledge(const AlarmsArguments& a) {
  return Act(a, "acknowledged", [&](AlarmState& alarm, const AlarmMoment& now) {
    return alarm_machine::Acknowledge(alarm, UserOf(a), now);
  });
}

Status Shelve(const AlarmsArguments& a) {
  const auto duration = TRY(Duration(a.duration));
  return Act(a, "shelved", [&](AlarmState& alarm, const AlarmMoment& now) {
    return alarm_machine::Shelve(alarm, now.wall + duration, UserOf(a), now);
  });
}

Status Unshelve(const AlarmsArguments& a) {
  return Act(a, "unshelved", [&](AlarmState& alarm, const AlarmMoment& now) {
    return alarm_machine::Unshelve(alarm, UserOf(a), now);
  });
}

Status Comment(const AlarmsArguments& a) {
  if (a.comment.empty()) return UsageError("--comment is missing: what is to be written");
  return Act(
      a, "commented",
      [&](AlarmState& alarm, const AlarmMoment& now) {
        return alarm_machine::Comment(alarm, UserOf(a), now);
      },
      Which::kKnown);
}

Status SetOutOfService(const AlarmsArguments& a, bool out) {
  return Act(
      a, out ? "taken out of service" : "back in service",
      [&](AlarmState& alarm, const AlarmMoment& now) {
        return alarm_machine::SetOutOfService(alarm, out, UserOf(a), now);
      },
      Which::kKnown);
}

Status Journal(const AlarmsArguments& a) {
  const auto journal = TRY(OpenJournal(a));
  auto rows = TRY(journal.Rows(a.machine, a.after));
  if (a.last > 0 && static_cast<std::int64_t>(rows.size()) > a.last)
    rows.erase(rows.begin(), rows.end() - a.last);
  std::string text = rows.empty() ? "nothing stands in the journal\n" : "";
  Json document = {{"journal", Json::array()}};
  std::map<std::string, CountedWords> counted;
  for (const JournalRow& row : rows) {
    const AlarmEvent& e = row.event;
    if (!counted.contains(row.machine)) counted[row.machine] = CountedWordsIn(a.db, row.machine);
    document["journal"].push_back(JournalRowJson(row));
    const std::string when = e.stroke < 0 ? "" : fmt::format("{} {}", counted[row.machine].one, e.stroke);
    text +=
        fmt::format("{:>6}  {}  {:<14} {} / {}: {}{}{}{}{}\n", row.sequence, LocalTimeText(row.wall), when,
                    Printable(row.machine), e.alarm.empty() ? "axis" : Printable(e.alarm), Printable(e.event),
                    e.alarm.empty() && !e.text.empty() ? ", " + Printable(e.text) : "",
                    e.state.empty() ? "" : fmt::format(" ({} -> {})", e.state_before, e.state),
                    e.user.empty() ? "" : " by " + Printable(e.user),
                    e.comment.empty() ? "" : ", \"" + Printable(e.comment) + "\"");
  }
  return Answer(text, document, a.json);
}

Status Metrics(const AlarmsArguments& a) {
  const auto journal = TRY(OpenJournal(a));
  const auto rows = TRY(journal.Rows(a.machine));
  const auto listed = TRY(ListedAlarms(journal, a));
  std::vector<AlarmState> states;
  for (const Listed& l : listed) states.push_back(l.alarm);
  const AlarmMetrics m = MeasureAlarms(rows, states, WallSeconds());
  const auto listing = [](const std::vector<std::string>& sources) {
    return sources.empty() ? "none" : fmt::format("{}", fmt::join(sources, ", "));
  };
  std::string text = fmt::format(
      "{} raised in {:.1f} h, {:.2f} per hour; at most {} in 10 minutes, {}\nchattering: {}\nstale: {}\n",
      Counted(m.annunciations, "alarm"), m.hours, m.per_hour, m.most_in_10_minutes,
      Counted(m.floods, "flood"), listing(m.chattering), listing(m.stale));
  Json top = Json::array();
  for (const auto& [source, count] : m.top) {
    text += fmt::format("{:>7}  {}\n", count, Printable(source));
    top.push_back({{"source", source}, {"raised", count}});
  }
  return Answer(text,
                {{"raised", m.annunciations},
                 {"hours", m.hours},
                 {"per_hour", m.per_hour},
                 {"most_in_10_minutes", m.most_in_10_minutes},
                 {"floods", m.floods},
                 {"chattering", m.chattering},
                 {"stale", m.stale},
                 {"top", top}},
                a.json);
}

void AddAlarmsSubcommands(CLI::App& command, const std::shared_ptr<AlarmsArguments>& a, int& exit_code) {
  const auto add = [&](const char* name, const char* text, auto run) {
    CLI::App* sub = command.add_subcommand(name, text);
    RunsAs(*sub, exit_code, [a, run] { return run(*a); });
    return sub;
  };
  const auto on_alarm = [&](const char* name, const char* text, auto run) {
    CLI::App* sub = add(name, text, run);
    sub->add_option("ALARM", a->alarm, "Number of the list, ALARM or MACHINE/ALARM")->required();
    return sub;
  };
  add("list", "Alarms that stand", List);
  on_alarm("ack", "Acknowledge an alarm", Acknowledge);
  on_alarm("shelve", "Put an alarm aside for a while", Shelve)
      ->add_option("--for", a->duration, "How long: 30m, 8h, 2d")
      ->capture_default_str();
  on_alarm("unshelve", "Take an alarm back from the shelf", Unshelve);
  on_alarm("comment", "Write a remark (--comment) about an alarm into the journal", Comment);
  on_alarm("out-of-service", "Take an alarm out of service, for as long as its cause is being worked on",
           [](const AlarmsArguments& o) { return SetOutOfService(o, true); });
  on_alarm("in-service", "Put an alarm back in service",
           [](const AlarmsArguments& o) { return SetOutOfService(o, false); });
  CLI::App* journal = add("journal", "What happened, oldest first", Journal);
  journal->add_option("--after", a->after, "Only rows after this sequence number")
      ->check(CLI::NonNegativeNumber);
  journal->add_option("--last,-n", a->last, "Only the last N rows")->check(CLI::PositiveNumber);
  add("metrics", "Rate, floods, chattering and stale alarms, most frequent sources", Metrics);
}

}  // namespace

void AddAlarmsCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<AlarmsArguments>();
  CLI::App* command =
      app.add_subcommand("alarms", "Alarms that stand, the journal, and what to do with them");
  CLI::Option* db = command->add_option("--db,-d", a->db,
                                        "Database that replay or serve fills; the journal lies beside it");
  CLI::Option* modbus =
      command
          ->add_option("--modbus", a->modbus,
                       "In place of --db: HOST:PORT of the Modbus feed, read as a SCADA system would")
          ->excludes(db);
  command->add_option("--ack", a->modbus_acknowledge, "With --modbus: number of the alarm to acknowledge")
      ->needs(modbus)
      ->check(CLI::Range(1, 65535));
  command->add_option("--machine,-m,--machine-name", a->machine, "Only this machine");
  command->add_option("--json", a->json, "Write the result as JSON; - is stdout");
  command->add_option("--user", a->user, "Who acts (default: the user logged in)");
  command->add_option("--comment", a->comment, "Why, kept in the journal");
  command->fallthrough();
  command->require_subcommand(0, 1);
  command->footer(
      "States after ISA-18.2: UNACK, ACKED, RTNUN (gone, not acknowledged), LTUNK/LTACK "
      "(latched), SHLVD, DSUPR, OOSRV.\n"
      "Examples:\n"
      "  hydroscope alarms --db press.db list\n"
      "  hydroscope alarms --db press.db ack 1 --comment \"seal ordered\"\n"
      "  hydroscope alarms --db press.db shelve internal_leakage --for 8h\n"
      "  hydroscope alarms --db press.db out-of-service press/left/no_samples --comment \"sensor being changed\"\n"
      "  hydroscope alarms --db press.db journal --json -\n"
      "  hydroscope alarms --db press.db metrics\n"
      "  hydroscope alarms --modbus 127.0.0.1:1503 --ack 1");
  AddAlarmsSubcommands(*command, a, exit_code);
  command->callback([a, command, &exit_code] {
    if (!command->get_subcommands().empty()) return;
    exit_code =
        ExitCodeOf(a->modbus.empty() ? List(*a) : ShowScada(a->modbus, a->modbus_acknowledge, a->json));
  });
}

}  // namespace hydroscope
