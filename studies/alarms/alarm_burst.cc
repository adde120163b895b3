#include <signal.h>

#include <algorithm>
#include <fstream>

#include "host/output.h"
#include "live/scada_client.h"
#include "storage/alarm_journal.h"
#include "studies/alarms/alarm_benchmarks.h"
#include "studies/alarms/alarm_rig.h"

namespace hydroscope {
namespace {

constexpr double kPoll = 1;               // s between two looks of the SCADA system
constexpr double kStart = 20;             // s until the feeds are there
constexpr double kDeliveryPatience = 20;  // s until everything is out

/// The line of the log that begins like this; "" if it does not come.
std::string WaitForLine(const std::string& log, const std::string& begin) {
  for (const double end = Now() + kStart; Now() < end; Sleep(0.02)) {
    std::ifstream file(log);
    for (std::string line; std::getline(file, line) && !file.eof();)
      if (line.starts_with(begin)) return line;
  }
  return "";
}

/// Numbers that do not follow the one before by one; the first is 1.
std::int64_t OutOfOrder(const std::vector<std::int64_t>& numbers) {
  std::int64_t faults = 0, before = 0;
  for (const std::int64_t number : numbers) faults += number != std::exchange(before, number) + 1;
  return faults;
}

struct Scada {
  std::vector<std::int64_t> rows;
  std::int64_t missed = 0;
  int looks = 0;
};

Result<Scada> PollAtOneHertz(ScadaClient& client, int alarms) {
  Scada scada;
  for (const double begin = Now(); Now() - begin < kDeliveryPatience;) {
    const auto rows = TRY(client.NewRows());
    for (const ScadaRow& row : rows) scada.rows.push_back(row.sequence);
    scada.missed = client.missed();
    ++scada.looks;
    if (static_cast<std::int64_t>(scada.rows.size()) + scada.missed >= alarms) break;
    Sleep(begin + scada.looks * kPoll - Now());
  }
  return scada;
}

}  // namespace

int RunAlarmBurst(const AlarmBurstOptions& o) {
  const auto rig = AlarmRig::Create();
  if (!rig) return ReportError(rig.error());
  auto arguments = (*rig)->Load("burst");
  arguments.insert(arguments.end(),
                   {"--alarms", std::to_string(o.alarms), "--seconds", fmt::format("{}", o.seconds)});
  const std::string log = (*rig)->File("burst.log");
  Child process(arguments, log);
  const std::string modbus = WaitForLine(log, "modbus ");
  if (modbus.empty()) return ReportError({ErrorKind::kInternal, "the feeds did not come up; see " + log});
  auto client = ScadaClient::Connect("127.0.0.1", std::stoi(modbus.substr(modbus.rfind(':') + 1)));
  if (!client) return ReportError(client.error());
  for (const double end = Now() + kStart; Now() < end && !(*rig)->dds().matched();) Sleep(0.02);
  process.Say("go");
  const auto scada = PollAtOneHertz(*client, o.alarms);
  if (!scada) return ReportError(scada.error());
  const std::string raised = WaitForLine(log, "raised in ");
  for (const double end = Now() + kDeliveryPatience;
       Now() < end &&
       static_cast<int>(std::min((*rig)->told().size(), (*rig)->dds().rows().size())) < o.alarms;)
    Sleep(0.05);
  std::vector<std::int64_t> heard;
  for (const HeardRow& row : (*rig)->dds().rows()) heard.push_back(row.sequence);
  std::vector<std::int64_t> told;
  for (const sparkplug::ToldRow& row : (*rig)->told()) told.push_back(row.sequence);
  process.End(SIGKILL);
  const auto journal = AlarmJournal::OpenExisting(AlarmJournal::PathFor((*rig)->database()));
  if (!journal) return ReportError(journal.error());
  const Status sound = journal->CheckIntegrity();
  const auto rows = journal->LastSequence();
  fmt::print("{} alarms {} s, 4 axes\n", o.alarms, raised.empty() ? "not raised" : raised);
  fmt::print("{:<50} {:>8}   required {}\n", "rows in the journal", rows.value_or(0), o.alarms);
  fmt::print("{:<50} {:>8}   required sound\n", "numbers without gaps from 1, pages sound",
             sound ? "sound" : "NO");
  fmt::print("{:<50} {:>8}   required {}\n", "Modbus: rows read by the poller at 1 Hz", scada->rows.size(),
             o.alarms);
  fmt::print("{:<50} {:>8}   required 0\n", "Modbus: rows missed", scada->missed);
  fmt::print("{:<50} {:>8}   required 0\n", "Modbus: rows out of order", OutOfOrder(scada->rows));
  fmt::print("{:<50} {:>8}\n", "Modbus: looks of the poller", scada->looks);
  fmt::print("{:<50} {:>8}   required {}\n", "MQTT: events the host got", told.size(), o.alarms);
  fmt::print("{:<50} {:>8}   required 0\n", "MQTT: events out of order", OutOfOrder(told));
  fmt::print("{:<50} {:>8}   required {}\n", "DDS: events the reader got", heard.size(), o.alarms);
  fmt::print("{:<50} {:>8}   required 0\n", "DDS: events out of order", OutOfOrder(heard));
  const auto wanted = static_cast<std::size_t>(o.alarms);
  return sound && rows && *rows == o.alarms && scada->rows.size() == wanted && scada->missed == 0 &&
                 OutOfOrder(scada->rows) == 0 && told.size() == wanted && OutOfOrder(told) == 0 &&
                 heard.size() == wanted && OutOfOrder(heard) == 0
             ? 0
             : 1;
}

}  // namespace hydroscope
