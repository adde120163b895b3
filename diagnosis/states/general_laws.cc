#include "diagnosis/states/general_laws.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "diagnosis/states/function_bank.h"
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

}  // namespace

GeneralLaws::GeneralLaws(const Machine& without, const std::string& effect, const StateFit& rest,
                         std::span<const Episode> episodes)
    : machine(without) {
  constexpr double kFirst = 0.05, kMost = 1e3;  // of EquationSize
  const std::vector<Effect> library = StateEffectsOf(without);
  const Effect* like = FindStateEffect(library, effect);
  if (like == nullptr || like->adds.size() != 1) return;
  const TermSpec& term = like->adds.front();
  const double size = EquationSize(rest, episodes, term.parameter);
  if (!(size > 0)) return;
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
      UserEffectSpec law;
      law.id = fmt::format("{} in {}", fmt::format(fmt::runtime(formula), name), term.parameter);
      law.adds = {{term.parameter, fmt::format("c*{:.17g}*{}", size, fmt::format(fmt::runtime(shape), z))}};
      law.parameters = {{"c", kFirst, -kMost, kMost}};
      laws.push_back({law.id, term.parameter, fmt::format(fmt::runtime(formula), name)});
      machine.user_effects.push_back(std::move(law));
    }
  }
}

}  // namespace hydroscope
