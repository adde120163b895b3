#include "diagnosis/stroke_forms.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "estimation/normal_equations.h"

namespace hydroscope {
namespace {

/// Augmented Grams of strokes whose rows are drawn at random, the output a known sum of the regressors and noise.
std::vector<Eigen::MatrixXd> DrawnGrams(int columns, int strokes, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<Eigen::MatrixXd> grams;
  for (int s = 0; s < strokes; ++s) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::NullaryExpr(30, columns + 1, [&] { return normal(random); });
    for (int c = 0; c < columns; ++c)
      rows.col(c) *= std::pow(10.0, 3 * c % 7 - 3);  // of very different units
    rows.col(columns) = 0.1 * rows.col(columns) + rows.leftCols(columns).rowwise().sum();
    grams.push_back(rows.transpose() * rows);
  }
  return grams;
}

std::vector<SymmetricMatrix> Packed(const std::vector<Eigen::MatrixXd>& grams) {
  std::vector<SymmetricMatrix> packed;
  for (const Eigen::MatrixXd& gram : grams) {
    packed.emplace_back(static_cast<int>(gram.rows()));
    for (int j = 0; j < gram.rows(); ++j)
      for (int i = 0; i <= j; ++i) packed.back()(i, j) = gram(i, j);
  }
  return packed;
}

StrokeForms FormsOf(const std::vector<SymmetricMatrix>& grams, const SparseColumns& columns) {
  GramElements elements;
  for (const SymmetricMatrix& gram : grams) elements.Add(gram);
  return elements.Congruence(columns);
}

SparseColumns EachByItself(int count) {
  SparseColumns columns;
  for (int c = 0; c < count; ++c) columns.push_back({{c, 1.0}});
  return columns;
}

double EnergyLeft(const Eigen::MatrixXd& gram, const Eigen::VectorXd& theta) {
  Eigen::VectorXd residual(theta.size() + 1);
  residual << theta, -1.0;
  return residual.dot(gram * residual);
}

std::vector<std::size_t> All(std::size_t count) {
  std::vector<std::size_t> all(count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

TEST(StrokeForms, AreCongruentToTheGramsOfTheStrokes) {
  std::mt19937 random(11);
  const std::vector<Eigen::MatrixXd> grams = DrawnGrams(5, 11, random);
  const std::vector<SymmetricMatrix> packed = Packed(grams);
  const SparseColumns columns = {{{4, 1.0}}, {{0, 0.5}, {3, -2.0}}, {{5, 1.0}}};
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(6, 3);
  for (int c = 0; c < 3; ++c)
    for (const auto& [row, weight] : columns[c]) weights(row, c) = weight;
  GramElements elements;
  for (const SymmetricMatrix& gram : packed) elements.Add(gram);
  for (int again = 0; again < 2; ++again) {  // gathered, and as gathered before
    const StrokeForms forms = elements.Congruence(columns);
    for (std::size_t s = 0; s < grams.size(); ++s) {
      const Eigen::MatrixXd expected = weights.transpose() * grams[s] * weights;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j)
          EXPECT_NEAR(forms.Of(s, i, j), expected(i, j), 1e-12 * expected.diagonal().maxCoeff());
    }
  }
}

TEST(StrokeForms, LeaveOutEachStrokeAsSolvedOneByOne) {
  std::mt19937 random(5);
  for (const int columns : {1, 3, 8, 33})
    for (const int strokes : {3, 8, 19}) {
      const std::vector<Eigen::MatrixXd> grams = DrawnGrams(columns, strokes, random);
      const std::vector<SymmetricMatrix> packed = Packed(grams);
      const StrokeForms forms = FormsOf(packed, EachByItself(columns + 1));
      std::vector<std::size_t> used = All(grams.size());
      if (strokes > 3) used.erase(used.begin() + 1);  // one was not usable
      const Eigen::MatrixXd total = forms.Sum(used);
      const LeftOutStrokes left_out = LeaveOutEach(forms, forms, total, Eigen::VectorXd(), used);
      for (std::size_t k = 0; k < used.size(); ++k) {
        const Eigen::MatrixXd rest = total - grams[used[k]];
        const Eigen::VectorXd theta =
            SolveNormalEquations({rest.topLeftCorner(columns, columns), rest.col(columns).head(columns),
                                  rest(columns, columns), 0});
        EXPECT_FALSE(left_out.indispensable[k]);
        const auto at = static_cast<Eigen::Index>(k);
        EXPECT_LT((left_out.theta.col(at) - theta).cwiseQuotient(theta).cwiseAbs().maxCoeff(), 1e-8)
            << columns << " columns, " << strokes << " strokes";
        const double energy = EnergyLeft(grams[used[k]], theta);
        EXPECT_NEAR(left_out.error[at], energy, 1e-8 * energy + 1e-12 * total(columns, columns));
        EXPECT_EQ(left_out.error[at], left_out.flow_error[at]);
      }
    }
}

/// A regressor that one stroke alone tells from the others.
TEST(StrokeForms, TellAStrokeThatTheModelCannotDoWithout) {
  std::mt19937 random(3);
  std::vector<Eigen::MatrixXd> grams = DrawnGrams(2, 9, random);
  Eigen::MatrixXd twice(4, 3);  // regressors 0, 1, 1 again, and the output
  twice << 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1;
  for (std::size_t s = 0; s < grams.size(); ++s) grams[s] = twice * grams[s] * twice.transpose();
  grams[4](2, 2) *= 1.5;
  const std::vector<SymmetricMatrix> packed = Packed(grams);
  const StrokeForms forms = FormsOf(packed, EachByItself(4));
  const std::vector<std::size_t> all = All(grams.size());
  const Eigen::VectorXd whole = Eigen::Vector3d(1, 2, 3);
  const LeftOutStrokes left_out = LeaveOutEach(forms, forms, forms.Sum(all), whole, all);
  for (std::size_t s = 0; s < grams.size(); ++s) EXPECT_EQ(left_out.indispensable[s], s == 4);
  EXPECT_EQ(left_out.theta.col(4), whole);
  EXPECT_NEAR(left_out.error[4], EnergyLeft(grams[4], whole), 1e-9 * left_out.error[4]);
}

}  // namespace
}  // namespace hydroscope
