#include "models/expressions/balance.h"

#include <algorithm>
#include <cmath>

#include "core/contains.h"
#include "core/told_error.h"
#include "models/expressions/general_laws.h"
#include "models/expressions/user_effect.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"

namespace hydroscope {
namespace {

/// A checked expression of the balance with its constants put in; errors name the key.
Result<CheckedExpression> CheckedText(const Machine& machine, const std::string& key,
                                      const std::string& text) {
  const ExpressionNames names = ExpressionNamesOf(machine);
  auto checked = CheckExpression(text, names);
  if (!checked)
    return BadInput(Tell("machine '{}': [balance] {}: {}\n{}", "Maschine '{}': [balance] {}: {}\n{}",
                         machine.name, key, checked.error().text, CaretLine(text, checked.error().at)));
  checked->tree = WithValues(checked->tree, names.constants);
  return *checked;
}

/// What is multiplied by a rate of speed and is a mass, or a moment of inertia: there are none below zero.
bool IsInertia(const TermSpec& term, const std::string& unit) {
  return (unit == "kg" || unit == "kg m2") && term.expression.starts_with("ddt(") &&
         term.expression.ends_with(")");
}

/// Quantities computed from the parameters, with their gradients.
class Derivation {
 public:
  Derivation(const Machine& machine, std::vector<std::string> units)
      : terms_(machine.balance.terms), units_(std::move(units)) {
    std::map<std::string, int> index;
    for (std::size_t i = 0; i < terms_.size(); ++i) index[terms_[i].parameter] = static_cast<int>(i);
    for (const TermSpec& term : machine.balance.derived) {
      const auto tree = CheckExpression(term.expression, DerivedNames(machine));
      if (!tree) continue;  // refused when the machine file was read
      ExpressionGraph graph;
      std::vector<int> wanted = {graph.Add(*WithValues(tree->tree, DerivedNames(machine).constants), index)};
      const auto count = static_cast<int>(terms_.size());
      for (int i = 0; i < count; ++i) wanted.push_back(graph.Derivative(wanted.front(), i));
      derived_.push_back({term.parameter, term.unit, ExpressionProgram(graph, wanted, count)});
    }
  }

  static ExpressionNames DerivedNames(const Machine& machine) {
    ExpressionNames names = ExpressionNamesOf(machine);
    for (const SignalSpec& signal : machine.signals) names.units.erase(signal.name);
    for (const TermSpec& term : machine.balance.terms) {
      names.units[term.parameter] = std::nullopt;
      names.constants.erase(term.parameter);
    }
    return names;
  }

  std::vector<DerivedParameter> operator()(const Eigen::VectorXd& theta) const {
    std::vector<DerivedParameter> out;
    for (std::size_t i = 0; i < terms_.size(); ++i) {
      const auto own = Eigen::VectorXd::Unit(theta.size(), static_cast<Eigen::Index>(i));
      const double value = theta[static_cast<Eigen::Index>(i)];
      const bool possible = std::isfinite(value) && (value > 0 || !IsInertia(terms_[i], units_[i]));
      out.push_back({terms_[i].parameter, units_[i], value, own, possible});
    }
    for (const Quantity& quantity : derived_) out.push_back(Of(quantity, theta));
    return out;
  }

 private:
  struct Quantity {
    std::string name, unit;
    ExpressionProgram program;  ///< value, then the gradient
  };

  static DerivedParameter Of(const Quantity& quantity, const Eigen::VectorXd& theta) {
    std::vector<double> registers = quantity.program.Registers();
    std::copy(theta.begin(), theta.end(), registers.begin());
    quantity.program.Run(registers.data());
    DerivedParameter out{quantity.name, quantity.unit, registers[quantity.program.output(0)],
                         Eigen::VectorXd(theta.size())};
    for (Eigen::Index i = 0; i < theta.size(); ++i)
      out.gradient[i] = registers[quantity.program.output(static_cast<std::size_t>(i) + 1)];
    out.admissible = std::isfinite(out.value) && out.gradient.allFinite();
    if (!out.admissible) out.gradient.setZero();
    return out;
  }

  std::vector<TermSpec> terms_;
  std::vector<std::string> units_;
  std::vector<Quantity> derived_;
};

/// Channels for all signals that the balance, its effects and the gate read, or that strokes are
/// told apart by, in the order of the machine file.
void AddSignalChannels(const Machine& machine, const std::vector<Expression>& balance,
                       ModelStructure& model) {
  std::set<std::string> base, all;
  for (const Expression& e : balance) base.merge(NamesIn(*e));
  all = base;
  for (const UserEffectSpec& effect : machine.user_effects)
    if (!effect.terms.empty())
      if (const auto checked =
              CheckExpression(effect.terms[0].expression, ExpressionNamesOf(machine, effect)))
        all.merge(NamesIn(*checked->tree));
  for (const Condition& condition : ConditionsOf(machine)) all.insert(condition.signal);
  for (const GateBound& bound : machine.gate.bounds) all.insert(bound.signal);
  all.insert(std::string(KindOf(machine).temperature));
  for (std::size_t s = 0; s < machine.signals.size(); ++s) {
    const std::string& name = machine.signals[s].name;
    if (!all.contains(name)) continue;
    model.channel_names.push_back(name);
    model.channel_source.push_back(static_cast<int>(s));
    if (base.contains(name)) model.needed_signals.push_back(static_cast<int>(s));
  }
}

/// Bounds of the gate on what is no part of the output: what moves while the machine works.
std::vector<GateBound> MovingBounds(const Machine& machine, const Expression& output) {
  std::vector<GateBound> bounds = machine.gate.bounds;
  const std::set<std::string> own = NamesIn(*output);
  std::erase_if(bounds, [&](const GateBound& bound) { return own.contains(bound.signal); });
  return bounds;
}

/// Channels of the signals that terms, effects and gate read, and of their rates.
std::vector<int> ChannelsRead(const Machine& machine, const std::vector<Expression>& terms,
                              const std::vector<GateBound>& gate, const ModelStructure& model) {
  std::set<std::string> read;
  for (const Expression& term : terms) read.merge(NamesIn(*term));
  for (const GateBound& bound : gate) read.insert(bound.signal);
  for (const UserEffectSpec& effect : machine.user_effects)
    if (const auto checked =
            CheckExpression(effect.terms.at(0).expression, ExpressionNamesOf(machine, effect)))
      read.merge(NamesIn(*checked->tree));
  std::vector<int> channels;
  for (std::size_t c = 0; c < model.channel_names.size(); ++c) {
    const std::string& name = model.channel_names[c];
    if (read.contains(name) || name.starts_with("ddt(")) channels.push_back(static_cast<int>(c));
  }
  return channels;
}

/// Measured channels that the balance reads, but for those whose rate is a channel of its own.
std::vector<int> SignalsWithoutRate(const std::vector<Expression>& balance, const ModelStructure& model) {
  std::set<std::string> read;
  for (const Expression& part : balance) read.merge(NamesIn(*part));
  std::vector<int> channels;
  for (std::size_t c = 0; c < model.channel_source.size(); ++c)
    if (read.contains(model.channel_names[c]) &&
        !Contains(model.channel_names, fmt::format("ddt({})", model.channel_names[c])))
      channels.push_back(static_cast<int>(c));
  return channels;
}

/// All channels, in the unit of their signal or of what they are computed from.
void ShowChannels(const Machine& machine, ModelStructure& model) {
  for (std::size_t c = 0; c < model.channel_names.size(); ++c) {
    const std::string& name = model.channel_names[c];
    const auto checked = CheckExpression(name, ExpressionNamesOf(machine));
    const bool exact = checked && checked->unit.exact;
    ModelStructure::ShownChannel shown = {static_cast<int>(c),
                                          exact ? SiUnitName(checked->unit.dimension) : ""};
    if (const DisplayUnit unit = ShownUnit(machine, name);
        machine.SignalIndex(name) >= 0 && unit.offset == 0) {
      shown.display = unit.name;
      shown.factor = unit.factor;
    }
    model.shown.push_back(std::move(shown));
  }
}

}  // namespace

ExpressionNames NamesForDerived(const Machine& machine) { return Derivation::DerivedNames(machine); }

Result<std::shared_ptr<ModelStructure>> BuildExpressionBalance(const Machine& machine) {
  const BalanceSpec& balance = machine.balance;
  if (balance.output.empty() || balance.terms.empty())
    return BadInput(
        Tell("machine '{}': model \"expressions\" needs a [balance] with output and terms",
             "Maschine '{}': das Modell \"expressions\" braucht eine [balance] mit output und terms",
             machine.name));
  auto model = std::make_shared<ModelStructure>();
  model->output_unit = balance.unit;

  std::vector<Expression> trees;
  std::vector<std::string> units;
  for (const TermSpec& term : balance.terms) {
    const auto checked = TRY(CheckedText(machine, "terms." + term.parameter, term.expression));
    model->parameters.push_back(term.parameter);
    units.push_back(ParameterUnit(term, checked.unit, balance.unit));
    trees.push_back(checked.tree);
  }
  const auto output = TRY(CheckedText(machine, "output", balance.output));
  trees.push_back(output.tree);
  AddSignalChannels(machine, trees, *model);

  ExpressionChannels channels(*model, machine.window.half_width);
  std::vector<std::vector<ExpressionPart>> parts;
  for (const Expression& tree : trees) parts.push_back(channels.Parts(tree));
  model->level_form = std::none_of(parts.begin(), parts.end(), HasLevel);
  model->base_count = static_cast<int>(balance.terms.size());
  std::vector<std::shared_ptr<const ExpressionParts>> ready;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    ready.push_back(std::make_shared<const ExpressionParts>(parts[i], channels.Indices()));
    const std::string name = i < balance.terms.size() ? balance.terms[i].parameter : "output";
    const bool walks = !model->level_form && !HasLevel(parts[i]);
    model->columns.push_back({name, FillOf(ready.back(), model->level_form), walks});
  }
  model->integrated_noise = [ready](const Stretch& s, int first, int step, Eigen::MatrixXd& rate_noise) {
    for (Eigen::Index b = 0; b < rate_noise.cols(); ++b)
      for (std::size_t i = 0; i < ready.size(); ++i)
        rate_noise(static_cast<Eigen::Index>(i), b) =
            ready[i]->Contrast(s, first + static_cast<int>(b) * step);
  };
  model->derive = Derivation(machine, units);

  std::vector<std::shared_ptr<const Effect>> effects;
  for (const UserEffectSpec& spec : machine.user_effects) {
    auto effect = TRY(MakeUserEffect(machine, spec, {&channels, model->level_form, 1.0, model->output_unit}));
    effects.push_back(std::make_shared<const Effect>(std::move(effect)));
  }
  const std::vector<GateBound> gate = MovingBounds(machine, output.tree);
  for (const GateBound& bound : gate)
    if (bound.rate) channels.Windowed(ParseExpression(fmt::format("ddt({})", bound.signal)).value());
  const std::vector<int> late = SignalsWithoutRate(trees, *model);
  trees.pop_back();  // the output
  model->generic_laws = GeneralLaws(*model, ChannelsRead(machine, trees, gate, *model), late);
  model->derive_channels = channels.Derivation();
  ShowChannels(machine, *model);
  AddLibrary(std::move(effects), *model);
  return model;
}

}  // namespace hydroscope
