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

/// Columns of sensitivities are padded to a multiple of this, which loops over them run in.
constexpr int kPadding = 4;

inline void AddTimes(double factor, const double* __restrict from, int columns, double* __restrict to) {
  for (int c = 0; c < columns; c += kPadding)
    for (int k = 0; k < kPadding; ++k) to[c + k] += factor * from[c + k];
}

/// Few numbers, for which a call of memmove takes longer than they do.
inline void CopyFew(const double* from, int count, double* to) {
  for (int i = 0; i < count; ++i) to[i] = from[i];
}

/// The equations at a point, as their tangent needs them.
struct TangentPoint {
  const double* entries;      ///< values of Equations::entries
  const unsigned char* held;  ///< per state
  const double* added;        ///< values of the added terms
};

/// Shapes of the sensitivities.
struct TangentShape {
  const std::vector<Equations::Slope>& entries;
  int states, columns;
  const AddedTerms* terms;
  int terms_from;  ///< column
};

/// out = J s + df/dp + what added terms give.
inline void RateOfSlopes(const TangentShape& shape, const TangentPoint& point, const double* s, double* out) {
  const int columns = shape.columns;
  std::fill_n(out, shape.states * columns, 0.0);
  const double* entry = point.entries;
  for (const auto& [row, column] : shape.entries) {
    const double value = *entry++;
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
  for (int stage = 0; stage + 1 < kStages; ++stage) {
    CombineCounted(s, k, kA[stage], stage, step, size, end);
    RateOfSlopes(shape, stages[stage], end, k + static_cast<std::size_t>(stage) * size);
  }
  CombineCounted(s, k, kA[kStages - 1], kStages - 1, step, size, end);
}

}  // namespace

StateSimulator::StateSimulator(std::shared_ptr<const StateModel> model, const SimulationOptions& options)
    : model_(std::move(model)),
      options_(options),
      states_(model_->states()),
      inputs_(model_->driving()),
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
  stage_entries_.assign(model_->dynamics.entries.size() * kStages, 0.0);
  stage_held_.assign(n * kStages, 0);
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

/// Inputs at a row and at the next one; of the last row at it alone. What is delayed: TakeDelayed.
void StateSimulator::TakeInputs(const Episode& episode, int row) {
  const int next = std::min(row + 1, episode.rows() - 1);
  for (std::size_t i = 0; i < model_->inputs.size(); ++i) {
    u0_[i] = episode.signal(row, model_->inputs[i]);
    u1_[i] = episode.signal(next, model_->inputs[i]);
  }
}

/// Shares of the time from a row to the next at which the rows of delayed inputs arrive, with 0 and 1.
void StateSimulator::Breaks(const Episode& episode, int row) {
  constexpr double kApart = 1e-9;
  const auto at = static_cast<std::size_t>(row);
  breaks_.assign({0.0, 1.0});
  const double begin = episode.time[at], period = episode.time[at + 1] - begin;
  for (const DelayedInput& delay : model_->delays) {
    const double seconds = delay.parameter < 0 ? delay.seconds : theta_[delay.parameter];
    for (auto t = std::upper_bound(episode.time.begin(), episode.time.end(), begin - seconds);
         t != episode.time.end() && *t + seconds < begin + period; ++t)
      breaks_.push_back((*t + seconds - begin) / period);
  }
  std::sort(breaks_.begin(), breaks_.end());
  breaks_.erase(
      std::unique(breaks_.begin(), breaks_.end(), [](double a, double b) { return b - a < kApart; }),
      breaks_.end());
  breaks_.back() = 1;
}

/// Delayed inputs from one share of a row's time to another between which none of them jumps or bends; before the episode
/// they are what they are at its first row. Where one jumps, a state arrives there with the rate of before for as much longer
/// as the delay grows: its sensitivity jumps by the difference of the rates.
void StateSimulator::TakeDelayed(const Episode& episode, int row, double from, double to) {
  const auto at = static_cast<std::size_t>(row);
  const double period = at + 1 < episode.time.size() ? episode.time[at + 1] - episode.time[at] : 0;
  const bool jumps = with_slopes_ && !linear_ && !(row == first_ && from == 0);
  std::array<double, kMaxStates> before, after;
  for (std::size_t d = 0; d < model_->delays.size(); ++d) {
    const DelayedInput& delay = model_->delays[d];
    const double seconds = delay.parameter < 0 ? delay.seconds : theta_[delay.parameter];
    const auto value = [&](double time, std::size_t k) {
      const double here =
          episode.signal(static_cast<Eigen::Index>(k), model_->inputs[static_cast<std::size_t>(delay.input)]);
      if (!linear_ || k + 1 >= episode.time.size()) return std::pair(here, 0.0);
      const double next = episode.signal(static_cast<Eigen::Index>(k + 1),
                                         model_->inputs[static_cast<std::size_t>(delay.input)]);
      const double rate = (next - here) / (episode.time[k + 1] - episode.time[k]);
      return std::pair(here + rate * (time - episode.time[k]), rate);
    };
    // The row that holds in the middle of the part holds over all of it.
    const double begin = episode.time[at] + from * period - seconds,
                 end = episode.time[at] + to * period - seconds;
    const auto later = std::upper_bound(episode.time.begin(), episode.time.end(), 0.5 * (begin + end));
    const bool early = later == episode.time.begin();
    const std::size_t k = early ? 0 : static_cast<std::size_t>(later - episode.time.begin()) - 1;
    const auto [first, rate] = early ? std::pair(value(episode.time[0], 0).first, 0.0) : value(begin, k);
    const double last = early ? first : value(end, k).first;
    const std::size_t place = model_->inputs.size() + static_cast<std::size_t>(DelayedInput::kRegisters) * d;
    const bool jump = jumps && delay.parameter >= 0 && first != u0_[place];
    if (jump) Rate(x_.data(), 0, before.data());
    u0_[place] = first;
    u1_[place] = last;
    u0_[place + 1] = u1_[place + 1] = rate;
    u0_[place + 2] = u1_[place + 2] = seconds;
    if (!jump) continue;
    Rate(x_.data(), 0, after.data());
    for (int i = 0; i < states_; ++i)
      s_[static_cast<std::size_t>(i * columns_ + delay.parameter)] +=
          before[static_cast<std::size_t>(i)] - after[static_cast<std::size_t>(i)];
  }
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
  CopyFew(x, states_, r);
  CopyFew(u_.data(), inputs_, r + states_);
  const ExpressionProgram& program = model_->dynamics.values;
  program.Run(r);
  for (int i = 0; i < states_; ++i) rate[i] = r[program.output(static_cast<std::size_t>(i))];
  HoldAtLimits(x, rate, false);
}

void StateSimulator::RateAndSlopes(const double* x, double fraction, double* rate) {
  InputAt(fraction);
  double* r = slopes_registers_.data();
  CopyFew(x, states_, r);
  CopyFew(u_.data(), inputs_, r + states_);
  const ExpressionProgram& program = model_->dynamics.slopes;
  program.Run(r);
  for (int i = 0; i < states_; ++i) rate[i] = r[program.output(static_cast<std::size_t>(i))];
  HoldAtLimits(x, rate, true);
}

/// Rates of the sensitivities at the point that RateAndSlopes looked at.
void StateSimulator::SlopesOfRate(const double* s, double* out) {
  KeepStage(0);
  RateOfSlopes({model_->dynamics.entries, states_, columns_, added_, added_from_},
               {stage_entries_.data(), stage_held_.data(), stage_added_.data()}, s, out);
}

/// Keeps what ExplicitSlopes needs of the point that RateAndSlopes looked at.
void StateSimulator::KeepStage(std::size_t stage) {
  const ExpressionProgram& program = model_->dynamics.slopes;
  const auto n = static_cast<std::size_t>(states_), count = model_->dynamics.entries.size();
  for (std::size_t e = 0; e < count; ++e)
    stage_entries_[stage * count + e] = slopes_registers_[program.output(n + e)];
  for (std::size_t i = 0; i < n; ++i) stage_held_[stage * n + i] = held_[i];
  if (added_ == nullptr) return;
  added_->evaluate(slopes_registers_.data(), u_.data(),
                   stage_added_.data() + stage * static_cast<std::size_t>(added_->values));
}

bool StateSimulator::ExplicitStep(double fraction, double share, double period, double& error) {
  const double step = share * period;
  const auto n = static_cast<std::size_t>(states_);
  for (int s = begun_ ? 1 : 0; s < kStages; ++s) {
    const auto at = static_cast<std::size_t>(s);
    double *x = stage_x_.data() + at * n, *k = k_.data() + at * n;
    Combine(x_.data(), k_.data(), kA[s], s, step, n, x);
    const double here = fraction + kNodes[at] * share;
    if (with_slopes_ && s + 1 < kStages) {
      RateAndSlopes(x, here, k);
      KeepStage(at);
    } else {
      Rate(x, here, k);
    }
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
          stage_entries_[e];
  double fastest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double sum = std::abs(jacobian_[i * n + i]);
    for (std::size_t j = 0; j < n; ++j) {
      const double product = jacobian_[i * n + j] * jacobian_[j * n + i];
      if (j != i && product != 0) sum += std::sqrt(std::abs(product));
    }
    fastest = std::max(fastest, sum);
  }
  return fastest;
}

/// The step that ExplicitStep took, differentiated. False if it is too long for the method to be stable: states at rest do
/// not show it, their sensitivities would grow without bound.
bool StateSimulator::ExplicitSlopes(double share, double period) {
  const double step = share * period;
  fastest_ = Fastest();
  if (!(step * fastest_ <= kStable)) return false;
  const auto n = static_cast<std::size_t>(states_), entries = model_->dynamics.entries.size(),
             values = added_ == nullptr ? 0 : static_cast<std::size_t>(added_->values);
  std::array<TangentPoint, kStages> stages;
  for (std::size_t s = 0; s < kStages; ++s)
    stages[s] = {stage_entries_.data() + s * entries, stage_held_.data() + s * n,
                 stage_added_.data() + s * values};
  DifferentiateStep({model_->dynamics.entries, states_, columns_, added_, added_from_}, stages.data(), step,
                    s_.data(), ks_.data(), stage_s_.data());
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
  begun_ = false;
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
    if (with_slopes_ && !stiff_ && !ExplicitSlopes(share, period)) {
      if (!std::isfinite(fastest_)) return false;
      next_share_ = kStableAgain / (fastest_ * period);
      continue;
    }
    x_.swap(next_);
    begun_ = false;
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

/// From a row to the next, in parts where delayed inputs jump or bend in between.
bool StateSimulator::Row(const Episode& episode, int row) {
  const auto at = static_cast<std::size_t>(row);
  const double period = episode.time[at + 1] - episode.time[at];
  if (model_->delays.empty()) return Interval(period);
  Breaks(episode, row);
  const std::size_t undelayed = model_->inputs.size();
  double before = 1;
  for (std::size_t b = 0; b + 1 < breaks_.size(); ++b) {
    const double from = breaks_[b], to = breaks_[b + 1];
    TakeInputs(episode, row);
    for (std::size_t i = 0; linear_ && i < undelayed; ++i) {
      const double begin = u0_[i], rise = u1_[i] - begin;
      u0_[i] = begin + from * rise;
      u1_[i] = begin + to * rise;
    }
    TakeDelayed(episode, row, from, to);
    next_share_ = std::min(1.0, next_share_ * before / (to - from));
    before = to - from;
    if (!Interval(period * (to - from))) return false;
  }
  next_share_ = std::min(1.0, next_share_ * before);
  return true;
}

void StateSimulator::Output(int row, StateRun& run) {
  const Equations& output = model_->output;
  const ExpressionProgram& program = with_slopes_ ? output.slopes : output.values;
  std::vector<double>& registers = with_slopes_ ? output_slopes_registers_ : output_registers_;
  CopyFew(x_.data(), states_, registers.data());
  CopyFew(u0_.data(), inputs_, registers.data() + states_);
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
    const double* from = s_.data() + column * columns_;
    if (column >= states_)
      to[column - states_] += slope;
    else
      for (int c = 0; c < wanted_; ++c) to[c] += slope * from[c];
  }
  if (added_ == nullptr || added_->to_outputs.empty()) return;
  added_->evaluate(x_.data(), u0_.data(), added_values_.data());
  for (const auto& [value, j, column] : added_->to_outputs)
    run.slopes(row * output.rows + j, added_from_ + column) += added_values_[static_cast<std::size_t>(value)];
}

/// What the readings of a row, `run.outputs` of it being what was foreseen, say of the states.
void StateSimulator::Correct(const Episode& episode, int row, const StateRun& run) {
  const int outputs = model_->output.rows;
  for (int j = 0; j < outputs; ++j) {
    const Eigen::Index at = run.rows - 1;
    const double error =
        episode.signal(row, model_->outputs[static_cast<std::size_t>(j)]) - run.outputs(at, j);
    if (!std::isfinite(error)) continue;
    for (int i = 0; i < states_; ++i) {
      x_[static_cast<std::size_t>(i)] += gain_(i, j) * error;
      if (!with_slopes_) continue;
      double* slopes = s_.data() + i * columns_;
      for (int c = 0; c < wanted_; ++c) slopes[c] -= gain_(i, j) * run.slopes(at * outputs + j, c);
      slopes[parameters_ + i * outputs + j] += error;
    }
  }
  Clamp();
}

void StateSimulator::Run(const Episode& episode, int first, int last, const Eigen::VectorXd& x0,
                         const RowMatrix* start_slopes, StateRun& run, const AddedTerms* added) {
  const int rows = last - first + 1, outputs = model_->output.rows;
  with_slopes_ = start_slopes != nullptr;
  added_ = with_slopes_ ? added : nullptr;
  columns_ = with_slopes_ ? static_cast<int>(start_slopes->cols()) : 0;
  added_from_ = columns_;
  if (added_ != nullptr) columns_ += added_->moving;
  wanted_ = columns_;
  columns_ = (columns_ + kPadding - 1) / kPadding * kPadding;
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
    const std::size_t values = added_ == nullptr ? 0 : static_cast<std::size_t>(added_->values);
    added_values_.assign(values, 0.0);
    stage_added_.assign(values * kStages, 0.0);
    run.slopes.resize(rows * outputs, wanted_ + (added_ == nullptr ? 0 : added_->columns - added_->moving));
  }
  std::copy(x0.begin(), x0.end(), x_.begin());
  for (int i = 0; i < states_; ++i) scale_[static_cast<std::size_t>(i)] = std::abs(x0[i]);
  stiff_ = false;
  next_share_ = 1;
  first_ = first;
  for (int row = first; row <= last; ++row) {
    TakeInputs(episode, row);
    if (!model_->delays.empty()) TakeDelayed(episode, row, 0, 0);
    Output(row - first, run);
    run.rows = row - first + 1;
    if (row == last) break;
    if (gain_.size() > 0) Correct(episode, row, run);
    if (!Row(episode, row)) {
      run.diverged = true;
      break;
    }
  }
  run.end = Eigen::Map<const Eigen::VectorXd>(x_.data(), states_);
  if (with_slopes_)
    run.end_slopes = Eigen::Map<const RowMatrix>(s_.data(), states_, columns_).leftCols(wanted_);
}

}  // namespace hydroscope
