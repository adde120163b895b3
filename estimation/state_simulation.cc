#include "estimation/state_simulation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/limits.h"
#include "core/wide.h"

namespace hydroscope {
namespace {

/// Dormand and Prince (1980): nodes, stages, and the difference to the embedded method of order 4.
constexpr int kStages = 7;
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

/// Step times fastest rate up to which the method is stable on the real axis, and what a step is cut to beyond.
constexpr double kStable = 3.3, kStableAgain = 2.5;

/// SDIRK method of order 4 with five stages, L-stable, with an embedded method of order 3 (Hairer and Wanner 1996, table
/// IV.6.5).
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

inline void CombineShort(const double* base, const double* k, const double* weights, int count, double step,
                         std::size_t size, double* out) {
  for (std::size_t i = 0; i < size; ++i) {
    double sum = 0;
    for (int j = 0; j < count; ++j) sum += weights[j] * k[static_cast<std::size_t>(j) * size + i];
    out[i] = base[i] + step * sum;
  }
}

HYDROSCOPE_WIDE void CombineLong(const double* base, const double* k, const double* weights, int count,
                                 double step, std::size_t size, double* out) {
  std::copy_n(base, size, out);
  for (int j = 0; j < count; ++j) {
    const double weight = step * weights[j];
    if (weight == 0) continue;
    const double* kj = k + static_cast<std::size_t>(j) * size;
    for (std::size_t i = 0; i < size; ++i) out[i] += weight * kj[i];
  }
}

/// out = base + step * sum_j weights[j] * k[j], each of `size` numbers.
inline void Combine(const double* base, const double* k, const double* weights, int count, double step,
                    std::size_t size, double* out) {
  if (size < kLong)
    CombineShort(base, k, weights, count, step, size, out);
  else
    CombineLong(base, k, weights, count, step, size, out);
}

inline void AddTimes(double factor, const double* from, int size, double* to) {
  for (int i = 0; i < size; ++i) to[i] += factor * from[i];
}

}  // namespace

StateSimulator::StateSimulator(std::shared_ptr<const StateModel> model, const SimulationOptions& options)
    : model_(std::move(model)),
      options_(options),
      states_(model_->states()),
      inputs_(static_cast<int>(model_->inputs.size())),
      parameters_(model_->parameter_count()),
      linear_(model_->machine.log.hold == InputHold::kLinear),
      values_registers_(model_->dynamics.values.Registers()),
      slopes_registers_(model_->dynamics.slopes.Registers()),
      output_registers_(model_->output.values.Registers()),
      output_slopes_registers_(model_->output.slopes.Registers()),
      held_(static_cast<std::size_t>(states_)) {
  const auto n = static_cast<std::size_t>(states_), m = static_cast<std::size_t>(inputs_);
  for (auto* v : {&x_, &next_, &scale_}) v->assign(n, 0.0);
  for (auto* v : {&u0_, &u1_, &u_}) v->assign(m, 0.0);
  k_.assign(n * kStages, 0.0);
  stage_x_.assign(n * kStages, 0.0);
  jacobian_.assign(n * n, 0.0);
}

void StateSimulator::SetParameters(const Eigen::VectorXd& parameters) {
  theta_ = parameters;
  const auto first = static_cast<std::ptrdiff_t>(states_ + inputs_);
  const auto fix = [&](const ExpressionProgram& program, std::vector<double>& registers) {
    std::copy(theta_.begin(), theta_.end(), registers.begin() + first);
    program.RunFixed(registers.data());
  };
  fix(model_->dynamics.values, values_registers_);
  fix(model_->dynamics.slopes, slopes_registers_);
  fix(model_->output.values, output_registers_);
  fix(model_->output.slopes, output_slopes_registers_);

  const ExpressionProgram& program = model_->limits.slopes;
  std::vector<double> registers = program.Registers();
  std::copy(theta_.begin(), theta_.end(), registers.begin());
  program.RunFixed(registers.data());
  program.Run(registers.data());
  limits_.resize(2 * states_);
  limit_slopes_ = RowMatrix::Zero(2 * states_, parameters_);
  for (int r = 0; r < 2 * states_; ++r) limits_[r] = registers[program.output(static_cast<std::size_t>(r))];
  for (std::size_t e = 0; e < model_->limits.entries.size(); ++e)
    limit_slopes_(model_->limits.entries[e].row, model_->limits.entries[e].column) =
        registers[program.output(static_cast<std::size_t>(2 * states_) + e)];
}

Eigen::VectorXd StateSimulator::Initial(const Episode& episode, const Eigen::VectorXd& estimated,
                                        RowMatrix* slopes) {
  const ExpressionProgram& program = model_->initial.slopes;
  std::vector<double> registers = program.Registers();
  const Eigen::Index signals = episode.signal.cols();
  for (Eigen::Index s = 0; s < signals; ++s) registers[static_cast<std::size_t>(s)] = episode.signal(0, s);
  std::copy(theta_.begin(), theta_.end(), registers.begin() + signals);
  program.RunFixed(registers.data());
  program.Run(registers.data());
  Eigen::VectorXd x0(states_);
  for (int i = 0; i < states_; ++i) {
    const auto s = static_cast<std::size_t>(i);
    x0[i] = model_->estimated[s] ? estimated[i] : registers[program.output(s)];
    x0[i] = std::clamp(x0[i], limits_[i], std::max(limits_[i], limits_[states_ + i]));
  }
  if (slopes == nullptr) return x0;
  *slopes = RowMatrix::Zero(states_, parameters_);
  for (std::size_t e = 0; e < model_->initial.entries.size(); ++e)
    (*slopes)(model_->initial.entries[e].row, model_->initial.entries[e].column) =
        registers[program.output(static_cast<std::size_t>(states_) + e)];
  return x0;
}

void StateSimulator::InputAt(double fraction) {
  for (std::size_t i = 0; i < u_.size(); ++i)
    u_[i] = linear_ ? u0_[i] + fraction * (u1_[i] - u0_[i]) : u0_[i];
}

/// What drives a state beyond its limit is stopped there.
void StateSimulator::HoldAtLimits(const double* x, double* rate, bool slopes) {
  for (int i = 0; i < states_; ++i) {
    const bool held = (x[i] >= limits_[states_ + i] && rate[i] > 0) || (x[i] <= limits_[i] && rate[i] < 0);
    if (held) rate[i] = 0;
    if (slopes) held_[static_cast<std::size_t>(i)] = held;
  }
}

void StateSimulator::Rate(const double* x, double fraction, double* rate) {
  InputAt(fraction);
  double* r = values_registers_.data();
  std::copy_n(x, states_, r);
  std::copy(u_.begin(), u_.end(), r + states_);
  const ExpressionProgram& program = model_->dynamics.values;
  program.Run(r);
  for (int i = 0; i < states_; ++i) rate[i] = r[program.output(static_cast<std::size_t>(i))];
  HoldAtLimits(x, rate, false);
}

void StateSimulator::RateAndSlopes(const double* x, double fraction, double* rate) {
  InputAt(fraction);
  double* r = slopes_registers_.data();
  std::copy_n(x, states_, r);
  std::copy(u_.begin(), u_.end(), r + states_);
  const ExpressionProgram& program = model_->dynamics.slopes;
  program.Run(r);
  for (int i = 0; i < states_; ++i) rate[i] = r[program.output(static_cast<std::size_t>(i))];
  HoldAtLimits(x, rate, true);
  if (added_ != nullptr) added_->values(x, u_.data(), added_values_.data());
}

/// Rates of the sensitivities at the point that RateAndSlopes looked at: J S + df/dp.
void StateSimulator::SlopesOfRate(const double* s, double* out) const {
  std::fill_n(out, static_cast<std::size_t>(states_ * columns_), 0.0);
  const ExpressionProgram& program = model_->dynamics.slopes;
  const auto& entries = model_->dynamics.entries;
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const auto [row, column] = entries[e];
    if (held_[static_cast<std::size_t>(row)]) continue;
    const double slope = slopes_registers_[program.output(static_cast<std::size_t>(states_) + e)];
    if (column < states_)
      AddTimes(slope, s + column * columns_, columns_, out + row * columns_);
    else
      out[row * columns_ + column - states_] += slope;
  }
  if (added_ == nullptr) return;
  for (int i = 0; i < states_; ++i) {
    if (held_[static_cast<std::size_t>(i)]) continue;
    double* to = out + i * columns_ + added_from_ + i * added_->count;
    for (int k = 0; k < added_->count; ++k) to[k] += added_values_[static_cast<std::size_t>(k)];
  }
}

bool StateSimulator::ExplicitStep(double fraction, double share, double period, double& error) {
  const double step = share * period;
  const auto n = static_cast<std::size_t>(states_);
  for (int s = 0; s < kStages; ++s) {
    double* x = stage_x_.data() + static_cast<std::size_t>(s) * n;
    Combine(x_.data(), k_.data(), kA[s], s, step, n, x);
    Rate(x, fraction + kNodes[static_cast<std::size_t>(s)] * share,
         k_.data() + static_cast<std::size_t>(s) * n);
  }
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

/// Bound on the model's fastest rate, 1/s, at the point that RateAndSlopes looked at: rows of the Jacobian in the units of the
/// states in which each pair weighs the same.
double StateSimulator::Fastest() {
  const auto n = static_cast<std::size_t>(states_);
  std::fill(jacobian_.begin(), jacobian_.end(), 0.0);
  const ExpressionProgram& program = model_->dynamics.slopes;
  const auto& entries = model_->dynamics.entries;
  for (std::size_t e = 0; e < entries.size(); ++e)
    if (entries[e].column < states_)
      jacobian_[static_cast<std::size_t>(entries[e].row) * n + static_cast<std::size_t>(entries[e].column)] =
          slopes_registers_[program.output(n + e)];
  double fastest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double sum = std::abs(jacobian_[i * n + i]);
    for (std::size_t j = 0; j < n; ++j)
      if (j != i) sum += std::sqrt(std::abs(jacobian_[i * n + j] * jacobian_[j * n + i]));
    fastest = std::max(fastest, sum);
  }
  return fastest;
}

/// The step that ExplicitStep took, differentiated. False if it is too long for the method to be stable: states at rest do
/// not show it, their sensitivities would grow without bound.
bool StateSimulator::ExplicitSlopes(double fraction, double share, double period) {
  const double step = share * period;
  const auto n = static_cast<std::size_t>(states_), size = n * static_cast<std::size_t>(columns_);
  std::array<double, kMaxStates> rate;
  for (int s = 0; s + 1 < kStages; ++s) {
    Combine(s_.data(), ks_.data(), kA[s], s, step, size, stage_s_.data());
    RateAndSlopes(stage_x_.data() + static_cast<std::size_t>(s) * n,
                  fraction + kNodes[static_cast<std::size_t>(s)] * share, rate.data());
    if (s == 0) {
      fastest_ = Fastest();
      if (!(step * fastest_ <= kStable)) return false;
    }
    SlopesOfRate(stage_s_.data(), ks_.data() + static_cast<std::size_t>(s) * size);
  }
  Combine(s_.data(), ks_.data(), kA[kStages - 1], kStages - 1, step, size, stage_s_.data());
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

/// States beyond a limit are put onto it; a state that is the rate of one that stops is 0.
void StateSimulator::Clamp() {
  for (int i = 0; i < states_; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const bool high = x_[at] > limits_[states_ + i], low = x_[at] < limits_[i];
    if (!high && !low) continue;
    const int limit = high ? states_ + i : i;
    x_[at] = limits_[limit];
    if (with_slopes_) {
      double* row = s_.data() + i * columns_;
      std::fill_n(row, columns_, 0.0);
      for (int p = 0; p < parameters_; ++p) row[p] = limit_slopes_(limit, p);
    }
    const int rate = model_->rate_of[at];
    if (rate < 0 ||
        (high ? x_[static_cast<std::size_t>(rate)] <= 0 : x_[static_cast<std::size_t>(rate)] >= 0))
      continue;
    x_[static_cast<std::size_t>(rate)] = 0;
    if (with_slopes_) std::fill_n(s_.data() + rate * columns_, columns_, 0.0);
  }
}

/// From one row to the next.
bool StateSimulator::Interval(double period) {
  constexpr double kSafety = 0.9, kSmallest = 0.2, kLargest = 5, kWhole = 1 - 1e-9;
  double done = 0;
  int taken = 0;
  while (done < kWhole) {
    const double share = std::min(next_share_, 1 - done);
    double error = 0;
    const bool fine =
        stiff_ ? ImplicitStep(done, share, period, error) : ExplicitStep(done, share, period, error);
    ++steps_;
    if (++taken > options_.max_steps) return false;
    if (!stiff_ && taken > options_.stiff_steps) {
      stiff_ = true;
      next_share_ = 1;
      continue;
    }
    const double order = stiff_ ? 4 : 5;
    const double factor =
        fine ? kSafety * std::pow(options_.tolerance / std::max(error, 1e-30), 1 / order) : kSmallest;
    if (!fine || error > options_.tolerance) {
      next_share_ = share * std::clamp(factor, kSmallest, 1.0);
      if (next_share_ < 1e-9) return false;
      continue;
    }
    if (with_slopes_ && stiff_) s_.swap(stage_s_);
    if (with_slopes_ && !stiff_ && !ExplicitSlopes(done, share, period)) {
      if (!std::isfinite(fastest_)) return false;
      next_share_ = kStableAgain / (fastest_ * period);
      continue;
    }
    x_.swap(next_);
    Clamp();
    for (int i = 0; i < states_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      scale_[at] = std::max(scale_[at], std::abs(x_[at]));
      if (!(std::abs(x_[at]) < options_.divergence)) return false;
    }
    done += share;
    // A step that was cut by the row says nothing of the next one.
    if (share >= next_share_ || factor < 1) next_share_ = share * std::clamp(factor, kSmallest, kLargest);
    next_share_ = std::min(next_share_, 1.0);
  }
  return true;
}

void StateSimulator::Output(int row, StateRun& run) {
  const Equations& output = model_->output;
  const ExpressionProgram& program = with_slopes_ ? output.slopes : output.values;
  std::vector<double>& registers = with_slopes_ ? output_slopes_registers_ : output_registers_;
  std::copy(x_.begin(), x_.end(), registers.begin());
  std::copy(u0_.begin(), u0_.end(), registers.begin() + states_);
  program.Run(registers.data());
  for (int j = 0; j < output.rows; ++j)
    run.outputs(row, j) = registers[program.output(static_cast<std::size_t>(j))];
  for (int i = 0; i < states_; ++i) run.states(row, i) = x_[static_cast<std::size_t>(i)];
  if (!with_slopes_) return;
  for (int j = 0; j < output.rows; ++j) run.slopes.row(row * output.rows + j).setZero();
  for (std::size_t e = 0; e < output.entries.size(); ++e) {
    const auto [j, column] = output.entries[e];
    const double slope = registers[program.output(static_cast<std::size_t>(output.rows) + e)];
    double* to = run.slopes.row(row * output.rows + j).data();
    if (column < states_)
      AddTimes(slope, s_.data() + column * columns_, columns_, to);
    else
      to[column - states_] += slope;
  }
  if (added_ == nullptr) return;
  added_->values(x_.data(), u0_.data(), added_values_.data());
  for (int j = 0; j < output.rows; ++j)
    for (int k = 0; k < added_->count; ++k)
      run.slopes(row * output.rows + j, columns_ + j * added_->count + k) =
          added_values_[static_cast<std::size_t>(k)];
}

void StateSimulator::Run(const Episode& episode, int first, int last, const Eigen::VectorXd& x0,
                         const RowMatrix* start_slopes, StateRun& run, const AddedTerms* added) {
  const int rows = last - first + 1, outputs = model_->output.rows;
  with_slopes_ = start_slopes != nullptr;
  added_ = with_slopes_ ? added : nullptr;
  columns_ = with_slopes_ ? static_cast<int>(start_slopes->cols()) : 0;
  added_from_ = columns_;
  if (added_ != nullptr) columns_ += added_->count * states_;
  run.diverged = false;
  run.rows = 0;
  run.outputs.resize(rows, outputs);
  run.states.resize(rows, states_);
  if (with_slopes_) {
    const auto size = static_cast<std::size_t>(states_ * columns_);
    s_.assign(size, 0.0);
    stage_s_.assign(size, 0.0);
    ks_.assign(size * kStages, 0.0);
    for (int i = 0; i < states_; ++i)
      std::copy_n(start_slopes->row(i).data(), start_slopes->cols(), s_.data() + i * columns_);
    if (added_ != nullptr) added_values_.assign(static_cast<std::size_t>(added_->count), 0.0);
    run.slopes.resize(rows * outputs, columns_ + (added_ == nullptr ? 0 : added_->count * outputs));
  }
  std::copy(x0.begin(), x0.end(), x_.begin());
  for (int i = 0; i < states_; ++i) scale_[static_cast<std::size_t>(i)] = std::abs(x0[i]);
  stiff_ = false;
  next_share_ = 1;
  const auto input = [&](int row, std::vector<double>& u) {
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = episode.signal(row, model_->inputs[i]);
  };
  input(first, u1_);
  for (int row = 0; row < rows; ++row) {
    u0_.swap(u1_);
    Output(row, run);
    run.rows = row + 1;
    if (row + 1 == rows) break;
    input(first + row + 1, u1_);
    const auto at = static_cast<std::size_t>(first + row);
    if (!Interval(episode.time[at + 1] - episode.time[at])) {
      run.diverged = true;
      break;
    }
  }
  run.end = Eigen::Map<const Eigen::VectorXd>(x_.data(), states_);
  if (with_slopes_) run.end_slopes = Eigen::Map<const RowMatrix>(s_.data(), states_, columns_);
}

}  // namespace hydroscope
