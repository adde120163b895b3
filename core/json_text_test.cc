#include "core/json_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace hydroscope {
namespace {

TEST(JsonText, KeepsWhatPeopleWrite) {
  EXPECT_EQ(JsonText({{"name", "Öl °C"}}), R"({"name":"Öl °C"})");
  EXPECT_EQ(JsonText({{"a", 1}}, 2), "{\n  \"a\": 1\n}");
}

TEST(JsonText, TakesTheNameOfAFileThatIsNoText) {
  EXPECT_EQ(JsonText({{"log", "\xff\xfe.csv"}}), "{\"log\":\"\ufffd\ufffd.csv\"}");
  EXPECT_EQ(JsonText("\xc2"), "\"\ufffd\"");
}

TEST(JsonText, ObeysNoTerminalAndReadsBackAsItWas) {
  const std::string sly = "a\u009b31m\u007f\u202eb\u2069\u00a0c\x1b[2J";
  const std::string text = JsonText({{"name", sly}});
  EXPECT_EQ(text, "{\"name\":\"a\\u009b31m\\u007f\\u202eb\\u2069\u00a0c\\u001b[2J\"}");
  EXPECT_EQ(nlohmann::json::parse(text)["name"], sly);
}

}  // namespace
}  // namespace hydroscope
