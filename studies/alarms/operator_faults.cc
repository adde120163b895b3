#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "acquisition/modbus/link.h"
#include "dds/domains.h"
#include "host/output.h"
#include "simulator/dds/publisher.h"
#include "storage/mounted_disk.h"
#include "studies/alarms/operator_view.h"
#include "studies/fault_table.h"
#include "studies/live/live_benchmarks.h"
#include "studies/live/write_lock.h"

namespace hydroscope {
namespace {

using Json = nlohmann::json;

constexpr double kSeenWithin = 5;      // s, in every place: "within seconds"
constexpr double kLockSeen = 13;       // s: SQLite waits for 10 s before it says that it is locked
constexpr double kHealthBack = 30;     // s
constexpr double kToldEverywhere = 3;  // s in which what was told of the fault before has arrived everywhere
constexpr double kIdle = 62;           // s without a stroke after which a press counts as idle, and a little
constexpr double kYear = 365 * 86400.0;
constexpr char kFaketime[] = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1";

/// One printed line for each fault.
class OperatorTable {
 public:
  OperatorTable() { fmt::print("\n{:<46} {:>8}   {}\n", "fault", "back", "seen after"); }

  void Row(const std::string& what, const Sighting& seen, std::optional<double> back, double within,
           const std::string& wrong = "") {
    const auto in_time = [&](const std::optional<double>& s) { return s && *s <= within; };
    const bool ok = in_time(seen.log) && in_time(seen.status) && in_time(seen.registers) &&
                    in_time(seen.sparkplug) && in_time(seen.dds) && back && wrong.empty();
    Line(what, back, ok, seen.Text(), wrong);
  }
  /// A fault that has no alarm, or that is seen in other places.
  void Line(const std::string& what, std::optional<double> back, bool ok, const std::string& seen,
            const std::string& wrong = "") {
    fmt::print("{:<46} {:>8}   {}{}{}: {}\n", what, back ? fmt::format("{:.1f} s", *back) : "-",
               ok ? "reached" : "MISSED", wrong.empty() ? "" : " ", wrong, seen);
    std::fflush(stdout);
    missed_ += !ok;
  }
  int missed() const { return missed_; }

 private:
  int missed_ = 0;
};

/// Press, service, and everything that an operator looks at.
struct OperatorRig {
  LiveRig& rig;
  CampaignBroker& broker;
  OperatorView& view;
  OperatorTable& table;

  /// Rows that are lacking so far.
  std::int64_t Lost() const {
    const auto status = rig.Ask();
    return status ? SumOverAxes(*status, "missing_rows") + SumOverAxes(*status, "skipped_rows") : -1;
  }
  bool WaitForStrokes(double patience = 60) const {
    return rig
        .WaitFor([](const Json& s) { return s.at("writer").at("strokes").get<std::int64_t>() > 0; }, patience)
        .has_value();
  }
  /// Until status, registers, Sparkplug and DDS all speak.
  bool Ready() const { return WaitForStrokes() && view.WaitForHealth(kHealthBack).has_value(); }
};

void TwoSenders(OperatorRig& o) {
  const std::int64_t lost = o.Lost();
  o.view.Mark();
  o.rig.StartRival();
  const Sighting seen = o.view.Watch({"two_senders", "alarm=two_senders"}, kHealthBack);
  const std::int64_t since = o.Lost() - lost;
  o.rig.StopRival();
  o.table.Row("two senders of the same channels", seen, o.view.WaitForHealth(kHealthBack), kSeenWithin,
              since == 0 ? "" : fmt::format("{} rows were lost", since));
}

/// Batches under the press's own session from another program: far numbers, then rows a little ahead.
void ForgedBatches(OperatorRig& o) {
  const auto status = o.rig.Ask();
  if (!status) return o.table.Line("forged batches", std::nullopt, false, "the service does not answer");
  SamplePublisher::Options options;
  options.network = {.domain = o.rig.domain(),
                     .udp = true,
                     .shared_memory = false,
                     .interfaces = {"127.0.0.1"},
                     .peers = {}};
  for (const auto& sender : status->at("senders"))  // that of the press, not of its slow channels
    if (!sender.at("name").get<std::string>().empty())
      options.session = sender.at("session").get<std::uint64_t>();
  for (const auto& channel : status->at("channels"))
    if (const auto name = channel.at("name").get<std::string>();
        !name.ends_with("p_0") && !name.ends_with("T_oil")) {
      options.channels.push_back(name);
      options.units.emplace_back("1");
    }
  std::optional<double> back;
  Sighting seen;
  const std::int64_t lost = o.Lost();
  {
    const auto forger = SamplePublisher::Create(options);
    if (!forger) return o.table.Line("forged batches", std::nullopt, false, forger.error().text);
    for (const double end = Now() + kSeenWithin; Now() < end && (*forger)->readers() == 0;) Sleep(0.02);
    o.view.Mark();
    const std::vector<double> values(10 * options.channels.size(), 1e7);
    for (std::uint64_t k = 0; k < 140; ++k) {
      const std::uint64_t near = o.rig.Ask()->at("axes").at(0).at("counters").at("rows").get<std::uint64_t>();
      static_cast<void>(
          (*forger)->Write(k < 70 ? 1'000'000'000 * (k + 1) : near + 200, 1, 1'000'000, 10, values));
      Sleep(0.01);
    }
    seen = o.view.Watch({"two_senders", "alarm=two_senders"}, kHealthBack);
  }
  back = o.view.WaitForHealth(kHealthBack);
  const auto after = o.rig.Ask();
  const std::int64_t since = o.Lost() - lost;
  const std::int64_t contradicting = after ? SumOverAxes(*after, "contradicting_rows") : -1;
  o.table.Row("140 forged batches, far and near numbers", seen, back, kSeenWithin,
              since == 0 && contradicting == 0
                  ? ""
                  : fmt::format("{} rows were lost, {} contradict others", since, contradicting));
}

void LinkLost(OperatorRig& o, const char* what) {
  o.view.Mark();
  o.rig.press().Say("dds mute");
  const Sighting seen = o.view.Watch({"no_samples", "alarm=no_samples"}, kHealthBack);
  o.rig.press().Say("dds on");
  o.table.Row(what, seen, o.view.WaitForHealth(kHealthBack), kSeenWithin);
}

void LinkLostWhileIdle(OperatorRig& o) {
  o.rig.press().Say("pause");
  Sleep(kIdle);
  LinkLost(o, "link lost while the press is idle");
  o.rig.press().Say("run");
}

bool Dropped(const OperatorRig& o) {
  const auto status = o.rig.Ask();
  return !status || status->at("writer").at("dropped_strokes") != 0 ||
         status->at("writer").at("dropped_rows") != 0 || status->at("writer").at("refused") != 0;
}

/// Something befalls the database's file; another one is begun.
void LoseDatabase(OperatorRig& o, const char* what, const char* log, const std::function<void()>& befalls) {
  Sleep(kToldEverywhere);
  const auto before = o.rig.Ask();
  const auto databases = before ? before->at("writer").at("databases").get<int>() : 0;
  o.view.Mark();
  befalls();
  const Sighting seen = o.view.Watch({"database_begun_anew", log}, kHealthBack);
  const auto anew = o.rig.WaitFor(
      [&](const Json& s) {
        return s.at("writer").at("databases").get<int>() > databases &&
               s.at("writer").at("state") == "writing";
      },
      kHealthBack);
  const auto back = o.view.WaitForHealth(kHealthBack);
  const std::string wrong = !anew                                   ? "no other database was begun"
                            : Dropped(o)                            ? "something was dropped"
                            : !o.view.Logged("database_begun_anew") ? "not in the log"
                                                                    : "";
  o.table.Row(what, seen, back, kSeenWithin, wrong);
}

void DeleteDatabase(OperatorRig& o) {
  LoseDatabase(o, "database deleted", "state=gone", [&] {
    for (const char* part : {"", "-wal", "-shm"}) std::filesystem::remove(o.rig.database() + part);
  });
}

/// Of a young database all lies in the write-ahead log; what is overwritten must be what is read.
void DamageDatabase(OperatorRig& o) {
  for (const double end = Now() + kHealthBack;
       Now() < end && std::filesystem::file_size(o.rig.database()) < (256 << 10);)
    Sleep(0.2);
  LoseDatabase(o, "database overwritten in part", "error database_begun_anew", [&] {
    std::fstream file(o.rig.database(), std::ios::in | std::ios::out | std::ios::binary);
    file << std::string(64 << 10, 'x');
  });
}

void LockDatabaseSeen(OperatorRig& o) {
  o.view.Mark();
  Sighting seen;
  {
    const WriteLock lock(o.rig.database());
    seen = o.view.Watch({"not_stored", "state=locked"}, kHealthBack);
  }
  o.table.Row("database locked by another program", seen, o.view.WaitForHealth(kHealthBack), kLockSeen,
              Dropped(o) ? "something was dropped" : "");
}

void FillDiskSeen(OperatorRig& o) {
  o.view.Mark();
  const auto room = std::filesystem::space(o.rig.File("")).available;
  std::ofstream(o.rig.File("ballast"), std::ios::binary)
      << std::string(room - std::min<std::size_t>(room, 256 << 10), 'x');
  const Sighting seen = o.view.Watch({"not_stored", "state=disk_full"}, kHealthBack);
  std::filesystem::remove(o.rig.File("ballast"));
  o.table.Row("disk full", seen, o.view.WaitForHealth(kHealthBack), kSeenWithin,
              Dropped(o) ? "something was dropped" : "");
}

void KillService(OperatorRig& o) {
  o.view.Mark();
  o.rig.service().End(SIGKILL);
  const double begin = Now();
  while (o.view.Register(0) && Now() - begin < kSeenWithin) Sleep(0.02);
  const double silent = Now() - begin;
  o.rig.StartService();
  const auto back = o.rig.WaitFor(
      [](const Json& s) { return s.at("writer").at("rows").get<std::int64_t>() > 0; }, kHealthBack);
  o.table.Line(
      "service killed (kill -9), started again", back, back && o.view.Logged("run_recovered"),
      fmt::format("registers silent after {:.1f} s; the log of the next life tells run_recovered", silent));
  o.Ready();
}

/// More Modbus clients than are allowed, all but one of them idle.
void ManyClients(OperatorRig& o, int port) {
  std::vector<std::unique_ptr<ModbusLink>> idle;
  for (int k = 0; k < 16; ++k) {
    idle.push_back(std::make_unique<ModbusLink>("127.0.0.1", port, 1, 1));
    idle.back()->Connect();
  }
  const double begin = Now();
  while (!o.view.Register(0) && Now() - begin < kSeenWithin) Sleep(0.05);
  const double served = Now() - begin;
  const auto status = o.rig.Ask();
  std::string state;
  if (status)
    for (const auto& feed : status->at("feeds"))
      if (feed.at("name").get<std::string>().starts_with("modbus"))
        state = feed.at("state").get<std::string>();
  o.table.Line("16 idle Modbus clients and one more", served, served < kSeenWithin,
               fmt::format("status says \"{}\"", state));
}

void StepPressClock(OperatorRig& o, const char* what, double seconds) {
  const std::int64_t lost = o.Lost();
  const auto before = o.rig.Ask();
  o.rig.press().Say(fmt::format("clock {:.0f}", seconds));
  Sleep(3);
  const auto after = o.rig.Ask();
  const bool told =
      before && after && SumOverAxes(*after, "clock_jumps") > SumOverAxes(*before, "clock_jumps");
  o.table.Line(fmt::format("clock of the press {}", what), std::nullopt, told && o.Lost() == lost,
               told ? "status counts clock_jumps; no row lost" : "not told");
}

/// The clock that processes see, by libfaketime; the monotonic one goes on. What share memory have one computer's clock: it is
/// set for both, or for a service that hears the press over a network.
void StepComputerClock(OperatorRig& o, const char* whose, const std::string& transport, bool press_too,
                       const std::vector<const char*>& offsets) {
  const auto set = [&](const std::string& offset) {
    std::ofstream(o.rig.File("faketime")) << offset << "\n";
  };
  set("+0");
  const Child::Environment faked = {{"LD_PRELOAD", kFaketime},
                                    {"FAKETIME_TIMESTAMP_FILE", o.rig.File("faketime")},
                                    {"FAKETIME_NO_CACHE", "1"},
                                    {"FAKETIME_DONT_FAKE_MONOTONIC", "1"}};
  o.rig.StartAgain(transport, press_too ? faked : Child::Environment{}, faked);
  o.Ready();
  for (const char* offset : offsets) {
    const std::int64_t lost = o.Lost();
    const auto before = o.rig.Ask();
    set(offset);
    const auto stroke = o.rig.WaitFor(
        [&](const Json& s) {
          return before && s.at("writer").at("strokes") > before->at("writer").at("strokes");
        },
        kHealthBack);
    const auto after = o.rig.Ask();
    bool negative = false;
    if (after)
      for (const char* list : {"sources", "channels", "senders"})
        for (const auto& item : after->at(list))
          negative = negative || (item.at("age_s").is_number() && item.at("age_s").get<double>() < 0);
    const std::int64_t lacking = o.Lost() - lost;
    o.table.Line(
        fmt::format("clock of the {} {}", whose, offset == std::string_view("+0") ? "right again" : offset),
        stroke, stroke && lacking == 0 && !negative,
        fmt::format("{}, {}",
                    lacking == 0 ? "no row lost, strokes go on" : fmt::format("{} rows were lost", lacking),
                    negative ? "ages below zero" : "no age below zero"));
  }
}

/// `brief`: only the one step that tells most.
void StepComputerClocks(OperatorRig& o, bool brief) {
  if (access(kFaketime, R_OK) != 0)
    return fmt::print("clock of the computer: not tried, libfaketime is not installed (scripts/setup.sh)\n");
  if (brief) return StepComputerClock(o, "computer of both", "default", true, {"-2h"});
  StepComputerClock(o, "computer of both", "default", true, {"-2h", "+1h", "+10y", "+0"});
  StepComputerClock(o, "service alone", "udp", false, {"-2h", "+1h", "+10y", "+0"});
  o.rig.StartAgain("default", {}, {});
  o.Ready();
}

/// An authority and certificates of the broker, by openssl, in `folder`; lines of listeners that show them.
std::string TlsListeners(const std::string& folder, int port) {
  const auto run = [&](const std::string& words) {
    return std::system(fmt::format("cd '{}' && openssl {} > openssl.log 2>&1", folder, words).c_str()) == 0;
  };
  const std::string key = "-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -noenc -days 1";
  bool made = true;
  for (const char* authority : {"authority", "stranger"})
    made = made && run(fmt::format("req -x509 {} -subj /CN={} -addext "
                                   "basicConstraints=critical,CA:TRUE -keyout {}.key -out {}.pem",
                                   key, authority, authority, authority));
  for (const auto& [name, alternative] :
       {std::pair("sound", "IP:127.0.0.1"), {"other", "DNS:elsewhere.example"}, {"old", "IP:127.0.0.1"}})
    made = made && run(fmt::format("req -x509 {} -subj /CN={} -CA authority.pem -CAkey authority.key -addext "
                                   "subjectAltName={} -keyout {}.key -out {}.pem",
                                   key, name, alternative, name, name));
  // Signed anew, valid for no time at all.
  made = made &&
         run("req -new -key old.key -subj /CN=old -addext subjectAltName=IP:127.0.0.1 -out old.csr") &&
         run("x509 -req -in old.csr -CA authority.pem -CAkey authority.key -set_serial 2 -days 0 "
             "-copy_extensions copy -out old.pem");
  if (!made) return "";
  std::string lines;
  for (const char* name : {"sound", "other", "old"})
    lines += fmt::format(
        "listener {} 127.0.0.1\nallow_anonymous true\ncafile {}/authority.pem\ncertfile {}/{}.pem\n"
        "keyfile {}/{}.key\n",
        port++, folder, folder, name, folder, name);
  return lines;
}

/// The broker cannot be spoken to, and why: each reason in words of its own, in status and log.
void BrokerFaults(OperatorRig& o, int tls_port) {
  struct Fault {
    const char *what, *words;
    std::string broker, authority;
  };
  const auto ssl = [&](int port) { return fmt::format("ssl://127.0.0.1:{}", port); };
  const std::string good = o.rig.File("authority.pem"), stranger = o.rig.File("stranger.pem");
  for (const Fault& fault :
       {Fault{"broker: certificate of another authority", "of another authority", ssl(tls_port), stranger},
        Fault{"broker: certificate of another name", "made for another name", ssl(tls_port + 1), good},
        Fault{"broker: certificate expired", "has expired", ssl(tls_port + 2), good},
        Fault{"broker: down", "nobody listens", ssl(tls_port + 3), good}}) {
    o.rig.service().End(SIGTERM);
    o.rig.SetFeeds(fmt::format("\n[feeds.sparkplug]\nbroker = \"{}\"\nca_file = \"{}\"\n", fault.broker,
                               fault.authority));
    o.view.Mark();
    o.rig.StartService();
    const auto status = o.rig.WaitFor(
        [&](const Json& s) {
          return std::any_of(s.at("feeds").begin(), s.at("feeds").end(), [&](const auto& feed) {
            return feed.at("state").template get<std::string>().find(fault.words) != std::string::npos;
          });
        },
        kHealthBack);
    const double begin = Now();
    while (!o.view.Logged(fault.words) && Now() - begin < kSeenWithin) Sleep(0.05);
    const bool logged = o.view.Logged(fault.words);
    o.table.Line(fault.what, std::nullopt, status && *status < kSeenWithin && logged,
                 fmt::format("status after {:.1f} s{}: \"... {}\"", status.value_or(kHealthBack),
                             logged ? " and log" : ", not in the log", fault.words));
  }
}

}  // namespace

int RunOperatorFaults(const LiveFaultOptions& options) {
  const int own = static_cast<int>(getpid());
  const std::string folder =
      (std::filesystem::temp_directory_path() / fmt::format("hydroscope-seen-{}", own)).string();
  const storage_test::MountedDisk disk(folder, "96m");
  const int port = 41'000 + own % 10'000, tls_port = 51'000 + 4 * (own % 2'500), domain = FreeDomain();
  const std::string listeners = options.brief ? "" : TlsListeners(folder, tls_port);
  const auto broker = CampaignBroker::Create(folder, listeners);
  if (!broker) return ReportError(broker.error());
  const auto dds = AlarmListener::Create(domain);
  if (!dds) return ReportError(dds.error());
  LiveRig rig({.axes = 2,
               .seed = options.seed,
               .folder = folder,
               .feeds = OperatorView::Feeds((*broker)->address(), domain, port)});
  OperatorView view(rig, **broker, **dds, port);
  rig.StartPress();
  rig.StartService();
  OperatorTable table;
  OperatorRig o{rig, **broker, view, table};
  if (!o.Ready()) return ReportError({ErrorKind::kInternal, "no stroke was stored within 60 s"});
  if (!rig.press().Alive())
    return ReportError(
        {ErrorKind::kInternal,
         "the press did not start: do its ports belong to another program? See " + rig.File("press.log")});
  TwoSenders(o);
  ForgedBatches(o);
  LinkLost(o, "link lost while the press works");
  ManyClients(o, port);
  DeleteDatabase(o);
  DamageDatabase(o);
  KillService(o);
  StepComputerClocks(o, options.brief);
  if (!options.brief) {
    LinkLostWhileIdle(o);
    for (const auto& [what, seconds] :
         {std::pair("-2 h", -7200.0), {"+1 h", 3600.0}, {"+10 y", 10 * kYear}, {"back", -10 * kYear}})
      StepPressClock(o, what, seconds);
    LockDatabaseSeen(o);
    if (disk.ok())
      FillDiskSeen(o);
    else
      fmt::print("disk full: not tried, mounting a small disk needs the right to mount\n");
    if (listeners.empty())
      fmt::print("certificates: not tried, openssl is not installed\n");
    else
      BrokerFaults(o, tls_port);
  }
  rig.service().End(SIGTERM);
  if (!disk.ok()) std::filesystem::remove_all(folder);
  return table.missed() == 0 ? 0 : 1;
}

}  // namespace hydroscope
