#include "diagnosis/states/function_bank.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "core/limits.h"

namespace hydroscope {
namespace {

constexpr int kKnotsOfTerm = 6, kOfOne = 4 + kKnotsOfTerm;
constexpr double kFar = 10;     ///< a run that leaves what was seen counts no further
constexpr double kSteep = 10;   ///< of the smooth sign
constexpr int kMostPaired = 5;  ///< variables; of more, products would be too many to tell apart

}  // namespace

std::vector<double> ValuesOf(const StateFit& fit, std::span<const Episode> episodes, int variable) {
  const int states = fit.model->states();
  std::vector<double> values;
  for (std::size_t e = 0; e < episodes.size(); ++e)
    for (int row = 0; row < episodes[e].rows(); ++row)
      values.push_back(
          variable < states
              ? fit.runs[e].states(row, variable)
              : episodes[e].signal(row, fit.model->inputs[static_cast<std::size_t>(variable - states)]));
  std::sort(values.begin(), values.end());
  return values;
}

FunctionBank::FunctionBank(const StateFit& fit, std::span<const Episode> episodes, int fourier,
                           std::uint32_t seed)
    : model_(*fit.model), states_(fit.model->states()) {
  for (int v = 0; v < states_ + static_cast<int>(model_.inputs.size()); ++v)
    AddVariable(ValuesOf(fit, episodes, v));
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
  for (int k = 0; k < fourier; ++k) {
    for (std::size_t v = 0; v < middle_.size(); ++v) frequency_.push_back(normal(random));
    phase_.push_back(phase(random));
  }
  const int variables = static_cast<int>(middle_.size());
  pairs_ = variables <= kMostPaired;
  count_ =
      1 + variables * kOfOne + (pairs_ ? variables * (variables - 1) : 0) + static_cast<int>(phase_.size());
}

void FunctionBank::AddVariable(const std::vector<double>& values) {
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  const double middle = at(0.5);
  const double spread = std::max({at(0.95) - at(0.05), 1e-3 * (values.back() - values.front()), 1e-300}) / 2;
  middle_.push_back(middle);
  spread_.push_back(spread);
  zero_.push_back(values.front() < 0 && values.back() > 0 ? -middle / spread : 0);
  std::vector<double> knots;
  for (int k = 0; k < kKnotsOfTerm; ++k) knots.push_back((at((k + 0.5) / kKnotsOfTerm) - middle) / spread);
  knots.back() = (at(0.97) - middle) / spread;
  knots_.push_back(std::move(knots));
}

void FunctionBank::Values(const double* state, const double* input, double* out) const {
  std::array<double, 2 * kMaxStates + 64> v{};
  const std::size_t n = std::min(middle_.size(), v.size());
  for (std::size_t i = 0; i < n; ++i) {
    const double x = static_cast<int>(i) < states_ ? state[i] : input[static_cast<int>(i) - states_];
    v[i] = std::clamp((x - middle_[i]) / spread_[i], -kFar, kFar);
  }
  *out++ = 1;
  for (std::size_t i = 0; i < n; ++i) {
    *out++ = v[i];
    *out++ = v[i] * v[i];
    *out++ = v[i] * v[i] * v[i];
    *out++ = std::tanh(kSteep * (v[i] - zero_[i]));
    for (const double knot : knots_[i]) *out++ = std::max(v[i] - knot, 0.0);
  }
  for (std::size_t i = 0; pairs_ && i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      *out++ = v[i] * v[j];
      *out++ = v[i] * std::abs(v[j]);
    }
  const double* frequency = frequency_.data();
  for (const double phase : phase_) {
    double angle = phase;
    for (std::size_t i = 0; i < n; ++i) angle += *frequency++ * v[i];
    *out++ = std::cos(angle);
  }
}

std::string FunctionBank::VariableName(int variable) const {
  if (variable < states_) return model_.machine.states.states[static_cast<std::size_t>(variable)].name;
  const int signal = model_.inputs[static_cast<std::size_t>(variable - states_)];
  return model_.machine.signals[static_cast<std::size_t>(signal)].name;
}

std::optional<int> FunctionBank::Variable(int function) const {
  const int variable = (function - 1) / kOfOne;
  if (function < 1 || variable >= static_cast<int>(middle_.size())) return std::nullopt;
  return variable;
}

std::string FunctionBank::About(int function) const {
  const int variables = static_cast<int>(middle_.size());
  if (function == 0) return "nothing (a constant)";
  if (const auto variable = Variable(function)) return VariableName(*variable);
  function -= 1 + variables * kOfOne;
  for (int i = 0; pairs_ && i < variables; ++i)
    for (int j = 0; j < i; ++j, function -= 2)
      if (function < 2) return VariableName(i) + " and " + VariableName(j);
  return "all states and inputs";
}

AddedTerms FunctionBank::Terms(std::vector<int>& equation) const {
  AddedTerms added;
  added.values = count_;
  added.evaluate = [this](const double* x, const double* u, double* v) { Values(x, u, v); };
  for (int e = 0; e < states_ + model_.output.rows; ++e) {
    const bool of_state = e < states_;
    if (of_state && model_.rate_of[static_cast<std::size_t>(e)] >= 0) continue;
    for (int k = 0; k < count_; ++k) {
      (of_state ? added.to_states : added.to_outputs)
          .push_back({k, of_state ? e : e - states_, added.columns++});
      equation.push_back(e);
    }
    if (of_state) added.moving = added.columns;
  }
  return added;
}

std::string EquationName(const StateModel& model, int equation) {
  return equation < model.states()
             ? model.machine.states.states[static_cast<std::size_t>(equation)].name
             : model.machine.states.outputs[static_cast<std::size_t>(equation - model.states())].signal;
}

}  // namespace hydroscope
