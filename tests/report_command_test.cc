// The maintenance report of a database that something else may be writing.

#include <sys/socket.h>
#include <sys/un.h>

#include <cstring>
#include <thread>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;

class StoredReportCommand : public CommandLine {};

TEST_F(StoredReportCommand, ShowsWhatTheDatabaseHolds) {
  const std::string log = Simulate("press.csv", 60, 1);
  ASSERT_EQ(Run({"replay", log, "-m", kMachine, "--db", File("press.db")}).exit_code, 0);
  const Ran ran = Run({"report", "--db", File("press.db"), "--out", File("press.html"), "--json", "-"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_EQ(ran.Json()["strokes"], 11);
  const std::string page = ReadText(File("press.html"));
  for (const char* text : {"<html", "effective bulk modulus", "dead volume", "</html>"})
    EXPECT_THAT(page, HasSubstr(text));
}

/// A service that answers every question with this status, at the socket of a database.
class PretendedService {
 public:
  PretendedService(const std::string& database, const std::string& status)
      : answer_("HTTP/1.0 200 OK\r\n\r\n" + status), listening_(socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, (database + ".sock").c_str(), sizeof address.sun_path - 1);
    EXPECT_EQ(bind(listening_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(listen(listening_, 8), 0);
    thread_ = std::thread([this] {
      char question[1024];
      for (int client = 0; (client = accept(listening_, nullptr, nullptr)) >= 0; close(client))
        EXPECT_TRUE(recv(client, question, sizeof question, 0) > 0 &&
                    send(client, answer_.data(), answer_.size(), MSG_NOSIGNAL) > 0);
    });
  }
  ~PretendedService() {
    shutdown(listening_, SHUT_RDWR);
    thread_.join();
    close(listening_);
  }

 private:
  std::string answer_;
  int listening_;
  std::thread thread_;
};

TEST_F(StoredReportCommand, IsNoAllClearWhileTheServiceStoresNothing) {
  const std::string log = Simulate("press.csv", 60, 1), db = File("press.db");
  ASSERT_EQ(Run({"replay", log, "-m", kMachine, "--db", db}).exit_code, 0);
  const PretendedService service(db,
                                 R"({"writer":{"state":"disk_full","problem":"the disk has 3 MB free"}})");
  const Ran ran = Run({"report", "--db", db, "--out", File("press.html"), "--json", "-"});
  EXPECT_EQ(ran.exit_code, 0);
  EXPECT_EQ(ran.Json()["not_stored"], "the disk has 3 MB free");
  EXPECT_THAT(ReadText(File("press.html")), HasSubstr("This is old: nothing is stored now"));
  const std::vector<std::string> readers[] = {
      {"report", "--out", File("press.html")}, {"trends"}, {"explain"}, {"compare"}};
  for (std::vector<std::string> words : readers) {
    words.insert(words.end(), {"--db", db});
    EXPECT_THAT(Run(words).err, HasSubstr("THIS IS OLD")) << words[0];
  }
  EXPECT_THAT(Run({"alarms", "--db", db}).out, HasSubstr("THIS IS OLD"));
}

TEST_F(StoredReportCommand, OfNoDatabaseIsAnErrorThatSaysSo) {
  const Ran ran = Run({"report", "--db", File("no.db"), "--out", File("no.html")});
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_THAT(ran.err, HasSubstr("no.db"));
  EXPECT_FALSE(std::filesystem::exists(File("no.html")));
}

}  // namespace
}  // namespace hydroscope
