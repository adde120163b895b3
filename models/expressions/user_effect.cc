#include "models/expressions/user_effect.h"

#include <fmt/format.h>

#include <set>

#include "core/constants.h"
#include "core/contains.h"
#include "core/told_error.h"
#include "models/state_effects.h"

namespace hydroscope {
namespace {

/// Where the search for the constants of an effect starts: points evenly inside their limits, every combination.
std::vector<std::vector<double>> GridOf(const std::vector<ShapeSpec>& shape) {
  std::vector<std::vector<double>> grid = {{}};
  const int points = shape.size() > 1 ? 4 : 6;
  for (const ShapeSpec& s : shape) {
    std::vector<std::vector<double>> finer;
    for (const std::vector<double>& point : grid)
      for (int k = 0; k < points; ++k) {
        finer.push_back(point);
        finer.back().push_back(s.min + (s.max - s.min) * (k + 0.5) / points);
      }
    grid = std::move(finer);
  }
  return grid;
}

/// The parts with the constants' values put in.
std::vector<ExpressionPart> WithShape(std::vector<ExpressionPart> parts, const std::vector<ShapeSpec>& shape,
                                      const std::vector<double>& values) {
  std::map<std::string, double> named;
  for (std::size_t i = 0; i < shape.size(); ++i) named[shape[i].name] = values[i];
  for (ExpressionPart& part : parts) {
    if (part.weight) part.weight = WithValues(part.weight, named);
    if (part.level) part.level = WithValues(part.level, named);
  }
  return parts;
}

/// Signals the effects read that the model has no channel for yet become measured channels.
void AddSignals(const Machine& machine, ModelStructure& model) {
  for (const UserEffectSpec& spec : machine.user_effects) {
    const auto checked = CheckExpression(spec.terms.at(0).expression, ExpressionNamesOf(machine, spec));
    if (!checked) continue;  // MakeUserEffect says so
    for (const std::string& name : NamesIn(*checked->tree)) {
      const int signal = machine.SignalIndex(name);
      const auto& names = model.channel_names;
      if (signal < 0 || Contains(names, name)) continue;
      model.channel_source.resize(names.size(), kDerivedChannel);
      model.channel_names.push_back(name);
      model.channel_source.push_back(signal);
    }
  }
}

/// Signals and rates that parts are a function of, each once.
std::vector<std::string> ReadBy(const std::vector<ExpressionPart>& parts) {
  std::set<std::string> names;
  for (const ExpressionPart& part : parts) {
    if (part.weight) names.merge(NamesIn(*part.weight));
    if (part.level) names.insert(fmt::format("ddt({})", CanonicalText(*part.level)));
  }
  return {names.begin(), names.end()};
}

}  // namespace

std::string ParameterUnit(const TermSpec& term, const ExpressionUnit& expression,
                          const std::string& output_unit) {
  const auto output = ParseSiUnit(output_unit);
  if (!term.unit.empty() || !expression.exact || !output) return term.unit;
  return SiUnitName(*output / expression.dimension);
}

Effect DescribeUserEffect(const Machine& machine, const UserEffectSpec& spec,
                          const std::string& output_unit) {
  if (!spec.adds.empty()) return DescribeStateEffect(machine, spec);
  const TermSpec& term = spec.terms.at(0);
  Effect e;
  e.id = spec.id;
  e.title = spec.description.empty() ? spec.id : spec.description;
  e.german.title = spec.german;
  e.law = fmt::format("{} * ({})", term.parameter, term.expression);
  e.source = "machine file";
  e.parameter = term.parameter;
  if (const auto checked = CheckExpression(term.expression, ExpressionNamesOf(machine, spec)))
    e.unit = ParameterUnit(term, checked->unit, output_unit);
  e.min = spec.min.value_or(-kInfinity);
  e.max = spec.max.value_or(kInfinity);
  e.typical = spec.typical.value_or(kInfinity);
  for (const ShapeSpec& s : spec.shape)
    e.nonlinear.push_back({s.name, s.unit.empty() ? "1" : s.unit, s.min, s.max});
  e.hidden_in = "-";
  e.grid = GridOf(spec.shape);
  return e;
}

Result<Effect> MakeUserEffect(const Machine& machine, const UserEffectSpec& spec,
                              const UserEffectContext& context) {
  const ExpressionNames names = ExpressionNamesOf(machine, spec);
  if (spec.terms.size() != 1)
    return BadInput(
        Tell("machine '{}': effect '{}' has {} terms, expected one: an effect has one parameter",
             "Maschine '{}': Effekt '{}' hat {} Terme, erwartet einer: ein Effekt hat einen Parameter",
             machine.name, spec.id, spec.terms.size()));
  const std::string& text = spec.terms[0].expression;
  const auto checked = CheckExpression(text, names);
  if (!checked)
    return BadInput(Tell("machine '{}': effect '{}': {}\n{}", "Maschine '{}': Effekt '{}': {}\n{}",
                         machine.name, spec.id, checked.error().text, CaretLine(text, checked.error().at)));
  Effect e = DescribeUserEffect(machine, spec, context.output_unit);
  Expression tree = WithValues(checked->tree, names.constants);
  if (context.sign < 0) tree = NegateNode(tree);
  const std::vector<ExpressionPart> parts =
      context.level_form ? std::vector<ExpressionPart>{{context.channels->Windowed(tree), nullptr}}
                         : context.channels->Parts(tree);
  e.reads = ReadBy(parts);
  for (const ShapeSpec& s : spec.shape) std::erase(e.reads, s.name);
  e.variant = [parts, shape = spec.shape, channel_of = context.channels->Indices(),
               level_form = context.level_form](const std::vector<double>& nonlinear) {
    auto ready = std::make_shared<const ExpressionParts>(WithShape(parts, shape, nonlinear), channel_of);
    return PlainVariant(FillOf(std::move(ready), level_form));
  };
  return e;
}

Status AddUserEffects(const Machine& machine, double sign, ModelStructure& model) {
  if (machine.user_effects.empty()) return {};
  AddSignals(machine, model);
  ExpressionChannels channels(model, machine.window.half_width);
  std::vector<std::shared_ptr<const Effect>> effects;
  for (const UserEffectSpec& spec : machine.user_effects) {
    auto effect = TRY(MakeUserEffect(machine, spec, {&channels, model.level_form, sign, model.output_unit}));
    effects.push_back(std::make_shared<const Effect>(std::move(effect)));
  }
  model.derive_channels = [built_in = model.derive_channels, own = channels.Derivation()](Stretch& s) {
    if (built_in) built_in(s);
    own(s);
  };
  AddLibrary(std::move(effects), model);
  return {};
}

}  // namespace hydroscope
