#include "live/http_endpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace hydroscope {
namespace {

TEST(HttpEndpoint, APortThatIsTakenIsNotShared) {
  const int port = 35'000 + getpid() % 10'000;
  const auto file = [](const char* name) { return testing::TempDir() + name; };
  const auto first = HttpEndpoint::Open(port, file("http_endpoint_first.sock"), {});
  ASSERT_TRUE(first) << first.error().text;
  const auto second = HttpEndpoint::Open(port, file("http_endpoint_second.sock"), {});
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().text, testing::HasSubstr("cannot be opened"));
}

}  // namespace
}  // namespace hydroscope
