// Steps of StateSimulator: an explicit and an implicit method, each with its exact derivative.

#include "estimation/states/steps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/limits.h"
#include "core/wide.h"
#include "estimation/states/simulation.h"

namespace hydroscope {
namespace {

/// Dormand and Prince (1980): nodes, stages, and the difference to the embedded method of order 4.
constexpr int kStages = kStateStages;
constexpr std::array<double, kStages> kNodes = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
constexpr double kA[kStages][kStages - 1] = {
    {},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
constexpr std::array<double, kStages> kError = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                                -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

/// Step times fastest rate up to which the method is stable on the real axis.
constexpr double kStable = 3.3;

/// SDIRK method of order 4 with five stages, L-stable, with an embedded method of order 3 (Hairer and Wanner
/// 1996, table IV.6.5).
constexpr int kImplicitStages = 5;
constexpr double kGamma = 0.25;
constexpr std::array<double, kImplicitStages> kImplicitNodes = {1.0 / 4, 3.0 / 4, 11.0 / 20, 1.0 / 2, 1};
constexpr double kImplicitA[kImplicitStages][kImplicitStages] = {
    {1.0 / 4},
    {1.0 / 2, 1.0 / 4},
    {17.0 / 50, -1.0 / 25, 1.0 / 4},
    {371.0 / 1360, -137.0 / 2720, 15.0 / 544, 1.0 / 4},
    {25.0 / 24, -49.0 / 48, 125.0 / 16, -85.0 / 12, 1.0 / 4}};
constexpr std::array<double, kImplicitStages> kImplicitError = {
    59.0 / 48 - 25.0 / 24, -17.0 / 96 + 49.0 / 48, 225.0 / 32 - 125.0 / 16, -85.0 / 12 + 85.0 / 12, -1.0 / 4};

/// Numbers from which on the width of the vectors pays for the call.
constexpr std::size_t kLong = 24;

/// out = base + step * sum_j weights[j] * k[j], each of `size` numbers; the sum over `kCount` is written out, so that the
/// compiler turns the loop over the numbers into vectors.
template <int kCount>
inline void CombineOf(const double* base, const double* k, const double* weights, double step,
                      std::size_t size, double* out) {
  std::array<double, static_cast<std::size_t>(kCount)> w;
  for (std::size_t j = 0; j < kCount; ++j) w[j] = step * weights[j];
  for (std::size_t i = 0; i < size; ++i) {
    double sum = base[i];
    for (std::size_t j = 0; j < kCount; ++j) sum += w[j] * k[j * size + i];
    out[i] = sum;
  }
}

inline void CombineCounted(const double* base, const double* k, const double* weights, int count, double step,
                           std::size_t size, double* out) {
  switch (count) {
    case 0:
      std::copy_n(base, size, out);
      return;
    case 1:
      return CombineOf<1>(base, k, weights, step, size, out);
    case 2:
      return CombineOf<2>(base, k, weights, step, size, out);
    case 3:
      return CombineOf<3>(base, k, weights, step, size, out);
    case 4:
      return CombineOf<4>(base, k, weights, step, size, out);
    case 5:
      return CombineOf<5>(base, k, weights, step, size, out);
    default:
      return CombineOf<6>(base, k, weights, step, size, out);
  }
}

HYDROSCOPE_WIDE void CombineLong(const double* base, const double* k, const double* weights, int count,
                                 double step, std::size_t size, double* out) {
  CombineCounted(base, k, weights, count, step, size, out);
}

/// out = base + step * sum_j weights[j] * k[j], each of `size` numbers; count at most 6.
inline void Combine(const double* base, const double* k, const double* weights, int count, double step,
                    std::size_t size, double* out) {
  if (size < kLong)
    CombineCounted(base, k, weights, count, step, size, out);
  else
    CombineLong(base, k, weights, count, step, size, out);
}

inline void AddTimes(double factor, const double* __restrict from, int columns, double* __restrict to) {
  for (int c = 0; c < columns; c += kSensitivityPadding)
    for (int k = 0; k < kSensitivityPadding; ++k) to[c + k] += factor * from[c + k];
}

/// The equations at a point, as their tangent needs them.
struct TangentPoint {
  const double* registers;    ///< that hold the values of Equations::entries
  const unsigned char* held;  ///< per state
  const double* added;        ///< values of the added terms
};

/// Shapes of the sensitivities.
struct TangentShape {
  const std::vector<Equations::Slope>& entries;
  const std::size_t* places;  ///< of their values in TangentPoint::registers
  int states, columns;
  const AddedTerms* terms;
  int terms_from;  ///< column
};

/// out = J s + df/dp + what added terms give.
inline void RateOfSlopes(const TangentShape& shape, const TangentPoint& point, const double* s, double* out) {
  const int columns = shape.columns;
  std::fill_n(out, shape.states * columns, 0.0);
  const std::size_t* place = shape.places;
  for (const auto& [row, column] : shape.entries) {
    const double value = point.registers[*place++];
    if (point.held[row] != 0) continue;
    if (column < shape.states)
      AddTimes(value, s + column * columns, columns, out + row * columns);
    else
      out[row * columns + column - shape.states] += value;
  }
  if (shape.terms == nullptr) return;
  for (const auto& [value, row, column] : shape.terms->to_states)
    if (point.held[row] == 0) out[row * columns + shape.terms_from + column] += point.added[value];
}

/// An explicit step differentiated: from s to `end`, by way of the rates k of each stage.
HYDROSCOPE_WIDE void DifferentiateStep(const TangentShape& shape, const TangentPoint* stages, double step,
                                       const double* s, double* k, double* end) {
  const auto size = static_cast<std::size_t>(shape.states * shape.columns);
  RateOfSlopes(shape, stages[0], s, k);
  for (int stage = 1; stage + 1 < kStages; ++stage) {
    CombineCounted(s, k, kA[stage], stage, step, size, end);
    RateOfSlopes(shape, stages[stage], end, k + static_cast<std::size_t>(stage) * size);
  }
  CombineCounted(s, k, kA[kStages - 1], kStages - 1, step, size, end);
}

}  // namespace

/// Rates of the sensitivities at the point that RateAndSlopes looked at.
void StateSimulator::SlopesOfRate(const double* s, double* out) {
  if (added_ != nullptr) added_->evaluate(slopes_registers_.data(), u_.data(), stage_added_.data());
  RateOfSlopes({model_->dynamics.entries, entry_places_.data(), states_, columns_, added_, added_from_},
               {slopes_registers_.data(), held_.data(), stage_added_.data()}, s, out);
}

/// The last stage of the step that was taken is the first of the next one.
void StateSimulator::KeepLastStage() {
  const int last = (kStages - 1) * states_;
  CopyFew(k_.data() + last, states_, k_.data());
  CopyFew(stage_x_.data() + last, states_, stage_x_.data());
  CopyFew(stage_held_.data() + last, states_, stage_held_.data());
  ended_u_ = u_;
}

bool StateSimulator::ExplicitStep(double fraction, double share, double period, double& error) {
  const double step = share * period;
  const auto n = static_cast<std::size_t>(states_);
  for (int s = begun_ ? 1 : 0; s < kStages; ++s) {
    const auto at = static_cast<std::size_t>(s);
    double *x = stage_x_.data() + at * n, *k = k_.data() + at * n;
    Combine(x_.data(), k_.data(), kA[s], s, step, n, x);
    Rate(x, fraction + kNodes[at] * share, k);
    CopyFew(held_.data(), states_, stage_held_.data() + at * n);
  }
  begun_ = true;
  const double* end = stage_x_.data() + (kStages - 1) * n;
  error = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double e = 0;
    for (std::size_t s = 0; s < kStages; ++s) e += kError[s] * k_[s * n + i];
    const double size = std::max({scale_[i], std::abs(x_[i]), std::abs(end[i])});
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
  std::fill(jacobian_.begin(), jacobian_.end(), 0.0);
  const auto& entries = model_->dynamics.entries;
  for (std::size_t e = 0; e < entries.size(); ++e)
    if (entries[e].column < states_)
      jacobian_[static_cast<std::size_t>(entries[e].row) * n + static_cast<std::size_t>(entries[e].column)] =
          point_registers_[entry_point_places_[e]];
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

/// The equations' slopes and the added terms at the stages of the step that ExplicitStep took.
void StateSimulator::SlopesAtStages(double fraction, double share) {
  constexpr int kPoints = ExpressionProgram::kPoints, kLast = kStages - 2;
  static_assert(kLast < kPoints);
  const auto n = static_cast<std::size_t>(states_), m = static_cast<std::size_t>(inputs_);
  for (int p = 0; p < kPoints; ++p) {
    const auto stage = static_cast<std::size_t>(std::min(p, kLast)), at = static_cast<std::size_t>(p);
    if (hold_ != InputHold::kZero || p == 0) InputAt(fraction + kNodes[stage] * share);
    for (std::size_t i = 0; i < n; ++i) point_registers_[i * kPoints + at] = stage_x_[stage * n + i];
    for (std::size_t i = 0; i < m; ++i) point_registers_[(n + i) * kPoints + at] = u_[i];
    if (added_ != nullptr && p <= kLast)
      added_->evaluate(stage_x_.data() + stage * n, u_.data(),
                       stage_added_.data() + stage * static_cast<std::size_t>(added_->values));
  }
  model_->dynamics.slopes.RunPoints(point_registers_.data());
}

/// The step that ExplicitStep took, differentiated. False if it is too long for the method to be stable: states at rest do
/// not show it, their sensitivities would grow without bound.
bool StateSimulator::ExplicitSlopes(double fraction, double share, double period) {
  const double step = share * period;
  SlopesAtStages(fraction, share);
  fastest_ = Fastest();
  if (!(step * fastest_ <= kStable)) return false;
  const auto n = static_cast<std::size_t>(states_),
             values = added_ == nullptr ? 0 : static_cast<std::size_t>(added_->values);
  std::array<TangentPoint, kStages> stages;
  for (std::size_t s = 0; s < kStages; ++s)
    stages[s] = {point_registers_.data() + s, stage_held_.data() + s * n, stage_added_.data() + s * values};
  DifferentiateStep(
      {model_->dynamics.entries, entry_point_places_.data(), states_, columns_, added_, added_from_},
      stages.data(), step, s_.data(), ks_.data(), stage_s_.data());
  s_.swap(stage_s_);
  return true;
}

/// k = f(base + step * gamma * k) by Newton's method, from the k that comes in.
bool StateSimulator::SolveStage(double fraction, double step, const double* base, double* k) {
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStates, kMaxStates>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxStates, 1>;
  constexpr int kIterations = 12;
  std::array<double, kMaxStates> x, rate;
  const auto& entries = model_->dynamics.entries;
  const ExpressionProgram& program = model_->dynamics.slopes;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (int i = 0; i < states_; ++i) x[static_cast<std::size_t>(i)] = base[i] + kGamma * step * k[i];
    RateAndSlopes(x.data(), fraction, rate.data());
    Square matrix = Square::Identity(states_, states_);
    for (std::size_t e = 0; e < entries.size(); ++e) {
      const auto [row, column] = entries[e];
      if (column >= states_ || held_[static_cast<std::size_t>(row)]) continue;
      matrix(row, column) -=
          kGamma * step * slopes_registers_[program.output(static_cast<std::size_t>(states_) + e)];
    }
    Column residual(states_);
    for (int i = 0; i < states_; ++i) residual[i] = rate[static_cast<std::size_t>(i)] - k[i];
    if (!residual.allFinite() || !matrix.allFinite()) return false;
    const Column change = matrix.partialPivLu().solve(residual);
    double worst = 0;
    for (int i = 0; i < states_; ++i) {
      k[i] += change[i];
      const double size =
          std::max(scale_[static_cast<std::size_t>(i)], std::abs(x[static_cast<std::size_t>(i)]));
      worst = std::max(worst, std::abs(step * change[i]) / std::max(size, 1e-300));
    }
    if (worst < 1e-3 * options_.tolerance) return true;
  }
  return false;
}

bool StateSimulator::ImplicitStep(double fraction, double share, double period, double& error) {
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxStates, kMaxStates>;
  const double step = share * period;
  const auto n = static_cast<std::size_t>(states_), size = n * static_cast<std::size_t>(columns_);
  std::array<double, kMaxStates> base, x, rate;
  for (int s = 0; s < kImplicitStages; ++s) {
    const auto at = static_cast<std::size_t>(s);
    Combine(x_.data(), k_.data(), kImplicitA[s], s, step, n, base.data());
    double* k = k_.data() + at * n;
    if (s > 0) std::copy_n(k - n, n, k);
    if (!SolveStage(fraction + kImplicitNodes[at] * share, step, base.data(), k)) return false;
    if (!with_slopes_) continue;
    for (std::size_t i = 0; i < n; ++i) x[i] = base[i] + kGamma * step * k[i];
    RateAndSlopes(x.data(), fraction + kImplicitNodes[at] * share, rate.data());
    Combine(s_.data(), ks_.data(), kImplicitA[s], s, step, size, stage_s_.data());
    double* ks = ks_.data() + at * size;
    SlopesOfRate(stage_s_.data(), ks);
    Square matrix = Square::Identity(states_, states_);
    for (std::size_t e = 0; e < model_->dynamics.entries.size(); ++e) {
      const auto [row, column] = model_->dynamics.entries[e];
      if (column >= states_ || held_[static_cast<std::size_t>(row)]) continue;
      matrix(row, column) -=
          kGamma * step *
          slopes_registers_[model_->dynamics.slopes.output(static_cast<std::size_t>(states_) + e)];
    }
    Eigen::Map<RowMatrix> slopes(ks, states_, columns_);
    slopes = matrix.partialPivLu().solve(slopes).eval();
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
  if (with_slopes_) Combine(s_.data(), ks_.data(), weights, kImplicitStages, step, size, stage_s_.data());
  return true;
}

}  // namespace hydroscope
