#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "page/api_route.h"

namespace hydroscope {
namespace {

/// "GET session view" of each route.
std::set<std::string> Described(const nlohmann::json& document) {
  std::set<std::string> all;
  for (const auto& [path, item] : document.at("paths").items()) {
    const bool of_tools = item.contains("servers");
    for (const char* method : {"get", "post", "put", "delete", "patch"}) {
      if (!item.contains(method)) continue;
      const nlohmann::json& operation = item[method];
      EXPECT_FALSE(operation.value("summary", "").empty()) << path;
      EXPECT_TRUE(operation.at("responses").contains("default")) << path;
      std::string name = method;
      std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
      all.insert(name + " " + (of_tools ? path : path.substr(1)) + " " + operation.value("x-role", ""));
    }
  }
  return all;
}

TEST(OpenApi, DescribesEveryRouteWithWhoMayAskAndNoOther) {
  std::ifstream file(HYDROSCOPE_SOURCE_DIR "/docs/openapi.json");
  const auto document = nlohmann::json::parse(file, nullptr, false);
  ASSERT_TRUE(document.is_object());
  EXPECT_EQ(document["servers"][0]["url"].get<std::string>() + "/", kApi);
  std::set<std::string> routes;
  for (const ApiRoute& route : ApiRoutes())
    EXPECT_TRUE(
        routes.insert(std::string(route.method) + " " + route.path + " " + RoleName(route.role)).second)
        << route.path << " stands twice";
  for (const char* tool : {"/metrics", "/status"})  // of the port of a service (cli/serve.cc)
    routes.insert(std::string("GET ") + tool + " " + RoleName(RoleNeeded("GET", tool)));
  EXPECT_THAT(Described(document), testing::ContainerEq(routes));
}

TEST(OpenApi, WhatIsNoRouteNeedsALogin) {
  EXPECT_EQ(RoleNeeded("GET", "/api/v1/nothing"), UserRole::kView);
  EXPECT_EQ(RoleNeeded("POST", "/api/v1/nothing"), UserRole::kAdmin);
  EXPECT_EQ(RoleNeeded("POST", "/valve_check"), UserRole::kAdmin);
  EXPECT_EQ(RoleNeeded("HEAD", "/api/v1/watch/overview"), UserRole::kView);
}

}  // namespace
}  // namespace hydroscope
