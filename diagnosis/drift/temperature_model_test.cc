#include "diagnosis/drift/temperature_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope::drift {
namespace {

std::vector<TemperaturePoint> Points(double low, double high, double std, double (*value)(double)) {
  std::vector<TemperaturePoint> points;
  for (int k = 0; k < 20; ++k) {
    const double t = low + (high - low) * k / 19;
    points.push_back({t, value(t) + (k % 2 == 0 ? 0.7 : -0.7) * std, std});
  }
  return points;
}

TEST(Viscosity, IsOneAtFortyAndFollowsAsTheGradeSays) {
  EXPECT_NEAR(RelativeViscosity(313.15), 1.0, 1e-9);
  EXPECT_NEAR(RelativeViscosity(373.15), 6.8 / 46, 1e-6);
  EXPECT_GT(RelativeViscosity(293.15), 2.2);
}

TEST(TemperatureModel, TakesTheSimplestFormThatFits) {
  const auto flat =
      TemperatureModel::Fit(Points(300, 330, 0.01, [](double) { return 5.0; }), CurveFamily::kSmooth);
  EXPECT_EQ(flat->FormName(), "constant");
  const auto line =
      TemperatureModel::Fit(Points(300, 330, 0.01, [](double t) { return t / 10; }), CurveFamily::kSmooth);
  EXPECT_EQ(line->FormName(), "straight");
  const auto flow = TemperatureModel::Fit(
      Points(300, 330, 0.001, [](double t) { return 1.7 - 0.1 * RelativeViscosity(t); }), CurveFamily::kFlow);
  EXPECT_EQ(flow->FormName(), "viscosity");
  EXPECT_NEAR(flow->At(315).value, 1.7 - 0.1 * RelativeViscosity(315), 0.001);
}

TEST(TemperatureModel, WidensOutsideTheRangeItHasSeen) {
  const auto line =
      TemperatureModel::Fit(Points(300, 330, 0.01, [](double t) { return t / 10; }), CurveFamily::kSmooth);
  EXPECT_FALSE(line->At(320).outside);
  const auto beyond = line->At(340);
  EXPECT_TRUE(beyond.outside);
  EXPECT_NEAR(beyond.value, 34, 0.05);
  EXPECT_GT(beyond.std, 0.9) << "the whole slope over 10 K";
}

TEST(TemperatureModel, WithoutTemperatureIsAConstant) {
  const double nan = std::nan("");
  const auto model =
      TemperatureModel::Fit(std::vector<TemperaturePoint>{{nan, 2, 0.1}, {nan, 4, 0.1}}, CurveFamily::kFlow);
  ASSERT_TRUE(model);
  EXPECT_NEAR(model->At(nan).value, 3, 1e-9);
}

TEST(TemperatureModel, RefusesPointsWithoutUncertainty) {
  EXPECT_FALSE(TemperatureModel::Fit(std::vector<TemperaturePoint>{{300, 1, 0}}, CurveFamily::kFlow));
}

TEST(TemperatureModel, ComesBackFromItsBytes) {
  const auto line =
      TemperatureModel::Fit(Points(300, 330, 0.01, [](double t) { return t / 10; }), CurveFamily::kSmooth);
  ByteWriter out;
  line->Save(out);
  std::vector<std::uint8_t> bytes = out.Take();
  TemperatureModel back;
  ByteReader in(bytes);
  ASSERT_TRUE(back.Restore(in));
  EXPECT_EQ(back.At(345).value, line->At(345).value);
  EXPECT_EQ(back.At(345).std, line->At(345).std);
  bytes.resize(bytes.size() / 2);
  ByteReader torn(bytes);
  EXPECT_FALSE(back.Restore(torn));
}

}  // namespace
}  // namespace hydroscope::drift
