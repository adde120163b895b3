#include "pipeline/episodes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

namespace hydroscope {
namespace {

/// A tank that fills, its log with a counter of batches of `batch` rows in which row 150 has no reading.
class EpisodesTest : public testing::Test {
 protected:
  EpisodesTest() {
    std::ofstream log(path_);
    log << "t,q,level,batch\n";
    for (int k = 0; k < 1000; ++k)
      log << fmt::format("{},{},{},{}\n", 0.1 * k, 1 + k % 7, 0.001 * k + 0.0001 * (k % 3),
                         k == 150 ? std::string() : std::to_string(7 + k / kBatch));
  }
  ~EpisodesTest() override { std::filesystem::remove(path_); }

  Result<EpisodeLog> Read(const std::string& episodes) const {
    const auto machine = ParseMachine(
        "[log]\ntime = { column = \"t\", unit = \"s\" }\n"
        "[signals]\nq = { column = \"q\", unit = \"1\" }\nlevel = { column = \"level\", unit = \"m\" }\n"
        "batch = { column = \"batch\", unit = \"1\" }\n"
        "[states]\nh = { ddt = \"k*q\", unit = \"m\" }\n[outputs]\nlevel = \"h\"\n"
        "[parameters]\nk = { start = 1, min = 0, max = 2 }\n" +
            episodes,
        "tank.toml");
    if (!machine) return tl::unexpected(machine.error());
    return ReadEpisodes({path_}, *machine);
  }

  static constexpr int kBatch = 260;
  const std::string path_ = testing::TempDir() + "batches_" +
                            testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
};

TEST_F(EpisodesTest, ALogIsOneWithoutAMarker) {
  const auto log = Read("");
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_EQ(log->episodes.size(), 1u);
}

TEST_F(EpisodesTest, OneBeginsWhereverTheMarkerChanges) {
  const auto log = Read("[episodes]\nmarker = \"batch\"\n");
  ASSERT_TRUE(log) << log.error().text;
  ASSERT_EQ(log->episodes.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(log->episodes[i].first_row, static_cast<std::int64_t>(i * kBatch));
  EXPECT_EQ(log->used, 1000);
}

TEST_F(EpisodesTest, PiecesOfFixedLengthLieBetweenChangesOfTheMarker) {
  const auto log = Read("[episodes]\nmarker = \"batch\"\nseconds = 13\n");
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_EQ(log->episodes.size(), 8u);
  EXPECT_EQ(log->episodes[2].first_row, kBatch);
}

TEST_F(EpisodesTest, AnOutputThatStoodIsLeftOutAndToldOf) {
  {
    std::ofstream log(path_);
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 1e-3);
    log << "t,q,level,batch\n";
    for (int k = 0; k < 1000; ++k)
      log << fmt::format("{},{},{},7\n", 0.1 * k, 1 + k % 7,
                         k >= 400 && k < 600 ? 0.4 : 0.001 * k + noise(random));
  }
  const auto machine = ParseMachine(R"toml([log]
time = { column = "t", unit = "s" }
[signals]
q = { column = "q", unit = "1" }
level = { column = "level", unit = "m", stuck_time = 5 }
[states]
h = { ddt = "k*q", unit = "m" }
[outputs]
level = "h"
[parameters]
k = { start = 1, min = 0, max = 2 }
)toml",
                                    "tank.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  const auto log = ReadEpisodes({path_}, *machine);
  ASSERT_TRUE(log) << log.error().text;
  ASSERT_EQ(log->episodes.size(), 1u);
  EXPECT_TRUE(std::isnan(log->episodes[0].Reading(500, 1)));
  ASSERT_EQ(log->warnings.size(), 1u);
  EXPECT_NE(log->warnings[0].english.find("level (column level) stands still in 200 rows, first at 40 s"),
            std::string::npos)
      << log->warnings[0].english;
}

TEST_F(EpisodesTest, AnOutputThatTheLogLacksIsToldByName) {
  const auto machine = ParseMachine(R"toml([signals]
q = { column = "q", unit = "1" }
level = { column = "level", unit = "m" }
volume = { column = "V", unit = "m3", required = false }
[states]
h = { ddt = "k*q", unit = "m" }
[outputs]
level = "h"
volume = "h*A"
[parameters]
k = { start = 1, min = 0, max = 2 }
A = { start = 1, min = 0.1, max = 10 }
)toml",
                                    "tank.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  const auto log = ReadEpisodes({path_}, *machine);
  ASSERT_FALSE(log);
  EXPECT_NE(log.error().text.find("volume (column V) has no reading in this log"), std::string::npos)
      << log.error().text;
}

}  // namespace
}  // namespace hydroscope
