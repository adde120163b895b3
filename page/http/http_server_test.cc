#include "page/http/http_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

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
