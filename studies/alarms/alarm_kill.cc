#include <signal.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#include "core/records/alarm_records.h"
#include "host/output.h"
#include "storage/alarm_journal.h"
#include "storage/outbox.h"
#include "studies/alarms/alarm_benchmarks.h"
#include "studies/alarms/alarm_rig.h"

namespace hydroscope {
namespace {

/// A change that the killed process said was stored.
struct Said {
  std::string tag, machine, alarm, state;
  double shelved_until = 0;
};

std::vector<Said> ReadSaid(const std::string& log) {
  std::vector<Said> all;
  std::ifstream file(log);
  std::string line, stored;
  while (std::getline(file, line) && !file.eof()) {  // a line without its end was not said
    std::istringstream in(line);
    Said said;
    if (in >> stored >> said.tag >> said.machine >> said.alarm >> said.state >> said.shelved_until &&
        stored == "stored")
      all.push_back(said);
  }
  return all;
}

struct Counts {
  std::int64_t rows = 0, said = 0, missing = 0, twice = 0, broken_chains = 0, states = 0, wrong_states = 0,
               undelivered = 0, altered = 0, disordered = 0, repeated = 0, left = 0, heard = 0, misheard = 0;
};

/// Every row once, each alarm's rows one chain: the state before is the state after the row before.
void CheckRows(const std::vector<JournalRow>& rows, const std::vector<Said>& said, Counts& counts) {
  std::map<std::string, int> tags;
  std::map<std::pair<std::string, std::string>, std::string> state;
  for (const JournalRow& row : rows) {
    ++tags[row.event.comment];
    std::string& before = state.try_emplace({row.machine, row.event.alarm}, "NORM").first->second;
    counts.broken_chains += before != row.event.state_before;
    before = row.event.state;
  }
  counts.rows = static_cast<std::int64_t>(rows.size());
  counts.said = static_cast<std::int64_t>(said.size());
  for (const Said& s : said) counts.missing += !tags.contains(s.tag);
  for (const auto& [tag, times] : tags) counts.twice += times > 1;
}

/// The alarms as the last life found them, against the last row of each and against what was said of it.
Status CheckStates(const AlarmJournal& journal, const std::vector<JournalRow>& rows,
                   const std::vector<Said>& said, Counts& counts) {
  std::map<std::string, Said> by_tag;
  for (const Said& s : said) by_tag[s.tag] = s;
  std::map<std::pair<std::string, std::string>, const JournalRow*> last;
  for (const JournalRow& row : rows) last[{row.machine, row.event.alarm}] = &row;
  for (int a = 0; a < kAlarmAxes; ++a) {
    auto axis = TRY(journal.Axis(AlarmAxis(a)));
    for (const AlarmState& alarm : axis.alarms) {
      const auto row = last.find({AlarmAxis(a), alarm.id});
      if (row == last.end()) continue;
      ++counts.states;
      const auto word = by_tag.find(row->second->event.comment);
      const bool shelf =
          word == by_tag.end() || word->second.shelved_until == alarm.shelved_until.value_or(0);
      counts.wrong_states += row->second->event.state != StateName(alarm) || !shelf;
    }
  }
  return {};
}

void CheckDelivery(const std::vector<JournalRow>& rows, const std::vector<sparkplug::ToldRow>& told,
                   Counts& counts) {
  std::map<std::int64_t, const JournalRow*> by_sequence;
  for (const JournalRow& row : rows) by_sequence[row.sequence] = &row;
  std::set<std::int64_t> delivered;
  for (const sparkplug::ToldRow& row : told) {
    const auto found = by_sequence.find(row.sequence);
    counts.altered += found == by_sequence.end() || found->second->event.comment != row.comment ||
                      found->second->event.alarm != row.alarm;
    const bool first = !delivered.contains(row.sequence);
    counts.disordered += first && !delivered.empty() && row.sequence < *delivered.rbegin();
    counts.repeated += !first;
    delivered.insert(row.sequence);
  }
  for (const JournalRow& row : rows) counts.undelivered += !delivered.contains(row.sequence);
}

/// DDS keeps no outbox: what it tells must be in the journal, it need not be all of it.
void CheckHeard(const std::vector<JournalRow>& rows, const std::vector<HeardRow>& heard, Counts& counts) {
  std::map<std::int64_t, const JournalRow*> by_sequence;
  for (const JournalRow& row : rows) by_sequence[row.sequence] = &row;
  std::set<std::int64_t> different;
  for (const HeardRow& row : heard) {
    different.insert(row.sequence);
    const auto found = by_sequence.find(row.sequence);
    counts.misheard += found == by_sequence.end() || found->second->event.comment != row.comment ||
                       found->second->event.alarm != row.alarm;
  }
  counts.heard = static_cast<std::int64_t>(different.size());
}

/// Waits until the process has said something, so that there is something to lose on a slow computer too.
void AwaitFirstWord(const std::string& log, std::uintmax_t before) {
  constexpr double kLongest = 60, kLook = 0.005;  // s
  std::error_code none;
  for (double waited = 0; waited < kLongest && std::filesystem::file_size(log, none) <= before;
       waited += kLook)
    Sleep(kLook);
}

/// Lives are killed at a random time: every second one counted from its start, the others from its first word.
Status Kill(const AlarmRig& rig, const AlarmKillOptions& o) {
  std::mt19937_64 random(o.seed);
  std::uniform_real_distribution<double> life(0.05, 0.8);
  ProgressBar progress("killing", "times");
  for (int k = 0; k < o.times; ++k) {
    auto arguments = rig.Load("load");
    arguments.insert(arguments.end(),
                     {"--seed", std::to_string(o.seed * 100'000 + static_cast<std::uint64_t>(k))});
    const std::string log = rig.File("load.log");
    std::error_code none;
    const std::uintmax_t before =
        std::filesystem::exists(log, none) ? std::filesystem::file_size(log, none) : 0;
    Child writer(arguments, log);
    if (k % 2 == 1) AwaitFirstWord(log, before);
    Sleep(life(random));
    if (writer.End(SIGKILL) != 128 + SIGKILL)
      return InternalError("the writing process ended by itself: see {}", log);
    progress.Update(static_cast<double>(k + 1) / o.times, k + 1);
  }
  Child drain(rig.Load("drain"), rig.File("drain.log"));
  if (drain.End(0) != 0) return InternalError("not everything was out within a minute");
  Sleep(1);  // what the broker has, the host gets
  return {};
}

int Report(const Status& sound, const AlarmKillOptions& o, const Counts& c) {
  fmt::print("kill -9 of a process that writes the alarm journal and feeds its outbox, {} times\n", o.times);
  const auto line = [](const char* what, std::int64_t count, const char* required) {
    fmt::print("{:<66} {:>8}   {}\n", what, count, required);
  };
  line("rows in the journal", c.rows, "");
  line("of these acknowledged before a kill", c.said, "");
  line("acknowledged and missing", c.missing, "required 0");
  line("there twice", c.twice, "required 0");
  fmt::print("{:<66} {:>8}   required sound\n", "numbers without gaps from 1, pages sound",
             sound ? "sound" : "NO");
  line("rows whose state before is not the state after the row before", c.broken_chains, "required 0");
  line("alarms whose state, acknowledgement and shelf were looked at", c.states, "");
  line("of these not as the journal and the killed process say", c.wrong_states, "required 0");
  line("rows the broker never passed on", c.undelivered, "required 0");
  line("rows passed on under another number or with other content", c.altered, "required 0");
  line("rows passed on for the first time behind a later one", c.disordered, "required 0");
  line("rows passed on again", c.repeated, "allowed");
  line("rows left in the outbox", c.left, "required 0");
  line("rows that a DDS reader got", c.heard, "without outbox: not all");
  line("rows it got that the journal does not have so", c.misheard, "required 0");
  if (!sound) fmt::print("  {}\n", sound.error().text);
  return sound && c.said > 0 &&
                 c.missing + c.twice + c.broken_chains + c.wrong_states + c.undelivered + c.altered +
                         c.disordered + c.left + c.misheard ==
                     0
             ? 0
             : 1;
}

}  // namespace

int RunAlarmKill(const AlarmKillOptions& o) {
  const auto rig = AlarmRig::Create();
  if (!rig) return ReportError(rig.error());
  if (const Status killed = Kill(**rig, o); !killed) return ReportError(killed.error());
  const auto journal = AlarmJournal::OpenExisting(AlarmJournal::PathFor((*rig)->database()));
  if (!journal) return ReportError(journal.error());
  const auto rows = journal->Rows("");
  if (!rows) return ReportError(rows.error());
  const auto outbox = Outbox::Open(Outbox::PathFor((*rig)->database()));
  if (!outbox) return ReportError(outbox.error());
  const std::vector<Said> said = ReadSaid((*rig)->File("load.log"));
  Counts counts;
  CheckRows(*rows, said, counts);
  if (const Status checked = CheckStates(*journal, *rows, said, counts); !checked)
    return ReportError(checked.error());
  CheckDelivery(*rows, (*rig)->told(), counts);
  CheckHeard(*rows, (*rig)->dds().rows(), counts);
  counts.left = outbox->Count().value_or(-1);
  return Report(journal->CheckIntegrity(), o, counts);
}

}  // namespace hydroscope
