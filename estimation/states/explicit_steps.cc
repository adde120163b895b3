// Steps of StateSimulator by the explicit method, with its exact derivative. Compiled without vectors of the compiler's own
// choice: what has just been written number by number would be waited for when it is read two at a time.

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "estimation/states/explicit_method.h"
#include "estimation/states/simulation.h"
#include "estimation/states/step_tangent.h"

namespace hydroscope {
namespace {

/// Share of a row: what a shorter step errs by in a state that never left 0 is compared with what its rate comes to in a row. An
/// empty tank whose pump begins to turn fills by a root from 0 on: however short the step, it errs by the same share of the state.
constexpr double kFromZero = 1e-6;

}  // namespace

void StateSimulator::Rate(const double* x, double fraction, double* rate) { RateOf<0>(x, fraction, rate); }

/// kStates: of the model, 0 = any number.
template <int kStates>
inline void StateSimulator::RateOf(const double* x, double fraction, double* rate) {
  const int n = kStates > 0 ? kStates : states_;
  InputAt(fraction);
  double* r = values_registers_.data();
  CopyFew(x, n, r);
  CopyFew(u_.data(), inputs_, r + n);
  model_->dynamics.values.Run(r);
  const std::size_t* place = rate_places_.data();
  for (int i = 0; i < n; ++i) rate[i] = r[place[i]];
  if (limited_) HoldAtLimits(x, rate);
}

/// The last stage of the step that was taken is the first of the next one.
void StateSimulator::KeepLastStage() {
  const int last = (kExplicitStages - 1) * states_;
  CopyFew(k_.data() + last, states_, k_.data());
  CopyFew(stage_x_.data() + last, states_, stage_x_.data());
  if (limited_) CopyFew(stage_held_.data() + last, states_, stage_held_.data());
  CopyFew(u_.data(), inputs_, ended_u_.data());
}

bool StateSimulator::ExplicitStep(double fraction, double share, double period, double& error) {
  switch (states_) {  // most models are small: loops over a number of states that the compiler knows
    case 1:
      return ExplicitStepOf<1>(fraction, share, period, error);
    case 2:
      return ExplicitStepOf<2>(fraction, share, period, error);
    case 3:
      return ExplicitStepOf<3>(fraction, share, period, error);
    case 4:
      return ExplicitStepOf<4>(fraction, share, period, error);
    default:
      return ExplicitStepOf<0>(fraction, share, period, error);
  }
}

/// kStates: of the model, 0 = any number.
template <int kStates>
bool StateSimulator::ExplicitStepOf(double fraction, double share, double period, double& error) {
  const double step = share * period;
  const std::size_t n = kStates > 0 ? static_cast<std::size_t>(kStates) : static_cast<std::size_t>(states_);
  const auto take = [&]<int kStage>(std::integral_constant<int, kStage>) {
    double *x = stage_x_.data() + kStage * n, *k = k_.data() + kStage * n;
    BeginOfStage<kStage>(x_.data(), k_.data(), step, n, x);
    RateOf<kStates>(x, fraction + kExplicitNodes[kStage] * share, k);
    if (limited_) CopyFew(held_.data(), states_, stage_held_.data() + kStage * n);
  };
  if (!begun_) take(std::integral_constant<int, 0>());
  take(std::integral_constant<int, 1>());
  take(std::integral_constant<int, 2>());
  take(std::integral_constant<int, 3>());
  take(std::integral_constant<int, 4>());
  take(std::integral_constant<int, 5>());
  take(std::integral_constant<int, 6>());
  begun_ = true;
  const double* end = stage_x_.data() + (kExplicitStages - 1) * n;
  error = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double e = 0;
    for (std::size_t s = 0; s < kExplicitStages; ++s) e += kExplicitError[s] * k_[s * n + i];
    double size = std::max({scale_[i], std::abs(x_[i]), std::abs(end[i])});
    if (scale_[i] == 0 && share < kFromZero)
      size = std::max(size, period * std::abs(k_[i] != 0 ? k_[i] : k_[n + i]));
    error = std::max(error, std::abs(step * e) / std::max(size, 1e-300));
    if (!std::isfinite(end[i]) || !std::isfinite(e)) return false;
    next_[i] = end[i];
  }
  return true;
}

/// Bound on the model's fastest rate, 1/s, in the first stage of an explicit step: rows of the Jacobian in the units of the
/// states in which each pair weighs the same.
double StateSimulator::Fastest() {
  const auto n = static_cast<std::size_t>(states_);
  std::ranges::fill(jacobian_, 0.0);
  for (const auto& [row, column, place] : point_entries_.by_states)
    jacobian_[static_cast<std::size_t>(row) * n + static_cast<std::size_t>(column)] = point_registers_[place];
  const auto own = [&](std::size_t i) -> double& { return jacobian_[i * n + i]; };
  for (std::size_t i = 0; i < n; ++i) own(i) = std::abs(own(i));
  double fastest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const double product = jacobian_[i * n + j] * jacobian_[j * n + i];
      if (product == 0) continue;
      const double each = std::sqrt(std::abs(product));
      own(i) += each;
      own(j) += each;
    }
    fastest = std::max(fastest, own(i));
  }
  return fastest;
}

/// The equations' slopes and the added terms at the stages of the step that was taken; `nodes`: theirs.
void StateSimulator::SlopesAtStages(std::span<const double> nodes, double fraction, double share) {
  constexpr int kPoints = ExpressionProgram::kPoints;
  const int last = static_cast<int>(nodes.size()) - 1;
  const auto n = static_cast<std::size_t>(states_), m = static_cast<std::size_t>(inputs_);
  for (int p = 0; p < kPoints; ++p) {
    const auto stage = static_cast<std::size_t>(std::min(p, last)), at = static_cast<std::size_t>(p);
    if (hold_ != InputHold::kZero || p == 0) InputAt(fraction + nodes[stage] * share);
    for (std::size_t i = 0; i < n; ++i) point_registers_[i * kPoints + at] = stage_x_[stage * n + i];
    for (std::size_t i = 0; i < m; ++i) point_registers_[(n + i) * kPoints + at] = u_[i];
    if (added_ != nullptr && p <= last)
      added_->evaluate(stage_x_.data() + stage * n, u_.data(),
                       stage_added_.data() + stage * static_cast<std::size_t>(added_->values));
  }
  model_->dynamics.slopes.RunPoints(point_registers_.data());
}

/// Where SlopesAtStages left the stages.
std::array<TangentPoint, kStateStages> StateSimulator::StagePoints() const {
  const auto n = static_cast<std::size_t>(states_),
             values = added_ == nullptr ? 0 : static_cast<std::size_t>(added_->values);
  std::array<TangentPoint, kStateStages> points;
  for (std::size_t s = 0; s < kStateStages; ++s)
    points[s] = {point_registers_.data() + s, stage_held_.data() + s * n, stage_added_.data() + s * values};
  return points;
}

/// The step that ExplicitStep took, differentiated. False if it is too long for the method to be stable: states at rest do
/// not show it, their sensitivities would grow without bound.
bool StateSimulator::ExplicitSlopes(double fraction, double share, double period) {
  const double step = share * period;
  // The last stage is not differentiated: its rate is the next step's.
  SlopesAtStages(std::span(kExplicitNodes).first<kExplicitStages - 1>(), fraction, share);
  fastest_ = Fastest();
  if (!(step * fastest_ <= kExplicitStable)) return false;
  const auto points = StagePoints();
  DifferentiateStep({point_entries_, states_, columns_, added_, added_from_}, points.data(), step, s_.data(),
                    ks_.data(), stage_s_.data());
  s_.swap(stage_s_);
  return true;
}

}  // namespace hydroscope
