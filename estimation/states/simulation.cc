#include "estimation/states/simulation.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

/// `apart`: of the registers.
TangentEntries EntriesOf(const StateModel& model, std::size_t apart) {
  TangentEntries out;
  const auto states = static_cast<std::size_t>(model.states());
  for (std::size_t e = 0; e < model.dynamics.entries.size(); ++e) {
    const auto [row, column] = model.dynamics.entries[e];
    const std::size_t place = model.dynamics.slopes.output(states + e) * apart;
    if (column < model.states())
      out.by_states.push_back({row, column, place});
    else
      out.by_parameters.push_back({row, column - model.states(), place});
  }
  return out;
}

}  // namespace

StateSimulator::StateSimulator(std::shared_ptr<const StateModel> model, const SimulationOptions& options)
    : model_(std::move(model)),
      options_(options),
      states_(model_->states()),
      inputs_(model_->driving()),
      parameters_(model_->parameter_count()),
      hold_(model_->machine.log.hold),
      late_(model_->machine.log.outputs_late.value_or(0)),
      values_registers_(model_->dynamics.values.Registers()),
      slopes_registers_(model_->dynamics.slopes.Registers()),
      output_registers_(model_->output.values.Registers()),
      output_slopes_registers_(model_->output.slopes.Registers()),
      point_registers_(model_->dynamics.slopes.PointRegisters()),
      held_(static_cast<std::size_t>(states_)) {
  const auto n = static_cast<std::size_t>(states_), m = static_cast<std::size_t>(inputs_);
  for (auto* v : {&x_, &next_, &scale_}) v->assign(n, 0.0);
  for (auto* v : {&u0_, &u1_, &bend0_, &bend1_, &u_, &ended_u_}) v->assign(m, 0.0);
  k_.assign(n * kStateStages, 0.0);
  for (std::size_t i = 0; i < n; ++i) rate_places_.push_back(model_->dynamics.values.output(i));
  entries_ = EntriesOf(*model_, 1);
  point_entries_ = EntriesOf(*model_, ExpressionProgram::kPoints);
  stage_held_.assign(n * kStateStages, 0);
  stage_x_.assign(n * kStateStages, 0.0);
  jacobian_.assign(n * n, 0.0);
  stage_factor_.assign(n * n, 0.0);
  stage_pivots_.assign(n, 0);
  stage_factor_held_.assign(n, 0);
}

void StateSimulator::KnowParameters() {
  parameters_ = 0;
  for (TangentEntries* entries : {&entries_, &point_entries_}) entries->by_parameters.clear();
}

void StateSimulator::SetParameters(const Eigen::VectorXd& parameters) {
  theta_ = parameters;
  const auto first = static_cast<std::ptrdiff_t>(states_ + inputs_);
  const auto fix = [&](const ExpressionProgram& program, std::vector<double>& registers) {
    std::ranges::copy(theta_, registers.begin() + first);
    program.RunFixed(registers.data());
  };
  fix(model_->dynamics.values, values_registers_);
  fix(model_->dynamics.slopes, slopes_registers_);
  fix(model_->output.values, output_registers_);
  fix(model_->output.slopes, output_slopes_registers_);
  for (Eigen::Index p = 0; p < theta_.size(); ++p)
    std::fill_n(point_registers_.begin() + (first + p) * ExpressionProgram::kPoints,
                ExpressionProgram::kPoints, theta_[p]);
  model_->dynamics.slopes.RunFixedPoints(point_registers_.data());

  const ExpressionProgram& program = model_->limits.slopes;
  std::vector<double> registers = program.Registers();
  std::ranges::copy(theta_, registers.begin());
  program.RunFixed(registers.data());
  program.Run(registers.data());
  limits_.resize(2 * states_);
  limit_slopes_ = RowMatrix::Zero(2 * states_, theta_.size());
  for (int r = 0; r < 2 * states_; ++r) limits_[r] = registers[program.output(static_cast<std::size_t>(r))];
  limited_ = limits_.array().isFinite().any();
  std::ranges::fill(held_, 0);
  std::ranges::fill(stage_held_, 0);
  for (std::size_t e = 0; e < model_->limits.entries.size(); ++e)
    limit_slopes_(model_->limits.entries[e].row, model_->limits.entries[e].column) =
        registers[program.output(static_cast<std::size_t>(2 * states_) + e)];
}

std::vector<double> StateSimulator::InitialRegisters(const Episode& episode) const {
  const ExpressionProgram& program = model_->initial.slopes;
  std::vector<double> registers = program.Registers();
  const Eigen::Index signals = episode.signal.cols();
  for (Eigen::Index s = 0; s < signals; ++s) registers[s] = episode.Reading(0, static_cast<int>(s));
  std::ranges::copy(theta_, registers.begin() + signals);
  program.RunFixed(registers.data());
  program.Run(registers.data());
  return registers;
}

Eigen::VectorXd StateSimulator::Near(const Episode& episode) const {
  const std::vector<double> registers = InitialRegisters(episode);
  Eigen::VectorXd x0(states_);
  for (int i = 0; i < states_; ++i) {
    const auto s = static_cast<std::size_t>(i);
    x0[i] = model_->near[s] ? registers[model_->initial.slopes.output(s)]
                            : std::numeric_limits<double>::quiet_NaN();
  }
  return x0;
}

Eigen::VectorXd StateSimulator::Initial(const Episode& episode, const Eigen::VectorXd& estimated,
                                        RowMatrix* slopes) {
  const ExpressionProgram& program = model_->initial.slopes;
  const std::vector<double> registers = InitialRegisters(episode);
  Eigen::VectorXd x0(states_);
  for (int i = 0; i < states_; ++i) {
    const auto s = static_cast<std::size_t>(i);
    x0[i] = model_->estimated[s] ? estimated[i] : registers[program.output(s)];
    x0[i] = std::clamp(x0[i], limits_[i], std::max(limits_[i], limits_[states_ + i]));
  }
  if (slopes == nullptr) return x0;
  *slopes = RowMatrix::Zero(states_, theta_.size());
  for (std::size_t e = 0; e < model_->initial.entries.size(); ++e) {
    const auto [row, column] = model_->initial.entries[e];
    if (!model_->estimated[row])
      (*slopes)(row, column) = registers[program.output(static_cast<std::size_t>(states_) + e)];
  }
  return x0;
}

/// What drives a state beyond its limit is stopped there; where its rate is a state, a force into the stop moves that neither.
void StateSimulator::HoldAtLimits(const double* x, double* rate) {
  // Through pointers of its own: a byte that is written might be any of the members.
  const int states = states_;
  const double *low = limits_.data(), *high = low + states;
  unsigned char* held = held_.data();
  for (int i = 0; i < states; ++i) {
    held[i] = (x[i] >= high[i] && rate[i] > 0) || (x[i] <= low[i] && rate[i] < 0);
    if (held[i] != 0) rate[i] = 0;
  }
  const int* rate_of = model_->rate_of.data();
  for (int i = 0; i < states; ++i) {
    const int v = rate_of[i];
    if (v < 0) continue;
    const bool pressed =
        (x[i] >= high[i] && x[v] >= 0 && rate[v] > 0) || (x[i] <= low[i] && x[v] <= 0 && rate[v] < 0);
    if (!pressed) continue;
    held[v] = 1;
    rate[v] = 0;
  }
}

void StateSimulator::RateAndSlopes(const double* x, double fraction, double* rate) {
  InputAt(fraction);
  double* r = slopes_registers_.data();
  CopyFew(x, states_, r);
  CopyFew(u_.data(), inputs_, r + states_);
  const ExpressionProgram& program = model_->dynamics.slopes;
  program.Run(r);
  for (int i = 0; i < states_; ++i) rate[i] = r[program.output(static_cast<std::size_t>(i))];
  if (limited_) HoldAtLimits(x, rate);
}

/// States beyond a limit are put onto it; a state that is the rate of one that stops is 0. False: there are none.
bool StateSimulator::Clamp() {
  bool clamped = false;
  for (int i = 0; i < states_; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const int rate = model_->rate_of[at];
    const double speed = rate < 0 ? 0.0 : x_[rate];  // into a stop that is just reached
    const double above = x_[at] - limits_[states_ + i], below = limits_[i] - x_[at];
    const bool high = above > 0 || (above == 0 && speed > 0), low = below > 0 || (below == 0 && speed < 0);
    if (!high && !low) continue;
    clamped = true;
    const int limit = high ? states_ + i : i;
    x_[at] = limits_[limit];
    if (with_slopes_) {
      double* row = s_.data() + i * columns_;
      std::fill_n(row, columns_, 0.0);
      for (int p = 0; p < parameters_; ++p) row[p] = limit_slopes_(limit, p);
    }
    if (rate < 0 || (high ? speed <= 0 : speed >= 0)) continue;
    x_[rate] = 0;
    if (with_slopes_) std::fill_n(s_.data() + rate * columns_, columns_, 0.0);
  }
  return clamped;
}

/// From one row to the next.
bool StateSimulator::Interval(double period) {
  constexpr double kStableAgain = 2.5;  // what a step times the fastest rate is cut to where it is not stable
  constexpr double kSafety = 0.9, kSmallest = 0.2, kLargest = 5, kWhole = 1 - 1e-9;
  constexpr int kImplicitWork = 10, kSlopesWork = 4;  // roughly
  constexpr double kSafetyTo4 = kSafety * kSafety * kSafety * kSafety;
  double done = 0;
  int taken = 0;
  begun_ = begun_ && BeginsAsItEnded();
  while (done < kWhole) {
    const double share = std::min(next_share_, 1 - done);
    double error = 0;
    const bool fine =
        stiff_ ? ImplicitStep(done, share, period, error) : ExplicitStep(done, share, period, error);
    ++steps_;
    work_ += (stiff_ ? kImplicitWork : 1) * (with_slopes_ ? kSlopesWork : 1);
    if (++taken > options_.max_steps) return false;
    if (!stiff_ && taken > options_.stiff_steps) {
      stiff_ = true;
      next_share_ = 1;
      continue;
    }
    const float order = stiff_ ? 4 : 5;  // a step's length needs no more digits
    const auto factor = [&] {
      return kSafety * std::pow(static_cast<float>(options_.tolerance / std::max(error, 1e-30)), 1 / order);
    };
    if (!fine || error > options_.tolerance) {
      next_share_ = share * (fine ? std::clamp(factor(), kSmallest, 1.0) : kSmallest);
      if (next_share_ < 1e-9) return false;
      continue;
    }
    if (with_slopes_ && stiff_) ImplicitSlopes(done, share, period);
    if (with_slopes_ && !stiff_ && !ExplicitSlopes(done, share, period)) {
      if (!std::isfinite(fastest_)) return false;
      next_share_ = kStableAgain / (fastest_ * period);
      continue;
    }
    x_.swap(next_);
    begun_ = !(limited_ && Clamp()) && !stiff_;
    if (begun_) KeepLastStage();
    for (int i = 0; i < states_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      scale_[at] = std::max(scale_[at], std::abs(x_[at]));
      if (!(std::abs(x_[at]) < options_.divergence)) return false;
    }
    done += share;
    // A step that was cut by the row says nothing of the next one; one of the whole row is never longer.
    const bool shrinks = error > options_.tolerance * kSafetyTo4 * (stiff_ ? 1 : kSafety);
    if (shrinks || (share >= next_share_ && share < 1))
      next_share_ = share * std::clamp(factor(), kSmallest, kLargest);
    next_share_ = std::min(next_share_, 1.0);
  }
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
  for (int i = 0; i < states_; ++i) run.states(row, i) = x_[i];
  if (!with_slopes_) return;
  for (int j = 0; j < output.rows; ++j) run.slopes.row(row * output.rows + j).setZero();
  for (std::size_t e = 0; e < output.entries.size(); ++e) {
    const auto [j, column] = output.entries[e];
    if (column >= states_ + parameters_) continue;
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
    run.slopes(row * output.rows + j, added_from_ + column) += added_values_[value];
}

/// Puts the mean since the last reading in place of the output where there is a reading, by Simpson's rule. A mean that began
/// before the run is not known.
void StateSimulator::Average(const Episode& episode, int row, StateRun& run) {
  const int at = row - first_, outputs = model_->output.rows, part = row % episode.mean_rows;
  const double share = 1.0 / (3 * episode.mean_rows),
               weight = part == 0 ? share : (part % 2 == 1 ? 4 : 2) * share;
  const RowMatrix now = run.outputs.row(at);
  RowMatrix slopes;
  if (with_slopes_) slopes = run.slopes.middleRows(at * outputs, outputs);
  if (at == 0) {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    mean_outputs_.setConstant(1, outputs, part == 0 ? 0.0 : kUnknown);
    mean_slopes_.setZero(slopes.rows(), slopes.cols());
    run.outputs.row(0).setConstant(kUnknown);
  }
  mean_outputs_ += weight * now;
  if (with_slopes_) mean_slopes_ += weight * slopes;
  if (part != 0 || at == 0) return;
  run.outputs.row(at) = mean_outputs_;
  mean_outputs_ = weight * now;
  if (!with_slopes_) return;
  run.slopes.middleRows(at * outputs, outputs) = mean_slopes_;
  mean_slopes_ = weight * slopes;
}

/// What the readings of a row, `run.outputs` of it being what was foreseen, say of the states.
void StateSimulator::Correct(const Episode& episode, int row, const StateRun& run) {
  const int outputs = model_->output.rows;
  begun_ = false;
  for (int j = 0; j < outputs; ++j) {
    const Eigen::Index at = run.rows - 1;
    const double error = episode.signal(row, model_->outputs[j]) - run.outputs(at, j);
    if (!std::isfinite(error)) continue;
    for (int i = 0; i < states_; ++i) {
      x_[i] += gain_(i, j) * error;
      if (!with_slopes_) continue;
      double* slopes = s_.data() + i * columns_;
      for (int c = 0; c < wanted_; ++c) slopes[c] -= gain_(i, j) * run.slopes(at * outputs + j, c);
      slopes[parameters_ + i * outputs + j] += error;
    }
  }
  if (limited_) Clamp();
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
  columns_ = (columns_ + kSensitivityPadding - 1) / kSensitivityPadding * kSensitivityPadding;
  run.diverged = false;
  run.rows = 0;
  run.outputs.resize(rows, outputs);
  run.states.resize(rows, states_);
  if (with_slopes_) {
    const auto size = static_cast<std::size_t>(states_ * columns_);
    s_.assign(size, 0.0);
    stage_s_.assign(size, 0.0);
    ks_.assign(size * kStateStages, 0.0);
    for (int i = 0; i < states_; ++i)
      std::copy_n(start_slopes->row(i).data(), start_slopes->cols(), s_.data() + i * columns_);
    const std::size_t values = added_ == nullptr ? 0 : static_cast<std::size_t>(added_->values);
    added_values_.assign(values, 0.0);
    stage_added_.assign(values * kStateStages, 0.0);
    run.slopes.resize(rows * outputs, wanted_ + (added_ == nullptr ? 0 : added_->columns - added_->moving));
  }
  std::ranges::copy(x0, x_.begin());
  for (int i = 0; i < states_; ++i) scale_[i] = std::abs(x0[i]);
  stiff_ = false;
  begun_ = false;
  next_share_ = 1;
  first_ = first;
  const std::int64_t before = steps_;
  for (int row = first; row <= last; ++row) {
    constexpr int kTryAgain = 32;  // rows after which what was stiff, or an end stop, may be over
    if ((row - first) % kTryAgain == 0) stiff_ = false;
    TakeInputs(episode, row);
    Output(row - first, run);
    if (episode.mean_rows > 1) Average(episode, row, run);
    run.rows = row - first + 1;
    if (row == last) break;
    if (gain_.size() > 0) Correct(episode, row, run);
    const std::int64_t most = options_.spare_steps + std::int64_t{options_.mean_steps} * run.rows;
    if (!Row(episode, row) || steps_ - before > most) {
      run.diverged = true;
      break;
    }
  }
  run.end = Eigen::Map<const Eigen::VectorXd>(x_.data(), states_);
  if (with_slopes_)
    run.end_slopes = Eigen::Map<const RowMatrix>(s_.data(), states_, columns_).leftCols(wanted_);
}

}  // namespace hydroscope
