#include "alarms/feeds/dds/tags.h"

#include <gmock/gmock.h>

#include <fstream>
#include <regex>

namespace hydroscope {
namespace {

using ::testing::ElementsAreArray;

AxisPicture AxisWithFinding() {
  AlarmState alarm;
  alarm.id = "internal_leakage";
  alarm.active = true;
  alarm.acknowledged = false;
  alarm.value = 3e-12;
  alarm.unit = "m3/(s Pa)";
  alarm.text = "More oil lost under pressure";
  AxisPicture axis;
  axis.machine = "press/left";
  axis.name = "left";
  axis.health.state = HealthState::kOutOfSpecification;
  axis.alarms = {alarm};
  return axis;
}

/// With the unit.
std::string ValueOf(const std::vector<Tag>& tags, const std::string& name) {
  for (const Tag& tag : tags)
    if (tag.name == name) return tag.value + (tag.unit.empty() ? "" : " " + tag.unit);
  ADD_FAILURE() << "no tag " << name;
  return "";
}

/// "type name" of the members of a struct of the IDL, in order.
std::vector<std::string> MembersInIdl(const std::string& name) {
  std::ifstream file(HYDROSCOPE_SOURCE_DIR "/dds/hydroscope_alarms.idl");
  const std::regex member(R"(^\s*(?:@key )?([a-z][\w<> ]*[\w>]) (\w+);.*)");
  std::vector<std::string> members;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    std::smatch found;
    if (line.find("struct") != std::string::npos)
      inside = line.find("struct " + name + " ") != std::string::npos;
    if (inside && std::regex_match(line, found, member))
      members.push_back(found[1].str() + " " + found[2].str());
  }
  return members;
}

TEST(DdsTags, AreTheMembersOfTheMessagesAsTheIdlHasThem) {
  AxisPicture axis = AxisWithFinding();
  axis.alarms.clear();
  std::vector<std::string> events, findings;
  for (const Tag& tag : DdsTags({}, {axis}, std::nullopt)) {
    const bool event = tag.address == "hydroscope/alarms";
    EXPECT_TRUE(event || tag.address == "hydroscope/findings") << tag.address;
    (event ? events : findings).push_back(tag.type + " " + tag.name.substr(tag.name.rfind(' ') + 1));
  }
  ASSERT_FALSE(events.empty());
  EXPECT_THAT(events, ElementsAreArray(MembersInIdl("AlarmEvent")));
  EXPECT_THAT(findings, ElementsAreArray(MembersInIdl("Finding")));
}

TEST(DdsTags, SayWhatIsPublished) {
  DdsFeedSpec spec;
  spec.topic = "plant";
  JournalRow row;
  row.sequence = 7;
  row.machine = "press/left";
  row.event.event = "raised";
  row.event.alarm = "internal_leakage";
  const auto tags = DdsTags(spec, {AxisWithFinding()}, row);
  EXPECT_EQ(tags.front().address, "plant/alarms");
  EXPECT_EQ(ValueOf(tags, "newest event, journal_sequence"), "7");
  EXPECT_EQ(ValueOf(tags, "newest event, event"), "raised");
  EXPECT_EQ(ValueOf(tags, "newest event, machine_time"), " s") << "not known";
  EXPECT_EQ(ValueOf(tags, "health, health"), "S");
  EXPECT_EQ(ValueOf(tags, "internal_leakage, value"), "3e-12 m3/(s Pa)");
  EXPECT_EQ(ValueOf(tags, "internal_leakage, active"), "true");
  EXPECT_EQ(ValueOf(tags, "internal_leakage, state"), "UNACK");
}

TEST(DdsTags, WithoutARowOfTheJournalEventsHaveNoValues) {
  for (const Tag& tag : DdsTags({}, {}, std::nullopt)) EXPECT_EQ(tag.value, "") << tag.name;
}

}  // namespace
}  // namespace hydroscope
