// Steps of StateSimulator by the implicit method, with its exact derivative.

#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.h"
#include "core/limits.h"
#include "estimation/states/implicit_method.h"
#include "estimation/states/simulation.h"
#include "estimation/states/step_tangent.h"

namespace hydroscope {
namespace {

/// out = base + step * sum_j weights[j] * k[j], each of `size` numbers.
void Combine(const double* base, const double* k, const double* weights, std::size_t count, double step,
             std::size_t size, double* out) {
  for (std::size_t i = 0; i < size; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < count; ++j) sum += weights[j] * k[j * size + i];
    out[i] = base[i] + step * sum;
  }
}

}  // namespace

/// Factors 1 - own weight * step * df/dx at the point that RateAndSlopes looked at; states that are held do not move.
bool StateSimulator::FactorStage(double step) {
  const auto n = static_cast<std::size_t>(states_);
  double* matrix = stage_factor_.data();
  PutStageMatrix(entries_.by_states, slopes_registers_.data(), held_.data(), step, n, matrix);
  if (!std::all_of(matrix, matrix + n * n, [](double value) { return std::isfinite(value); })) return false;
  FactorFew(n, matrix, stage_pivots_.data());
  stage_factor_held_ = held_;
  return true;
}

/// k = f(base + step * own weight * k) from the k that comes in, by Newton's method with the matrix of the step's first stage as
/// long as it serves.
bool StateSimulator::SolveStage(double fraction, double step, const double* base, double* k) {
  constexpr int kIterations = 20;
  constexpr double kServes = 0.2;  // what a change must fall to from one iteration to the next
  const auto n = static_cast<std::size_t>(states_);
  std::array<double, kMaxStates> x, rate, change;
  double before = kInfinity;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t i = 0; i < n; ++i) x[i] = base[i] + kImplicitOwn * step * k[i];
    if (factored_) Rate(x.data(), fraction, rate.data());
    if (!factored_ || held_ != stage_factor_held_) {
      RateAndSlopes(x.data(), fraction, rate.data());
      if (!FactorStage(step)) return false;
      factored_ = true;
    }
    for (std::size_t i = 0; i < n; ++i) change[i] = rate[i] - k[i];
    SolveFactored(n, stage_factor_.data(), stage_pivots_.data(), change.data());
    double worst = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (!std::isfinite(change[i])) return false;
      k[i] += change[i];
      const double size = std::max(scale_[i], std::abs(x[i]));
      worst = std::max(worst, std::abs(step * change[i]) / std::max(size, 1e-300));
    }
    if (worst < 1e-3 * options_.tolerance) return true;
    factored_ = worst < kServes * before;
    before = worst;
  }
  return false;
}

bool StateSimulator::ImplicitStep(double fraction, double share, double period, double& error) {
  const double step = share * period;
  const auto n = static_cast<std::size_t>(states_);
  std::array<double, kMaxStates> base;
  factored_ = false;
  for (std::size_t s = 0; s < kImplicitStages; ++s) {
    Combine(x_.data(), k_.data(), kImplicitA[s], s, step, n, base.data());
    double* k = k_.data() + s * n;
    if (s > 0) std::copy_n(k - n, n, k);
    if (!SolveStage(fraction + kImplicitNodes[s] * share, step, base.data(), k)) return false;
    for (std::size_t i = 0; i < n; ++i) stage_x_[s * n + i] = base[i] + kImplicitOwn * step * k[i];
    std::copy_n(held_.data(), n, stage_held_.data() + s * n);
  }
  error = 0;
  const double* weights = kImplicitA[kImplicitStages - 1];
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0, e = 0;
    for (std::size_t s = 0; s < kImplicitStages; ++s) {
      sum += weights[s] * k_[s * n + i];
      e += kImplicitError[s] * k_[s * n + i];
    }
    next_[i] = x_[i] + step * sum;
    if (!std::isfinite(next_[i])) return false;
    const double reach = std::max({scale_[i], std::abs(x_[i]), std::abs(next_[i])});
    error = std::max(error, std::abs(step * e) / std::max(reach, 1e-300));
  }
  return true;
}

/// The step that ImplicitStep took, differentiated.
void StateSimulator::ImplicitSlopes(double fraction, double share, double period) {
  SlopesAtStages(kImplicitNodes, fraction, share);
  const auto points = StagePoints();
  DifferentiateImplicitStep({point_entries_, states_, columns_, added_, added_from_}, points.data(),
                            share * period, s_.data(), ks_.data(), stage_s_.data());
  s_.swap(stage_s_);
}

}  // namespace hydroscope
