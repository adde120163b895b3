#include "page/request_guard.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

const RequestGuard kGuard{8123, "secret"};

HttpRequest Get(const std::string& path) {
  HttpRequest request;
  request.method = "GET";
  request.path = path;
  request.host = "127.0.0.1:8123";
  return request;
}

HttpRequest Post(const std::string& path) {
  HttpRequest request = Get(path);
  request.method = "POST";
  request.token = "secret";
  request.origin = "http://127.0.0.1:8123";
  request.fetch_site = "same-origin";
  return request;
}

unsigned StatusOf(const HttpRequest& request) {
  const auto refusal = kGuard.Refuse(request);
  return refusal ? refusal->status : 200;
}

TEST(RequestGuard, LetsThePageItselfReadAndChange) {
  EXPECT_EQ(StatusOf(Get("/")), 200u);
  EXPECT_EQ(StatusOf(Get("/api/v1/session")), 200u);
  EXPECT_EQ(StatusOf(Post("/api/v1/work")), 200u);
}

TEST(RequestGuard, RefusesHostsThatAreNotThisComputer) {
  for (const char* host : {"", "example.com", "example.com:8123", "127.0.0.1", "127.0.0.1:80",
                           "127.0.0.1.example.com:8123", "localhost:8123.example.com"}) {
    HttpRequest request = Get("/");
    request.host = host;
    EXPECT_EQ(StatusOf(request), 421u) << host;
  }
  HttpRequest request = Get("/");
  request.host = "localhost:8123";
  EXPECT_EQ(StatusOf(request), 200u);
}

TEST(RequestGuard, RefusesChangesWithoutTheToken) {
  for (const char* token : {"", "secre", "secret ", "Secret", "secret2"}) {
    HttpRequest request = Post("/api/v1/save");
    request.token = token;
    EXPECT_EQ(StatusOf(request), 403u) << token;
  }
}

TEST(RequestGuard, RefusesEveryTokenWhereThereIsNone) {
  HttpRequest request = Post("/api/v1/save");
  request.token = "";
  EXPECT_TRUE((RequestGuard{8123, ""}.Refuse(request)));
}

TEST(RequestGuard, RefusesPagesOfOtherSites) {
  for (const char* origin :
       {"http://example.com", "null", "https://127.0.0.1:8123", "http://127.0.0.1:8124"}) {
    HttpRequest request = Post("/api/v1/work");
    request.origin = origin;
    EXPECT_EQ(StatusOf(request), 403u) << origin;
  }
  for (const char* site : {"cross-site", "same-site"}) {
    HttpRequest request = Get("/api/v1/session");
    request.fetch_site = site;
    EXPECT_EQ(StatusOf(request), 403u) << site;
  }
}

TEST(RequestGuard, RefusesBodiesBeyondTheirLimit) {
  HttpRequest request = Post("/api/v1/work");
  request.length = kMostBody;
  EXPECT_EQ(StatusOf(request), 200u);
  request.length = kMostBody + 1;
  EXPECT_EQ(StatusOf(request), 413u);
  request.path = "/api/v1/logs";
  EXPECT_EQ(StatusOf(request), 200u);
  request.length = kMostUpload + 1;
  EXPECT_EQ(StatusOf(request), 413u);
}

TEST(RequestGuard, RefusesOtherMethods) {
  HttpRequest request = Post("/api/v1/work");
  request.method = "DELETE";
  EXPECT_EQ(StatusOf(request), 405u);
}

TEST(RequestGuard, DrawsAnotherTokenEachTime) {
  EXPECT_EQ(RandomToken().size(), 64u);
  EXPECT_NE(RandomToken(), RandomToken());
}

}  // namespace
}  // namespace hydroscope
