// One recursive-least-squares update with four and eight parameters: each form of Hydroscope's estimator,
// dlib::rls, and the textbook update written with Eigen, on the same equations.

#include <benchmark/benchmark.h>
#include <dlib/matrix.h>
#include <dlib/svm/rls.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "estimation/recursive/information_filter.h"
#include "estimation/recursive/recursive_least_squares.h"

namespace hydroscope {
namespace {

constexpr int kEquations = 1024;  // fit into the first-level cache together with the estimator
constexpr double kLambda = 0.998;

/// Well-excited equations y = u' theta + e, row by row: N regressors, then y.
template <int N>
std::vector<double> Equations() {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> rows;
  for (int k = 0; k < kEquations; ++k) {
    double y = normal(random);
    for (int i = 0; i < N; ++i) {
      const double u = normal(random);
      rows.push_back(u);
      y += (i + 1) * u;
    }
    rows.push_back(y);
  }
  return rows;
}

template <int N>
void RunHydroscope(benchmark::State& state, const RecursiveLeastSquares::Options& options) {
  const std::vector<double> rows = Equations<N>();
  const std::vector<double> initial(N, 0.0);
  RecursiveLeastSquares rls(initial, options);
  int k = 0;
  for (auto _ : state) {
    const double* row = &rows[static_cast<std::size_t>(k) * (N + 1)];
    benchmark::DoNotOptimize(rls.Update(std::span<const double>(row, N), row[N]));
    k = (k + 1) % kEquations;
  }
  benchmark::DoNotOptimize(rls.theta());
}

RecursiveLeastSquares::Options Form(Forgetting forgetting) {
  RecursiveLeastSquares::Options options;
  options.forgetting = forgetting;
  options.forgetting_factor = forgetting == Forgetting::kNone ? 1.0 : kLambda;
  return options;
}

template <int N>
void Directional(benchmark::State& state) {
  RunHydroscope<N>(state, Form(Forgetting::kDirectional));
}

/// The default form, per equation: equations are gathered, and as many as a stroke of 2 s has enter the
/// information filter at once, which forgets the directions they excite (IntegralEstimator).
template <int N>
void DefaultForm(benchmark::State& state) {
  constexpr int kStroke = 100;
  using Vector = Eigen::Matrix<double, N, 1>;
  using Square = Eigen::Matrix<double, N, N>;
  const std::vector<double> rows = Equations<N>();
  InformationFilter filter(InformationFilter::Vector::Zero(N), 500.0, 1e6);
  Square gram = Square::Zero();
  Vector cross = Vector::Zero();
  int k = 0, gathered = 0;
  for (auto _ : state) {
    const double* row = &rows[static_cast<std::size_t>(k) * (N + 1)];
    const Eigen::Map<const Vector> u(row);
    gram.noalias() += u * u.transpose();
    cross += row[N] * u;
    benchmark::DoNotOptimize(gram.data());
    k = (k + 1) % kEquations;
    if (++gathered < kStroke) continue;
    const Eigen::SelfAdjointEigenSolver<Square> eigen(gram);
    filter.Forget(InformationFilter::Matrix(eigen.eigenvectors()), std::pow(kLambda, kStroke));
    filter.Add(gram, cross, 300.0);
    benchmark::DoNotOptimize(filter.Theta());
    gram.setZero();
    cross.setZero();
    gathered = 0;
  }
}

template <int N>
void Exponential(benchmark::State& state) {
  RunHydroscope<N>(state, Form(Forgetting::kExponential));
}

template <int N>
void NoForgetting(benchmark::State& state) {
  RunHydroscope<N>(state, Form(Forgetting::kNone));
}

template <int N>
void FactorPerParameter(benchmark::State& state) {
  RecursiveLeastSquares::Options options = Form(Forgetting::kDirectional);
  for (int i = 0; i < N; ++i) options.factors[static_cast<std::size_t>(i)] = 0.99 + 0.001 * i;
  RunHydroscope<N>(state, options);
}

template <int N>
void Dlib(benchmark::State& state) {
  const std::vector<double> rows = Equations<N>();
  std::vector<dlib::matrix<double, N, 1>> regressors(kEquations);
  for (int k = 0; k < kEquations; ++k)
    for (int i = 0; i < N; ++i) regressors[k](i) = rows[static_cast<std::size_t>(k) * (N + 1) + i];
  dlib::rls rls(kLambda, 500.0);
  int k = 0;
  for (auto _ : state) {
    rls.train(regressors[k], rows[static_cast<std::size_t>(k) * (N + 1) + N]);
    k = (k + 1) % kEquations;
  }
  benchmark::DoNotOptimize(rls.get_w());
}

/// P -= K u' P, divided by lambda: the textbook form without any care for symmetry. It ends in NaN after some
/// 25 000 updates at lambda 0.999, so it starts anew at every pass over the equations.
template <int N>
void TextbookEigen(benchmark::State& state) {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Square = Eigen::Matrix<double, N, N>;
  const std::vector<double> rows = Equations<N>();
  Square p = 500.0 * Square::Identity();
  Vector theta = Vector::Zero();
  int k = 0;
  for (auto _ : state) {
    const double* row = &rows[static_cast<std::size_t>(k) * (N + 1)];
    const Eigen::Map<const Vector> u(row);
    const Vector pu = p * u;
    const Vector gain = pu / (kLambda + u.dot(pu));
    theta += gain * (row[N] - u.dot(theta));
    p = (p - gain * pu.transpose()) / kLambda;
    benchmark::DoNotOptimize(theta.data());
    if (++k == kEquations) {
      k = 0;
      p = 500.0 * Square::Identity();
    }
  }
}

BENCHMARK(DefaultForm<4>);
BENCHMARK(Directional<4>);
BENCHMARK(Exponential<4>);
BENCHMARK(NoForgetting<4>);
BENCHMARK(FactorPerParameter<4>);
BENCHMARK(Dlib<4>);
BENCHMARK(TextbookEigen<4>);
BENCHMARK(DefaultForm<8>);
BENCHMARK(Directional<8>);
BENCHMARK(Dlib<8>);
BENCHMARK(TextbookEigen<8>);

}  // namespace
}  // namespace hydroscope
