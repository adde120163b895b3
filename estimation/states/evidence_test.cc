#include "estimation/states/evidence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimation/states/fit_task.h"

namespace hydroscope {
namespace {

/// Standard deviation of a parameter from 40 pieces that pull at it alike, `alike` of them on end by turns to either side.
double Deviation(int mean_rows, int alike) {
  const auto machine = ParseMachine(R"toml([signals]
u = { column = "u", unit = "1" }
y = { column = "y", unit = "1" }
[states]
x = { ddt = "k*u - x" }
[outputs]
y = "x"
[parameters]
k = { start = 2, min = 0.1, max = 10 }
)toml",
                                    "lag");
  EXPECT_TRUE(machine) << machine.error().text;
  const auto model = BuildStateModel(*machine, {});
  EXPECT_TRUE(model);
  Episode episode;
  for (int row = 0; row < 80; ++row) episode.time.push_back(0.1 * row);
  episode.signal = RowMatrix::Random(80, 2);
  episode.mean_rows = mean_rows;
  StateFit fit;
  fit.model = *model;
  fit.parameters = Eigen::VectorXd::Constant(1, 2.0);
  for (int k = 0; k < 40; ++k) {
    StatePiece piece;
    piece.information = Eigen::MatrixXd::Identity(1, 1);
    piece.gradient = Eigen::VectorXd::Constant(1, k / alike % 2 == 0 ? 1.0 : -1.0);
    fit.pieces.push_back(piece);
  }
  TakeCovariance(shooting::TaskOf(*model, std::span(&episode, 1)), fit);
  return std::sqrt(fit.covariance(0, 0));
}

TEST(Evidence, IntervalsOfMeansHoldWhatLastsLongerThanAPiece) {
  EXPECT_NEAR(Deviation(2, 4) / Deviation(1, 4), 2, 0.1) << "four pieces pull as one";
  EXPECT_NEAR(Deviation(2, 2) / Deviation(1, 2), std::sqrt(2), 0.05);
  EXPECT_EQ(Deviation(2, 1), Deviation(1, 1));
}

}  // namespace
}  // namespace hydroscope
