#include "diagnosis/remainder/held_out_form.h"

#include <gtest/gtest.h>

#include <random>

namespace hydroscope {
namespace {

/// Rows of each group with a right-hand side, and their normal equations.
struct Rows {
  std::vector<Eigen::MatrixXd> a;
  std::vector<Eigen::VectorXd> b;
  GroupEquations equations;
};

Rows RandomRows(int groups, int unknowns, int rows) {
  std::mt19937_64 random(static_cast<std::uint64_t>(100 * groups + unknowns));
  std::normal_distribution<double> normal;
  Rows out;
  out.equations.q.resize(unknowns, groups);
  out.equations.energy.resize(groups);
  for (int s = 0; s < groups; ++s) {
    out.a.push_back(Eigen::MatrixXd::NullaryExpr(rows, unknowns, [&] { return normal(random); }));
    out.b.push_back(Eigen::VectorXd::NullaryExpr(rows, [&] { return normal(random); }));
    out.equations.h.push_back(out.a[s].transpose() * out.a[s]);
    out.equations.q.col(s) = out.a[s].transpose() * out.b[s];
    out.equations.energy[s] = out.b[s].squaredNorm();
  }
  return out;
}

/// Of rows on groups left out, with signs, fitted as they stand.
double HeldOutEnergy(const Rows& rows, const Eigen::VectorXd& ridge, const Eigen::VectorXd& signs) {
  double energy = 0;
  for (std::size_t s = 0; s < rows.a.size(); ++s) {
    Eigen::MatrixXd h = ridge.asDiagonal();
    Eigen::VectorXd q = Eigen::VectorXd::Zero(ridge.size());
    for (std::size_t u = 0; u < rows.a.size(); ++u) {
      if (u == s) continue;
      h += rows.a[u].transpose() * rows.a[u];
      q += signs[static_cast<Eigen::Index>(u)] * rows.a[u].transpose() * rows.b[u];
    }
    const Eigen::VectorXd left =
        signs[static_cast<Eigen::Index>(s)] * rows.b[s] - rows.a[s] * h.ldlt().solve(q).eval();
    energy += left.squaredNorm();
  }
  return energy;
}

/// More and fewer groups than stand side by side, and one more.
TEST(HeldOutForms, IsTheEnergyOfWhatFitsWithoutEachGroupLeave) {
  for (const int groups : {5, 8, 9, 16, 19})
    for (const int unknowns : {1, 3, 30}) {
      const Rows rows = RandomRows(groups, unknowns, 12);
      const Eigen::VectorXd ridge = Eigen::VectorXd::LinSpaced(unknowns, 0.01, 0.3);
      Eigen::MatrixXd ridges(unknowns, 2);
      ridges << Eigen::VectorXd::Ones(unknowns), ridge;
      const Eigen::MatrixXd form = HeldOutForms(rows.equations, ridges).back();
      std::mt19937_64 random(7);
      for (int k = 0; k < 4; ++k) {
        const Eigen::VectorXd signs =
            Eigen::VectorXd::NullaryExpr(groups, [&] { return (random() >> 63) != 0 ? 1.0 : -1.0; });
        const double expected = HeldOutEnergy(rows, ridge, signs);
        EXPECT_NEAR(signs.dot(form * signs), expected, 1e-9 * expected) << groups << " " << unknowns;
      }
    }
}

/// More and fewer choices than are taken at once.
TEST(SignChoices, HaveTheEnergiesOfTheForm) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const int groups : {1, 7, 20})
    for (const int choices : {1, 31, 32, 33, 200}) {
      const Eigen::MatrixXd half =
          Eigen::MatrixXd::NullaryExpr(groups, groups, [&] { return normal(random); });
      const Eigen::MatrixXd form = half + half.transpose();
      const Eigen::MatrixXd signs =
          Eigen::MatrixXd::NullaryExpr(groups, choices, [&] { return (random() >> 63) != 0 ? 1.0 : -1.0; });
      const Eigen::VectorXd energies = SignChoices(signs).Energies(form);
      ASSERT_EQ(energies.size(), choices);
      for (int c = 0; c < choices; ++c)
        EXPECT_NEAR(energies[c], signs.col(c).dot(form * signs.col(c)), 1e-12 * groups * groups);
    }
}

}  // namespace
}  // namespace hydroscope
