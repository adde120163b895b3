#include "acquisition/modbus/read_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

using ::testing::ElementsAre;

Machine Press(const std::string& signals, const std::string& modbus = "") {
  const auto machine =
      ParseMachine("[live]\naxes = [\"a\", \"b\"]\n[live.modbus]\n" + modbus + "[signals]\n" + signals +
                       "[balance]\noutput = \"x\"\nterms = { k = \"1\" }\n",
                   "press.toml");
  EXPECT_TRUE(machine) << machine.error().text;
  return machine.value_or(Machine{});
}

TEST(ReadPlan, NearRegistersAreOneRequest) {
  const auto blocks = PlanReads(
      Press("x = { modbus = { register = 10 } }\ny = { modbus = { register = 30, stride = 2 } }\n"));
  ASSERT_EQ(blocks.size(), 1u);
  EXPECT_EQ(blocks[0].first, 10);
  EXPECT_EQ(blocks[0].count, 24);
  EXPECT_EQ(blocks[0].values.size(), 4u) << "the shared one for both axes";
}

TEST(ReadPlan, FarRegistersAreRequestsOfTheirOwn) {
  const auto blocks =
      PlanReads(Press("x = { modbus = { register = 10 } }\ny = { modbus = { register = 40 } }\n"));
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_EQ(blocks[1].first, 40);
  EXPECT_EQ(blocks[1].count, 2);
}

TEST(ReadPlan, NoRequestIsLongerThan125Registers) {
  std::string signals;
  for (int k = 0; k < 20; ++k)
    signals += fmt::format("{} = {{ modbus = {{ register = {} }} }}\n", k == 0 ? "x" : fmt::format("s{}", k),
                           15 * k);
  const auto blocks = PlanReads(Press(signals));
  EXPECT_EQ(blocks.size(), 3u);
  for (const ReadBlock& block : blocks) EXPECT_LE(block.count, 125);
}

TEST(ReadPlan, HeartbeatAndTimeAreReadWithTheirNeighbours) {
  const auto blocks = PlanReads(Press("x = { modbus = { register = 12 } }\n", "heartbeat = 15\ntime = 8\n"));
  ASSERT_EQ(blocks.size(), 1u);
  EXPECT_EQ(blocks[0].first, 8);
  EXPECT_EQ(blocks[0].time, 0);
  EXPECT_EQ(blocks[0].heartbeat, 7);
}

TEST(ReadPlan, AMachineWithoutRegistersReadsNothing) {
  EXPECT_TRUE(PlanReads(Machine{}).empty());
  EXPECT_TRUE(PlanRing(Machine{}).empty());
}

TEST(ReadPlan, DecodesEveryAxisInItsOrder) {
  const auto blocks =
      PlanReads(Press("x = { modbus = { register = 0, stride = 2, order = \"CDAB\" } }\ny = { modbus = { "
                      "register = 4, type = "
                      "\"int16\" } }\n",
                      "time = 5\n"));
  ASSERT_EQ(blocks.size(), 1u);
  std::vector<std::uint16_t> registers(9);
  EncodeRegisters(1.5, RegisterType::kFloat32, WordOrder::kCdab, registers);
  EncodeRegisters(-2.5, RegisterType::kFloat32, WordOrder::kCdab, std::span(registers).subspan(2));
  registers[4] = 0xffff;
  registers[8] = 77;
  const SampleBatch batch = DecodeBlock(blocks[0], registers);
  EXPECT_EQ(batch.rows, 1u);
  EXPECT_THAT(batch.channels, ElementsAre(0, 2, 1, 3)) << "axis * signals + signal";
  EXPECT_THAT(batch.values, ElementsAre(1.5, -2.5, -1, -1));
  EXPECT_EQ(batch.source_time_ns, 77);
}

TEST(ReadPlan, AnAnswerThatIsTooShortGivesNoNumbers) {
  const auto blocks = PlanReads(Press("x = { modbus = { register = 0, stride = 2 } }\n"));
  const std::vector<std::uint16_t> registers(1);
  for (const double value : DecodeBlock(blocks[0], registers).values) EXPECT_TRUE(std::isnan(value));
}

}  // namespace
}  // namespace hydroscope
