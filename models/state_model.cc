#include "models/state_model.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <set>

#include "core/contains.h"
#include "core/limits.h"
#include "core/told_error.h"
#include "core/units.h"
#include "models/machine_file/table.h"
#include "models/state_effects.h"
#include "models/state_names.h"

namespace hydroscope {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Numbers of the names that a program reads.
using InputNumbers = std::map<std::string, int>;

Expression Parsed(const std::string& text, const Machine& machine) {
  const auto tree = ParseExpression(text);
  return tree ? WithValues(*tree, ExpressionNamesOf(machine).constants) : NumberNode(0);
}

/// Puts the rows of equations together and differentiates them.
class EquationBuilder {
 public:
  explicit EquationBuilder(int rows) : rows_(static_cast<std::size_t>(rows), 0) {
    for (int& row : rows_) row = graph_.Constant(0);
  }
  void Set(int row, double value) { rows_[static_cast<std::size_t>(row)] = graph_.Constant(value); }
  void Add(int row, const Expression& expression, const InputNumbers& numbers) {
    int& value = rows_[static_cast<std::size_t>(row)];
    value = graph_.Sum(value, graph_.Add(*expression, numbers));
  }
  /// `inputs` of the program, of which the first `states` and those from `first_fixed` on are differentiated by.
  Equations Build(int inputs, int states, int first_fixed) {
    std::vector<int> wanted = rows_;
    std::vector<Equations::Slope> entries;
    for (int r = 0; r < static_cast<int>(rows_.size()); ++r)
      for (int i = 0; i < inputs; ++i) {
        if (i >= states && i < first_fixed) continue;
        const int slope = graph_.Derivative(rows_[static_cast<std::size_t>(r)], i);
        if (graph_.IsZero(slope)) continue;
        wanted.push_back(slope);
        entries.push_back({r, i < states ? i : states + i - first_fixed});
      }
    return {ExpressionProgram(graph_, rows_, inputs, first_fixed),
            ExpressionProgram(graph_, wanted, inputs, first_fixed), std::move(entries),
            static_cast<int>(rows_.size())};
  }

 private:
  ExpressionGraph graph_;
  std::vector<int> rows_;
};

/// One model on the way to be built.
class Builder {
 public:
  Builder(const Machine& machine, const std::vector<std::string>& effects)
      : spec_(machine.states), library_(StateEffectsOf(machine)) {
    model_.machine = machine;
    model_.effects = effects;
  }

  Result<std::shared_ptr<const StateModel>> Run() {
    TRY(TakeParameters());
    TakeSignals();
    TakeDelays();
    NumberNames();
    BuildDynamics();
    BuildLimits();
    BuildInitial();
    TRY(EveryParameterIsRead());
    return std::make_shared<const StateModel>(std::move(model_));
  }

 private:
  const Machine& machine() const { return model_.machine; }
  int states() const { return static_cast<int>(spec_.states.size()); }

  Status TakeParameters() {
    for (const ParameterSpec& p : spec_.parameters) model_.parameters.push_back({p.name, "", p});
    for (const std::string& id : model_.effects) {
      const Effect* effect = FindStateEffect(library_, id);
      if (effect == nullptr) {
        std::vector<std::string> known;
        for (const Effect& other : library_) known.push_back(other.id);
        return BadInput(Tell("machine '{}': unknown effect '{}'; {}its effects: {}",
                             "Maschine '{}': unbekannter Effekt '{}'; {}ihre Effekte: {}", machine().name, id,
                             DidYouMean(id, known), fmt::join(known, ", ")));
      }
      for (const ParameterSpec& p : effect->parameters)
        model_.parameters.push_back({id + "." + p.name, id, p});
    }
    if (model_.parameters.size() > kMaxParameters)
      return BadInput(
          Tell("machine '{}': {} parameters with its effects, at most {} can be fitted at once",
               "Maschine '{}': {} Parameter mit ihren Effekten, höchstens {} lassen sich zusammen bestimmen",
               machine().name, model_.parameters.size(), kMaxParameters));
    return {};
  }

  /// Inputs are the signals that an equation of the model or of an effect reads.
  void TakeSignals() {
    std::set<std::string> names;
    const auto read = [&](const std::string& text) {
      if (const auto tree = ParseExpression(text)) names.merge(NamesIn(**tree));
    };
    for (const StateSpec& s : spec_.states) read(s.ddt);
    for (const OutputSpec& o : spec_.outputs) read(o.expression);
    for (const Effect& effect : library_)
      for (const TermSpec& term : effect.adds) read(term.expression);
    for (std::size_t s = 0; s < machine().signals.size(); ++s)
      if (names.contains(machine().signals[s].name)) model_.inputs.push_back(static_cast<int>(s));
    for (const OutputSpec& o : spec_.outputs) {
      model_.outputs.push_back(machine().SignalIndex(o.signal));
      if (!spec_.shaft.empty() && names.contains(RippleName(o.signal)))
        model_.ripples.push_back(model_.outputs.back());
    }
  }

  /// Calls `take` with each text of the model and of its effects, and the effect's id.
  void EveryEquation(
      const std::function<void(const std::string& text, const std::string& effect)>& take) const {
    for (const StateSpec& s : spec_.states) take(s.ddt, "");
    for (const OutputSpec& o : spec_.outputs) take(o.expression, "");
    for (const std::string& id : model_.effects)
      for (const TermSpec& term : FindStateEffect(library_, id)->adds) take(term.expression, id);
  }

  /// What a call of delay(...) in an equation of the model or an effect asks for.
  DelayedInput DelayOf(const ExpressionNode& call, const std::string& effect) const {
    DelayedInput delay;
    for (std::size_t i = 0; i < model_.inputs.size(); ++i)
      if (machine().signals[static_cast<std::size_t>(model_.inputs[i])].name == call.args[0]->text)
        delay.input = static_cast<int>(i);
    const ExpressionNode& time = *call.args[1];
    if (time.kind == ExpressionNode::Kind::kNumber) {
      delay.seconds = time.number;
      return delay;
    }
    for (std::size_t p = 0; p < model_.parameters.size(); ++p) {
      const StateParameter& parameter = model_.parameters[p];
      if (parameter.spec.name == time.text && (parameter.effect.empty() || parameter.effect == effect))
        delay.parameter = static_cast<int>(p);
    }
    return delay;
  }
  static bool IsDelay(const ExpressionNode& node) {
    return node.kind == ExpressionNode::Kind::kCall && node.text == "delay";
  }

  void TakeDelays() {
    EveryEquation([&](const std::string& text, const std::string& effect) {
      Replaced(Parsed(text, machine()), [&](const ExpressionNode& node) -> Expression {
        if (!IsDelay(node)) return nullptr;
        const DelayedInput delay = DelayOf(node, effect);
        if (!Contains(model_.delays, delay)) model_.delays.push_back(delay);
        return nullptr;
      });
    });
  }

  void NumberNames() {
    int next = 0;
    for (const StateSpec& s : spec_.states) numbers_[s.name] = next++;
    for (const int s : model_.inputs) numbers_[machine().signals[static_cast<std::size_t>(s)].name] = next++;
    for (std::size_t d = 0; d < model_.delays.size(); ++d)
      for (const char* what : {"value", "rate", "now"}) numbers_[DelayName(d, what)] = next++;
    for (const int s : model_.ripples)
      numbers_.emplace(RippleName(machine().signals[static_cast<std::size_t>(s)].name), next++);
    first_fixed_ = next;
  }
  /// No name of the file, which holds no space.
  static std::string DelayName(std::size_t delay, const char* what) {
    return fmt::format("delay {} {}", delay, what);
  }

  /// An equation with what is delayed in it as DelayedInput says.
  Expression Equation(const std::string& text, const std::string& effect) const {
    return Replaced(Parsed(text, machine()), [&](const ExpressionNode& node) -> Expression {
      if (!IsDelay(node)) return nullptr;
      const DelayedInput delay = DelayOf(node, effect);
      const auto at = static_cast<std::size_t>(std::find(model_.delays.begin(), model_.delays.end(), delay) -
                                               model_.delays.begin());
      const Expression value = NameNode(DelayName(at, "value"));
      if (delay.parameter < 0) return value;
      return BinaryNode("+", value,
                        BinaryNode("*", BinaryNode("-", NameNode(DelayName(at, "now")), node.args[1]),
                                   NameNode(DelayName(at, "rate"))));
    });
  }
  /// The names with the parameters of the model and those of an effect ("" = none).
  InputNumbers NumbersFor(const std::string& effect, InputNumbers numbers, int next) const {
    for (const StateParameter& p : model_.parameters) {
      if (p.effect.empty() || p.effect == effect) numbers[p.spec.name] = next;
      ++next;
    }
    return numbers;
  }

  void BuildDynamics() {
    const int outputs = static_cast<int>(spec_.outputs.size()),
              inputs = first_fixed_ + model_.parameter_count();
    EquationBuilder dynamics(states()), output(outputs);
    const InputNumbers base = NumbersFor("", numbers_, first_fixed_);
    for (int i = 0; i < states(); ++i)
      dynamics.Add(i, Equation(spec_.states[static_cast<std::size_t>(i)].ddt, ""), base);
    for (int j = 0; j < outputs; ++j)
      output.Add(j, Equation(spec_.outputs[static_cast<std::size_t>(j)].expression, ""), base);
    for (const std::string& id : model_.effects) {
      const InputNumbers numbers = NumbersFor(id, numbers_, first_fixed_);
      for (const TermSpec& term : FindStateEffect(library_, id)->adds) {
        const Expression added = Equation(term.expression, id);
        const int state = StateIndex(machine(), term.parameter);
        if (state >= 0)
          dynamics.Add(state, added, numbers);
        else
          output.Add(OutputIndex(machine(), term.parameter), added, numbers);
      }
    }
    model_.dynamics = dynamics.Build(inputs, states(), first_fixed_);
    model_.output = output.Build(inputs, states(), first_fixed_);
  }

  void BuildLimits() {
    EquationBuilder limits(2 * states());
    const InputNumbers numbers = NumbersFor("", {}, 0);
    for (int i = 0; i < states(); ++i) {
      const StateSpec& state = spec_.states[static_cast<std::size_t>(i)];
      for (const auto& [text, row, none] :
           {std::tuple(&state.min, i, -kNoLimit), std::tuple(&state.max, states() + i, kNoLimit)}) {
        if (text->empty())
          limits.Set(row, none);
        else
          limits.Add(row, Parsed(*text, machine()), numbers);
      }
    }
    model_.limits = limits.Build(model_.parameter_count(), 0, 0);
  }

  /// What is read off an output has that reading's noise, which a model that takes it for the state would carry on; the fit
  /// knows the reading anyway.
  bool ReadsAnOutput(const std::string& text) const {
    const auto names = NamesIn(*Parsed(text, machine()));
    return std::any_of(spec_.outputs.begin(), spec_.outputs.end(),
                       [&](const OutputSpec& output) { return names.contains(output.signal); });
  }

  void BuildInitial() {
    EquationBuilder initial(states());
    InputNumbers numbers;
    const auto signals = static_cast<int>(machine().signals.size());
    for (int s = 0; s < signals; ++s) numbers[machine().signals[static_cast<std::size_t>(s)].name] = s;
    numbers = NumbersFor("", std::move(numbers), signals);
    for (int i = 0; i < states(); ++i) {
      const StateSpec& state = spec_.states[static_cast<std::size_t>(i)];
      model_.measured_by.push_back(-1);
      for (std::size_t j = 0; j < spec_.outputs.size(); ++j)
        if (spec_.outputs[j].expression == state.name) model_.measured_by.back() = static_cast<int>(j);
      const bool given = state.initial != "estimate", read = given && ReadsAnOutput(state.initial);
      model_.estimated.push_back(!given || read);
      model_.near.push_back(given ? read && model_.measured_by.back() < 0 : !state.near.empty());
      if (given) initial.Add(i, Parsed(state.initial, machine()), numbers);
      if (!given && model_.near.back()) initial.Add(i, Parsed(state.near, machine()), numbers);
      model_.rate_of.push_back(StateIndex(machine(), state.ddt));
    }
    model_.initial = initial.Build(signals + model_.parameter_count(), 0, signals);
  }

  Status EveryParameterIsRead() const {
    std::set<int> read;
    for (const Equations* e : {&model_.dynamics, &model_.output})
      for (const Equations::Slope& slope : e->entries) read.insert(slope.column - states());
    for (const DelayedInput& delay : model_.delays) read.insert(delay.parameter);
    for (const Equations* e : {&model_.limits, &model_.initial})
      for (const Equations::Slope& slope : e->entries) read.insert(slope.column);
    for (int p = 0; p < model_.parameter_count(); ++p)
      if (!read.contains(p))
        return BadInput(
            Tell("machine '{}': no equation reads the parameter {}; take it out of the machine file",
                 "Maschine '{}': keine Gleichung liest den Parameter {}; ihn aus der Maschinendatei nehmen",
                 machine().name, model_.parameters[static_cast<std::size_t>(p)].name));
    return {};
  }

  const StatesSpec spec_;
  const std::vector<Effect> library_;
  StateModel model_;
  InputNumbers numbers_;
  int first_fixed_ = 0;
};

}  // namespace

Result<std::shared_ptr<const StateModel>> BuildStateModel(const Machine& machine,
                                                          const std::vector<std::string>& effects) {
  return Builder(machine, effects).Run();
}

}  // namespace hydroscope
