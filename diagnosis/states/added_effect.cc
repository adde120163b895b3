#include "diagnosis/states/added_effect.h"

#include <algorithm>

#include "core/contains.h"
#include "models/state_effects.h"
#include "models/state_names.h"

namespace hydroscope {

AddedEffect::AddedEffect(const StateModel& near, const StateModel& with, const Eigen::VectorXd& own)
    : near_(near), with_(with), own_(RegistersOf(near, own)) {
  for (const Effect& effect : StateEffectsOf(with.machine)) {
    const auto has = [&](const StateModel& model) { return Contains(model.effects, effect.id); };
    if (!has(with) || has(near)) continue;
    for (const TermSpec& term : effect.adds) {
      const int state = StateIndex(with.machine, term.parameter);
      equations_.push_back(state >= 0 ? state : with.states() + OutputIndex(with.machine, term.parameter));
    }
  }
  std::sort(equations_.begin(), equations_.end());
  equations_.erase(std::unique(equations_.begin(), equations_.end()), equations_.end());
}

void AddedEffect::AddDraw(const Eigen::VectorXd& parameters) {
  draws_.push_back(RegistersOf(with_, parameters));
}

void AddedEffect::SetDraw(const Eigen::VectorXd& parameters) {
  draws_.clear();
  AddDraw(parameters);
}

void AddedEffect::Values(const double* x, const double* u, double* out) {
  Run(near_, own_, x, u);
  for (Registers& draw : draws_) {
    Run(with_, draw, x, u);
    for (const int e : equations_) *out++ = At(with_, draw, e) - At(near_, own_, e);
  }
}

AddedTerms AddedEffect::Terms() {
  AddedTerms added;
  added.columns = static_cast<int>(draws_.size());
  for (int d = 0; d < added.columns; ++d)
    for (const int e : equations_)
      (e < with_.states() ? added.to_states : added.to_outputs)
          .push_back({added.values++, e < with_.states() ? e : e - with_.states(), d});
  added.moving = added.to_states.empty() ? 0 : added.columns;
  added.evaluate = [this](const double* x, const double* u, double* values) { Values(x, u, values); };
  return added;
}

AddedEffect::Registers AddedEffect::RegistersOf(const StateModel& model, const Eigen::VectorXd& parameters) {
  const auto of = [&](const ExpressionProgram& program) {
    std::vector<double> registers = program.Registers();
    std::copy(parameters.begin(), parameters.end(),
              registers.begin() + static_cast<std::ptrdiff_t>(model.states() + model.driving()));
    program.RunFixed(registers.data());
    return registers;
  };
  return {of(model.dynamics.values), of(model.output.values)};
}

void AddedEffect::Run(const StateModel& model, Registers& registers, const double* x, const double* u) const {
  const auto run = [&](const ExpressionProgram& program, std::vector<double>& at) {
    std::copy_n(x, model.states(), at.begin());
    std::copy_n(u, model.driving(), at.begin() + model.states());
    program.Run(at.data());
  };
  if (equations_.front() < model.states()) run(model.dynamics.values, registers.states);
  if (equations_.back() >= model.states()) run(model.output.values, registers.outputs);
}

double AddedEffect::At(const StateModel& model, const Registers& registers, int equation) const {
  if (equation < model.states())
    return registers.states[model.dynamics.values.output(static_cast<std::size_t>(equation))];
  return registers.outputs[model.output.values.output(static_cast<std::size_t>(equation - model.states()))];
}

}  // namespace hydroscope
