#pragma once

#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

/// What effects add to the equations at some values of their parameters: equations of the model with them,
/// less those without.
class AddedEffect {
 public:
  /// `near`, with parameters `own`, lacks effects that `with` has. Both must outlive this.
  AddedEffect(const StateModel& near, const StateModel& with, const Eigen::VectorXd& own);
  /// Parameters of `with`.
  void AddDraw(const Eigen::VectorXd& parameters);
  /// In place of all draws so far.
  void SetDraw(const Eigen::VectorXd& parameters);

  /// Equations that it adds to: states first, then states + output.
  const std::vector<int>& equations() const { return equations_; }
  /// Values of each draw in turn, one per equation.
  void Values(const double* x, const double* u, double* out);
  /// One column per draw. This must outlive it.
  AddedTerms Terms();

 private:
  struct Registers {
    std::vector<double> states, outputs;
  };
  static Registers RegistersOf(const StateModel& model, const Eigen::VectorXd& parameters);
  void Run(const StateModel& model, Registers& registers, const double* x, const double* u) const;
  double At(const StateModel& model, const Registers& registers, int equation) const;

  const StateModel& near_;
  const StateModel& with_;
  std::vector<int> equations_;
  Registers own_;
  std::vector<Registers> draws_;
};

}  // namespace hydroscope
