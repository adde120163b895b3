#include "page/http/http_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

#include "live/service_socket.h"

namespace hydroscope {
namespace {

HttpServer::Hooks AnswersThatTellHow() {
  HttpServer::Hooks hooks;
  hooks.refuse = [](const HttpRequest&) { return HttpReply{403, "text/plain", "refused"}; };
  hooks.body_file = [](const HttpRequest&) { return ""; };
  hooks.answer = [](const HttpRequest& request) {
    return HttpReply{200, "text/plain",
                     request.method + " " + request.path + (request.by_socket ? " by socket" : "")};
  };
  return hooks;
}

std::string SocketFile(const char* name) { return testing::TempDir() + "http_server_" + name + ".sock"; }

/// A connection to a port of this computer.
class Client {
 public:
  explicit Client(int port) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(static_cast<std::uint16_t>(port));
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{3, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    EXPECT_EQ(connect(fd_, reinterpret_cast<const sockaddr*>(&at), sizeof(at)), 0);
  }
  Client(Client&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Client(const Client&) = delete;
  ~Client() { close(fd_); }

  void Send(const std::string& text) const { (void)send(fd_, text.data(), text.size(), MSG_NOSIGNAL); }
  /// What comes until `end` does, the other end closes, or 3 s pass.
  std::string ReadUntil(const std::string& end) const {
    std::string text;
    char piece[4096];
    for (ssize_t size = 1; size > 0 && text.find(end) == std::string::npos;) {
      size = recv(fd_, piece, sizeof(piece), 0);
      text.append(piece, static_cast<std::size_t>(std::max<ssize_t>(0, size)));
    }
    return text;
  }

 private:
  int fd_;
};

constexpr int kMoreThanFit = 400;

TEST(HttpServer, ConnectionsThatAskNothingKeepNobodyOut) {
  HttpServer::Hooks hooks = AnswersThatTellHow();
  hooks.refuse = [](const HttpRequest&) { return std::nullopt; };
  const auto server = HttpServer::Open({0}, hooks);
  ASSERT_TRUE(server) << server.error().text;
  std::vector<Client> idle;
  for (int k = 0; k < kMoreThanFit; ++k) {
    idle.emplace_back((*server)->port());
    idle.back().Send("GET / HTTP/1.1\r\nHo");
  }
  Client somebody((*server)->port());
  somebody.Send("GET /status HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_THAT(somebody.ReadUntil("GET /status"), testing::HasSubstr("200 OK"));
}

TEST(HttpServer, StreamsOfGuestsGiveWayToWhoComesAndThoseOfUsersDoNot) {
  EventFeed feed;
  HttpServer::Hooks hooks = AnswersThatTellHow();
  hooks.refuse = [](HttpRequest& request) {
    if (request.token == "anna") request.who.role = UserRole::kView;
    return std::nullopt;
  };
  hooks.event_path = "/events";
  hooks.events = &feed;
  hooks.may_listen_on = [](const HttpRequest&) { return true; };
  const auto server = HttpServer::Open({0}, hooks);
  ASSERT_TRUE(server) << server.error().text;
  const std::string ask = "GET /events HTTP/1.1\r\nHost: localhost\r\n";
  Client user((*server)->port());
  user.Send(ask + "X-Hydroscope-Token: anna\r\n\r\n");
  user.ReadUntil("text/event-stream");
  std::vector<Client> guests;
  for (int k = 0; k < kMoreThanFit; ++k) {
    guests.emplace_back((*server)->port());
    guests.back().Send(ask + "\r\n");
    ASSERT_THAT(guests.back().ReadUntil("text/event-stream"), testing::HasSubstr("200 OK")) << k;
  }
  feed.Publish("news");
  EXPECT_THAT(user.ReadUntil("news"), testing::HasSubstr("data: news"));
  EXPECT_THAT(guests.back().ReadUntil("news"), testing::HasSubstr("data: news"));
}

TEST(HttpServer, AFileThatComesHasItsWholeSizeFromTheBeginning) {
  const std::string file = testing::TempDir() + "http_server_coming";
  HttpServer::Hooks hooks = AnswersThatTellHow();
  hooks.refuse = [](const HttpRequest&) { return std::nullopt; };
  hooks.body_file = [&](const HttpRequest&) { return file; };
  const auto server = HttpServer::Open({0}, hooks);
  ASSERT_TRUE(server) << server.error().text;
  Client somebody((*server)->port());
  somebody.Send("POST /logs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000\r\n\r\nbegin");
  std::error_code none;
  for (int k = 0;
       k < 3000 && !(std::filesystem::exists(file) && std::filesystem::file_size(file, none) == 1000); ++k)
    usleep(1000);
  EXPECT_EQ(std::filesystem::file_size(file, none), 1000U);
  somebody.Send(std::string(995, 'x'));
  EXPECT_THAT(somebody.ReadUntil("POST /logs"), testing::HasSubstr("200 OK"));
}

TEST(HttpServer, APortThatIsTakenIsNotShared) {
  const auto first = HttpServer::Open({0}, AnswersThatTellHow());
  ASSERT_TRUE(first) << first.error().text;
  const auto second = HttpServer::Open({(*first)->port()}, AnswersThatTellHow());
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().text, testing::HasSubstr("cannot be opened"));
}

TEST(HttpServer, SaysWhatIsWrongWithAddressAndCertificate) {
  const auto nowhere = HttpServer::Open({0, "", "press7"}, AnswersThatTellHow());
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().text, testing::HasSubstr("'press7' is no address"));
  const auto unproven =
      HttpServer::Open({0, "", "127.0.0.1", "no certificate", "no key"}, AnswersThatTellHow());
  ASSERT_FALSE(unproven);
  EXPECT_THAT(unproven.error().text, testing::HasSubstr("no pair of PEM files"));
}

TEST(HttpServer, IsAtHomeWhereThisComputerAloneReachesIt) {
  for (const char* address : {"127.0.0.1", "127.1.2.3", "::1"})
    EXPECT_TRUE((HttpListen{0, "", address}.at_home()));
  for (const char* address : {"0.0.0.0", "::", "192.168.1.20"})
    EXPECT_FALSE((HttpListen{0, "", address}.at_home()));
}

TEST(HttpServer, TheSocketAnswersItsOwnerWithoutThePagesGuard) {
  const std::string path = SocketFile("owner");
  {
    const auto server = HttpServer::Open({std::nullopt, path}, AnswersThatTellHow());
    ASSERT_TRUE(server) << server.error().text;
    EXPECT_EQ((*server)->port(), 0);
    EXPECT_EQ(AskService(path, "GET", "/status").value_or(""), "GET /status by socket");
    EXPECT_EQ(AskService(path, "POST", "/valve_check?axis=left").value_or(""), "POST /valve_check by socket");
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_FALSE(AskService(path, "GET", "/status"));
}

TEST(HttpServer, ASocketBelongsToOneProgramAndADeadOneIsReplaced) {
  const std::string path = SocketFile("one");
  std::ofstream(path) << "left behind";
  const auto first = HttpServer::Open({std::nullopt, path}, AnswersThatTellHow());
  ASSERT_TRUE(first) << first.error().text;
  const auto second = HttpServer::Open({std::nullopt, path}, AnswersThatTellHow());
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().text, testing::HasSubstr("another service answers there already"));
  EXPECT_TRUE(AskService(path, "GET", "/")) << "the first one is not disturbed";
}

TEST(HttpServer, RemovesABodyThatNobodyKept) {
  const std::string path = SocketFile("body"), file = testing::TempDir() + "http_server_body";
  for (const bool keeps : {false, true}) {
    HttpServer::Hooks hooks = AnswersThatTellHow();
    hooks.body_file = [&](const HttpRequest&) { return file; };
    hooks.answer = [&](const HttpRequest& request) {
      if (keeps) std::filesystem::rename(request.file, file + "_kept");
      return HttpReply{200, "text/plain", std::filesystem::exists(request.file) ? "there" : "moved"};
    };
    {
      const auto server = HttpServer::Open({std::nullopt, path}, hooks);
      ASSERT_TRUE(server) << server.error().text;
      EXPECT_EQ(AskService(path, "POST", "/logs").value_or(""), keeps ? "moved" : "there");
    }
    EXPECT_FALSE(std::filesystem::exists(file));
    EXPECT_EQ(std::filesystem::remove(file + "_kept"), keeps);
  }
}

}  // namespace
}  // namespace hydroscope
