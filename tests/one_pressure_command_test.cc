// A seal recorded at one pressure, which the area rests on: what moves with the piston passes for pressure.

#include <cmath>
#include <random>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;

class OnePressure : public CommandLine {
 protected:
  const std::string machine_ = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/seal_friction.toml";

  /// Slow strokes at about 5 bar, which rises a little with the piston's way; area 519 mm2, friction of 8 N against the
  /// motion, and a force along the stroke that no law of the machine file has, `along` N.
  std::string Log(double along) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> noise;
    std::string text;
    for (int k = 0; k < 7000; ++k) {
      const double t = 0.01 * k, phase = std::fmod(t, 6.0);
      const double x = phase < 3 ? 12 * phase : 36 - 12 * (phase - 3), way = phase < 3 ? 1 : -1;
      const double p = 4.98 + 0.03 * way + 0.0016 * noise(random);
      const double force = 51.9 * p + 8 * way + along * std::sin(x / 3) + 0.03 * noise(random);
      text += std::to_string(10.0 * k) + "\t0\t0\t0\t" + std::to_string(x + 0.01 * noise(random)) + "\t" +
              std::to_string(p) + "\t" + std::to_string(force) + "\n";
    }
    WriteText(File("seal.csv"), text);
    return File("seal.csv");
  }
};

TEST_F(OnePressure, AnErrorFarAboveTheNoiseCouldBeTheWholeArea) {
  const nlohmann::json check = Run({"check", Log(1), "-m", machine_, "--json", "-"}).Json();
  ASSERT_GT(check["rms_holdout"].get<double>(), 3 * check["noise_floor"].get<double>());
  const nlohmann::json& bore = check["parameters"]["bore"];
  EXPECT_GT(bore["value"].get<double>(), 0.04) << "m; it is 25.7 mm, and friction passes for pressure";
  EXPECT_EQ(bore["identifiable"], false) << bore.dump(1);
  EXPECT_EQ(bore["verdict"], "not");
}

}  // namespace
}  // namespace hydroscope
