#include "page/http/request_guard.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

const RequestGuard kGuard{8123};

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

TEST(RequestGuard, ElsewhereTakesAddressesAndTheNamesItWasGivenButNoOthers) {
  const RequestGuard guard{8123, false, {"press7.plant"}, true};
  HttpRequest request = Get("/");
  for (const char* host : {"192.168.1.20:8123", "[fe80::1]:8123", "press7.plant:8123", "localhost:8123"}) {
    request.host = host;
    EXPECT_FALSE(guard.Refuse(request)) << host;
  }
  for (const char* host : {"evil.example:8123", "press7.plant.evil.example:8123", "192.168.1.20:80",
                           "192.168.1.20", "[fe80::1:8123", "1.2.3:8123"}) {
    request.host = host;
    EXPECT_TRUE(guard.Refuse(request)) << host;
  }
}

TEST(RequestGuard, WithTlsThePageIsOfTheOtherScheme) {
  const RequestGuard guard{8123, false, {}, true};
  HttpRequest request = Post("/api/v1/work");
  EXPECT_TRUE(guard.Refuse(request));
  request.origin = "https://127.0.0.1:8123";
  EXPECT_FALSE(guard.Refuse(request));
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

}  // namespace
}  // namespace hydroscope
