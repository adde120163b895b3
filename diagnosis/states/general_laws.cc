#include "diagnosis/states/general_laws.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "diagnosis/states/function_bank.h"
#include "diagnosis/states/law_terms.h"
#include "diagnosis/states/search_sentences.h"
#include "models/state_effects.h"

namespace hydroscope {
namespace {

/// Rms of what a state changes by per second, of an output's variation.
double EquationSize(const StateFit& rest, std::span<const Episode> episodes, const std::string& equation) {
  const StateModel& model = *rest.model;
  double sum = 0, count = 0;
  for (int i = 0; i < model.states(); ++i) {
    if (EquationName(model, i) != equation) continue;
    for (std::size_t e = 0; e < episodes.size(); ++e)
      for (int row = 1; row < episodes[e].rows(); ++row, ++count)
        sum += std::pow((rest.runs[e].states(row, i) - rest.runs[e].states(row - 1, i)) /
                            (episodes[e].time[row] - episodes[e].time[row - 1]),
                        2);
    return std::sqrt(sum / std::max(count, 1.0));
  }
  for (int j = 0; j < model.output.rows; ++j)
    if (EquationName(model, model.states() + j) == equation) return rest.scale[j];
  return 0;
}

/// A machine with effects of general shape in the equations that one of its effects adds to.
class GeneralLaws {
 public:
  /// `rest`: the machine fitted without the effect.
  GeneralLaws(const Machine& without, const std::string& effect, const StateFit& rest,
              std::span<const Episode> episodes);

  const Machine& machine() const { return machine_; }
  const std::vector<GeneralLaw>& laws() const { return laws_; }

 private:
  /// What an equation is about, and how large its rate.
  struct Equation {
    std::string name;
    double size = 0;
  };
  /// `term`: of a size of one; `formula`: as people read it.
  void Add(const std::vector<Equation>& equations, const std::string& term, const std::string& formula);

  Machine machine_;
  std::vector<GeneralLaw> laws_;
};

GeneralLaws::GeneralLaws(const Machine& without, const std::string& effect, const StateFit& rest,
                         std::span<const Episode> episodes)
    : machine_(without) {
  const std::vector<Effect> library = StateEffectsOf(without);
  const Effect* like = FindStateEffect(library, effect);
  if (like == nullptr) return;
  std::vector<Equation> equations;
  for (const TermSpec& term : like->adds) {
    const double size = EquationSize(rest, episodes, term.parameter);
    const bool known = std::ranges::any_of(
        equations, [&](const Equation& equation) { return equation.name == term.parameter; });
    if (size > 0 && !known) equations.push_back({term.parameter, size});
  }
  const StateModel& model = *rest.model;
  const int variables = model.states() + static_cast<int>(model.inputs.size());
  for (int v = 0; v < variables; ++v) {
    const std::string name = v < model.states()
                                 ? EquationName(model, v)
                                 : without
                                       .signals[static_cast<std::size_t>(
                                           model.inputs[static_cast<std::size_t>(v - model.states())])]
                                       .name;
    const std::vector<double> values = ValuesOf(rest, episodes, v);
    const auto at = [&](double share) {
      return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
    };
    const double middle = values.front() < 0 && values.back() > 0 ? 0 : at(0.5);
    const double spread = (at(0.95) - at(0.05)) / 2;
    if (!(spread > 0)) continue;
    const std::string z = fmt::format("(({} - ({:.17g}))/{:.17g})", name, middle, spread);
    for (const auto& [shape, formula] :
         {std::pair("{0}^2", "{}^2"), std::pair("{0}^3", "{}^3"), std::pair("{0}^5", "{}^5"),
          std::pair("{0}*abs({0})", "{0}*abs({0})"), std::pair("tanh(10*{0})", "a step in {}")}) {
      const std::string term = fmt::format(fmt::runtime(shape), z),
                        read = fmt::format(fmt::runtime(formula), name);
      for (const Equation& equation : equations) Add({equation}, term, read);
      if (equations.size() > 1) Add(equations, term, read);
    }
  }
}

void GeneralLaws::Add(const std::vector<Equation>& equations, const std::string& term,
                      const std::string& formula) {
  constexpr double kFirst = 0.05, kMost = 1e3;  // of an equation's size
  GeneralLaw law;
  law.formula = formula;
  UserEffectSpec effect;
  for (const Equation& equation : equations) {
    const std::string size = fmt::format("c_{}", equation.name);
    effect.adds.push_back({equation.name, fmt::format("{}*{:.17g}*{}", size, equation.size, term)});
    effect.parameters.push_back({size, kFirst, -kMost, kMost});
    law.equations.push_back(equation.name);
  }
  law.id = fmt::format("{} in {}", formula, fmt::join(law.equations, ", "));
  effect.id = law.id;
  machine_.user_effects.push_back(std::move(effect));
  laws_.push_back(std::move(law));
}

}  // namespace

std::optional<Told> BetterGeneralLaw(FoundSets& found, const std::string& effect) {
  const StatesExplanation& out = found.out;
  const StateCandidate& rest = out.final.added.size() == 1 ? out.base : found.Without(effect);
  if (!rest.fitted()) return {};
  const GeneralLaws general(found.machine, effect, rest.fit, found.episodes);
  const CandidateFits fits(general.machine(), found.episodes, found.starts_on, found.options, out.base);
  std::vector<std::pair<StateContender, const GeneralLaw*>> contenders;
  for (const GeneralLaw& law : general.laws()) {
    std::vector<std::string> added = rest.added;
    added.push_back(law.id);
    if (auto contender = fits.Screened(added, rest)) contenders.emplace_back(std::move(*contender), &law);
  }
  std::ranges::stable_sort(contenders,
                           [](const auto& a, const auto& b) { return a.first.foreseen < b.first.foreseen; });
  if (contenders.size() > static_cast<std::size_t>(found.options.contenders))
    contenders.erase(contenders.begin() + found.options.contenders, contenders.end());
  std::vector<std::string> alone = found.machine.added_effects;
  alone.push_back(effect);
  const auto effect_alone = BuildStateModel(found.machine, alone);
  if (!effect_alone) return {};
  const double enough =
      out.final.held_out *
      (1 - (out.final_left.structured ? found.options.min_removed * out.final_left.least_share : 0));
  for (const auto& [contender, law] : contenders) {
    const StateCandidate other = fits.Fitted(contender);
    if (other.fitted() && other.held_out < enough &&
        !SameLaw(out.base.fit, out.final, other, found.episodes, found.options.same_law, effect_alone->get()))
      return NotToldFromGeneral(effect, *law);
  }
  return {};
}

}  // namespace hydroscope
