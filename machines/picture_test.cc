// What every picture of a machine must be.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "models/machine_kind.h"
#include "models/machine_picture.h"

namespace hydroscope {
namespace {

struct Box {
  double left, right, top, bottom;
};
Box BoxOf(const SignalPlace& place) {
  const double half = 0.5 * NameWidth(place.signal);
  return {place.x - half, place.x + half, place.y - 0.5 * kNameHeight, place.y + 0.5 * kNameHeight};
}
bool Overlap(const Box& a, const Box& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

/// Names stand inside the picture and beside each other.
void ExpectReadable(const MachinePicture& picture, const std::string& machine) {
  for (const SignalPlace& place : picture.places) {
    const Box box = BoxOf(place);
    EXPECT_TRUE(box.left >= 0 && box.right <= picture.width && box.top >= 0 && box.bottom <= picture.height)
        << machine << " " << place.signal;
    for (const SignalPlace& other : picture.places) {
      if (&other == &place) continue;
      EXPECT_FALSE(Overlap(box, BoxOf(other))) << machine << " " << place.signal << " " << other.signal;
    }
  }
}

TEST(MachinePicture, EveryMachineThatIsShippedHasOneWithAPlaceForEachOfItsSignals) {
  for (const MachineKind* kind : MachineKinds()) {
    if (kind == &OwnKind() || kind == &OwnStatesKind()) continue;
    ASSERT_NE(kind->picture, nullptr) << kind->id;
    const MachinePicture picture = kind->picture();
    ExpectReadable(picture, std::string(kind->id));
    if (kind->signals.empty()) continue;
    std::vector<std::string> drawn, read;
    for (const SignalPlace& place : picture.places) drawn.push_back(place.signal);
    for (const MachineInput& input : kind->signals) read.emplace_back(input.name);
    EXPECT_THAT(drawn, testing::UnorderedElementsAreArray(read)) << kind->id;
  }
}

TEST(MachinePicture, ADrawingIsShapesAlone) {
  const std::regex shape(R"(</?(rect|path|circle|g|text)(\s[^<>]*)?>)");
  for (const MachineKind* kind : MachineKinds()) {
    if (kind->picture == nullptr) continue;
    const std::string drawing = kind->picture().drawing;
    const std::regex element("<[^>]*>");
    for (std::sregex_iterator at(drawing.begin(), drawing.end(), element), end; at != end; ++at)
      EXPECT_TRUE(std::regex_match(at->str(), shape)) << kind->id << " " << at->str();
    EXPECT_EQ(drawing.find("style="), std::string::npos) << kind->id;
    EXPECT_EQ(drawing.find("onclick"), std::string::npos) << kind->id;
  }
}

TEST(MachinePicture, AMachineOfOnesOwnHasInputsLeftOutputsRightAndStatesInside) {
  const auto machine = ParseMachine(R"toml(
[signals]
pump_voltage = { column = "u", unit = "V" }
level = { column = "h", unit = "m" }
[states]
h = { ddt = "k*pump_voltage - h/T", unit = "m" }
[outputs]
level = "h"
[parameters]
k = { start = 1, unit = "m/(s V)" }
T = { start = 1, unit = "s" }
)toml",
                                    "tank.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  const MachinePicture picture = PictureOf(*machine);
  ASSERT_EQ(picture.places.size(), 2u);
  EXPECT_EQ(picture.places[0].signal, "pump_voltage");
  EXPECT_LT(picture.places[0].x, 0.5 * picture.width);
  EXPECT_EQ(picture.places[1].signal, "level");
  EXPECT_GT(picture.places[1].x, 0.5 * picture.width);
  EXPECT_THAT(picture.drawing, testing::HasSubstr(">h</text>"));
  ExpectReadable(picture, "tank");
}

TEST(MachinePicture, AValveIsDrawnAndOneWithOtherSignalsByThem) {
  auto machine = LoadMachine(HYDROSCOPE_SOURCE_DIR "/machines/valve_sweep.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  EXPECT_EQ(PictureOf(*machine).drawing, KindOf(*machine).picture().drawing);
  machine->signals.front().name = "current";
  const MachinePicture by_signals = PictureOf(*machine);
  EXPECT_EQ(by_signals.places.front().signal, "current");
  EXPECT_EQ(by_signals.places.size(), machine->signals.size());
}

}  // namespace
}  // namespace hydroscope
