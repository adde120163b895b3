#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

/// Functions of the states and inputs of a model which stand for laws that nobody has named: hinges, powers, smooth signs and
/// products of them, and random cosines of all together. Each variable counts over its spread in a fit's run.
class FunctionBank {
 public:
  /// `fourier`: number of the cosines, drawn from `seed`.
  FunctionBank(const StateFit& fit, std::span<const Episode> episodes, int fourier, std::uint32_t seed);

  int count() const { return count_; }
  void Values(const double* state, const double* input, double* out) const;
  /// What a function is of: "x", "x and v".
  std::string About(int function) const;
  /// The one variable that a function is of: states first, then inputs; nothing if it is of none or several.
  std::optional<int> Variable(int function) const;
  std::string VariableName(int variable) const;
  /// Every function in every equation but those that only say that a state is the rate of another; one column each, whose
  /// equation (states, then states + output) is added to `equation`. This must outlive the terms.
  AddedTerms Terms(std::vector<int>& equation) const;

 private:
  void AddVariable(const std::vector<double>& values);

  const StateModel& model_;
  int states_ = 0, count_ = 0;
  bool pairs_ = true;
  std::vector<double> middle_, spread_, zero_, frequency_, phase_;
  std::vector<std::vector<double>> knots_;
};

/// Values of a variable (FunctionBank::Variable) in the runs of a fit, ascending.
std::vector<double> ValuesOf(const StateFit& fit, std::span<const Episode> episodes, int variable);

/// Name of the state or output whose equation this is: states first, then states + output.
std::string EquationName(const StateModel& model, int equation);

}  // namespace hydroscope
