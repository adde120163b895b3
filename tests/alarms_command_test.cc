// `hydroscope alarms` on a journal with one alarm that stands and one at rest.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <thread>

#include "alarms/alarm_machine.h"
#include "core/expect_ok_fixture.h"
#include "live/service_socket.h"
#include "storage/alarm_journal.h"
#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;
using testing::Not;

constexpr double kRaised = 1772373909;  // s since 1970: 2026-03-01 14:05:09 UTC

class AlarmsCommand : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    auto journal = AlarmJournal::Open(AlarmJournal::PathFor(File("press.db")));
    ASSERT_OK(journal);
    ASSERT_OK(journal->Change("press/left", kRaised, [](AxisContent& axis) -> Status {
      const AlarmMoment now{.time = 10, .wall = kRaised, .stroke = 5};
      const AlarmCondition condition{.value = 2, .std = 0.1, .limit = 1, .unit = "1", .text = "high"};
      for (const char* id : {"no_samples", "seal"})
        axis.Append(alarm_machine::Observe(axis.Alarm(id), {.on_delay = 1}, condition, now));
      axis.Append(alarm_machine::Acknowledge(axis.Alarm("seal"), {"anna", ""}, now));
      axis.Append(alarm_machine::Clear(axis.Alarm("seal"), {}, now));
      return {};
    }));
  }
  Ran Alarms(std::vector<std::string> words) {
    words.insert(words.begin(), {"alarms", "--db", File("press.db")});
    return Run(words);
  }
  std::string State(const std::string& id) {
    auto axis =
        AlarmJournal::OpenExisting(AlarmJournal::PathFor(File("press.db"))).value().Axis("press/left");
    return StateName(axis.value().Alarm(id));
  }
};

TEST_F(AlarmsCommand, TakesAnAlarmOutOfServiceAndBackWithARowForEach) {
  const Ran out = Alarms({"out-of-service", "1", "--user", "meier", "--comment", "sensor is being changed"});
  EXPECT_EQ(out.exit_code, 0) << out.err;
  EXPECT_THAT(out.out, HasSubstr("press/left / no_samples taken out of service"));
  EXPECT_EQ(State("no_samples"), "OOSRV");
  const Ran again = Alarms({"out-of-service", "no_samples"});
  EXPECT_THAT(again.out, HasSubstr("nothing to do"));
  EXPECT_EQ(Alarms({"in-service", "no_samples", "--user", "meier"}).exit_code, 0);
  EXPECT_EQ(State("no_samples"), "UNACK") << "what happened meanwhile is not forgotten";
  const auto rows = Alarms({"journal", "--last", "2", "--json", "-"}).Json().at("journal");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("event"), "out_of_service");
  EXPECT_EQ(rows[0].at("state"), "OOSRV");
  EXPECT_EQ(rows[0].at("user"), "meier");
  EXPECT_EQ(rows[0].at("comment"), "sensor is being changed");
  EXPECT_EQ(rows[1].at("event"), "in_service");
}

TEST_F(AlarmsCommand, TheListSaysSinceWhen) {
  EXPECT_THAT(Alarms({"list"}).out, testing::ContainsRegex("no_samples, since 2026-03-0[12] [0-9][0-9]:"));
}

TEST_F(AlarmsCommand, TheJournalNamesNoStrokeWhereThereIsNone) {
  {
    auto journal = AlarmJournal::Open(AlarmJournal::PathFor(File("press.db")));
    ASSERT_OK(journal);
    ASSERT_OK(journal->Change("press/left", kRaised, [](AxisContent& axis) -> Status {
      AlarmEvent& aside = axis.events.emplace_back();
      aside.event = "journal_set_aside";
      aside.text = "kept as old.db";
      return {};
    }));
  }
  const std::string told = Alarms({"journal"}).out;
  EXPECT_THAT(told, HasSubstr("journal_set_aside, kept as old.db"));
  EXPECT_THAT(told, Not(HasSubstr("stroke -1")));
}

TEST_F(AlarmsCommand, AnAlarmAtRestCanBeTakenOutOfServiceByName) {
  EXPECT_EQ(State("seal"), "NORM");
  EXPECT_EQ(Alarms({"out-of-service", "press/left/seal"}).exit_code, 0);
  EXPECT_EQ(State("seal"), "OOSRV");
  EXPECT_EQ(Alarms({"list", "--json", "-"}).Json().at("alarms").size(), 2u) << "it is listed while it is out";
  EXPECT_EQ(Alarms({"in-service", "2"}).exit_code, 0);
  EXPECT_EQ(State("seal"), "NORM");
}

TEST_F(AlarmsCommand, AnAlarmThatNobodyKnowsIsRefused) {
  const Ran unknown = Alarms({"out-of-service", "sael"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("no known alarm sael"));
  EXPECT_EQ(Alarms({"ack", "seal"}).exit_code, 2) << "at rest: nothing to acknowledge";
}

TEST_F(AlarmsCommand, ListGivesNoAllClearWhileTheServiceCanStoreNothing) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strcpy(address.sun_path, SocketOf(File("press.db")).c_str());
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(listen(listener, 4), 0);
  std::jthread service([listener] {
    for (int client = 0; (client = accept(listener, nullptr, nullptr)) >= 0; close(client)) {
      char request[1024];
      constexpr std::string_view kAnswer =
          "HTTP/1.0 200 OK\r\n\r\n{\"writer\": {\"state\": \"disk_full\", \"problem\": \"the disk is full\"}}";
      if (read(client, request, sizeof request) > 0)
        static_cast<void>(write(client, kAnswer.data(), kAnswer.size()));
    }
  });
  EXPECT_THAT(Alarms({"list"}).out, HasSubstr("stores nothing now, alarms neither: the disk is full"));
  EXPECT_EQ(Alarms({"list", "--json", "-"}).Json().at("not_stored"), "the disk is full");
  shutdown(listener, SHUT_RDWR);
  close(listener);
  service.join();
  EXPECT_THAT(Alarms({"list"}).out, testing::Not(HasSubstr("stores nothing")));
}

}  // namespace
}  // namespace hydroscope
