#include "diagnosis/states/general_laws.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/contains.h"
#include "diagnosis/states/function_bank.h"
#include "diagnosis/states/law_terms.h"
#include "diagnosis/states/search_sentences.h"
#include "models/state_effects.h"

namespace hydroscope {
namespace {

/// Of a hinge, and of two that lie evenly about the middle; in the spread of what they are of.
constexpr const char *kKnee = "knee", *kReach = "reach";

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

/// A machine with effects of general shape in some of its equations.
class GeneralLaws {
 public:
  /// In each of the equations, and in all of them, and in `further` alone ("": none); `about`: the fit that variables and rates are
  /// scaled by. `on_both_sides`: two hinges, too. A dead band and what saturates are those with a parameter less, so they are for
  /// comparisons that need a margin.
  GeneralLaws(const Machine& machine, const std::vector<std::string>& equations, const std::string& further,
              const StateFit& about, std::span<const Episode> episodes, bool on_both_sides);

  const Machine& machine() const { return machine_; }
  const std::vector<GeneralLaw>& laws() const { return laws_; }

 private:
  /// What an equation is about, and how large its rate.
  struct Equation {
    std::string name;
    double size = 0;
  };
  /// `term`: of a size of one; `formula`: as people read it.
  void Add(const std::vector<Equation>& equations, const std::string& term, const Told& formula);

  Machine machine_;
  std::vector<GeneralLaw> laws_;
};

GeneralLaws::GeneralLaws(const Machine& machine, const std::vector<std::string>& in,
                         const std::string& further, const StateFit& about, std::span<const Episode> episodes,
                         bool on_both_sides)
    : machine_(machine) {
  std::vector<Equation> equations;
  for (const std::string& name : in)
    if (const double size = EquationSize(about, episodes, name); size > 0) equations.push_back({name, size});
  const double further_size =
      further.empty() || Contains(in, further) ? 0 : EquationSize(about, episodes, further);
  if (equations.empty() && further_size == 0) return;
  const StateModel& model = *about.model;
  const int variables = model.states() + static_cast<int>(model.inputs.size());
  for (int v = 0; v < variables; ++v) {
    const std::string name = v < model.states()
                                 ? EquationName(model, v)
                                 : machine
                                       .signals[static_cast<std::size_t>(
                                           model.inputs[static_cast<std::size_t>(v - model.states())])]
                                       .name;
    const std::vector<double> values = ValuesOf(about, episodes, v);
    const auto at = [&](double share) {
      return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
    };
    const double middle = values.front() < 0 && values.back() > 0 ? 0 : at(0.5);
    const double spread = (at(0.95) - at(0.05)) / 2;
    if (!(spread > 0)) continue;
    const std::string z = fmt::format("(({} - ({:.17g}))/{:.17g})", name, middle, spread);
    for (const auto& [shape, formula] : GeneralShapes(name)) {
      if (!on_both_sides && shape.find(kReach) != std::string::npos) continue;
      const std::string term = fmt::format(fmt::runtime(shape), z);
      for (const Equation& equation : equations) Add({equation}, term, formula);
      if (equations.size() > 1) Add(equations, term, formula);
      if (further_size > 0) Add({{further, further_size}}, term, formula);
    }
  }
}

void GeneralLaws::Add(const std::vector<Equation>& equations, const std::string& term, const Told& formula) {
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
  if (term.find(kKnee) != std::string::npos) effect.parameters.push_back({kKnee, 0, -1, 1});
  if (term.find(kReach) != std::string::npos) effect.parameters.push_back({kReach, 0.5, 0, 1.5});
  law.id = fmt::format("{} in {}", formula.english, fmt::join(law.equations, ", "));
  effect.id = law.id;
  machine_.user_effects.push_back(std::move(effect));
  laws_.push_back(std::move(law));
}

/// The equations that effects add to.
std::vector<std::string> EquationsOf(const Machine& machine, std::span<const std::string> effects) {
  const std::vector<Effect> library = StateEffectsOf(machine);
  std::vector<std::string> out;
  for (const std::string& effect : effects)
    if (const Effect* found = FindStateEffect(library, effect))
      for (const TermSpec& term : found->adds)
        if (!Contains(out, term.parameter)) out.push_back(term.parameter);
  return out;
}

struct LawContender {
  StateContender contender;
  const GeneralLaw* law = nullptr;
};

/// All laws beside a set, those that are foreseen to gain most first.
std::vector<LawContender> ContendersBeside(const StateCandidate& set, const GeneralLaws& general,
                                           const CandidateFits& fits) {
  std::vector<LawContender> out;
  for (const GeneralLaw& law : general.laws()) {
    std::vector<std::string> added = set.added;
    added.push_back(law.id);
    if (auto contender = fits.Screened(added, set)) out.push_back({std::move(*contender), &law});
  }
  std::ranges::stable_sort(out, {}, [](const LawContender& law) { return law.contender.foreseen; });
  return out;
}

/// The first so many.
std::span<const LawContender> First(const std::vector<LawContender>& laws, int most) {
  return std::span(laws).first(std::min(laws.size(), static_cast<std::size_t>(most)));
}

/// A law in place of an effect of the set found, and its fit.
using FitInPlace = std::pair<const GeneralLaw*, std::function<StateCandidate()>>;

/// Those that come nearest to what the set found does, from there, then those foreseen to gain most, from their starts: about a model
/// that lacks a strong law linearisation promises nothing of the right one.
std::vector<FitInPlace> FitsInPlace(const std::vector<LawContender>& laws, const CandidateFits& fits,
                                    const FoundSets& found) {
  const StatesExplanation& out = found.out;
  std::vector<std::pair<double, const LawContender*>> nearest;
  for (const LawContender& law : laws)
    if (const auto near = NearestLawTo(out.base.fit, out.final, *law.contender.model, found.episodes);
        near && near->apart > found.options.same_law && near->apart <= found.options.near_law)
      nearest.emplace_back(near->apart, &law);
  std::ranges::stable_sort(nearest, {}, &std::pair<double, const LawContender*>::first);
  std::vector<FitInPlace> in_place;
  for (const auto& [apart, nearest_law] : nearest) {
    const LawContender& law = *nearest_law;
    in_place.emplace_back(law.law,
                          [&] { return fits.FittedNear(law.contender, out.final, found.options.near_law); });
  }
  for (const LawContender& law : First(laws, found.options.contenders))
    in_place.emplace_back(law.law, [&] { return fits.Fitted(law.contender); });
  return in_place;
}

}  // namespace

std::vector<GeneralShape> GeneralShapes(const std::string& of) {
  return {
      {"{0}^2", of + "^2"},
      {"{0}^3", of + "^3"},
      {"{0}^5", of + "^5"},
      {"{0}*abs({0})", fmt::format("{0}*abs({0})", of)},
      {"tanh(10*{0})", Tell("a step in {}", "eine Stufe in {}", of)},
      {"max({0} - knee, 0)", Tell("what begins above some {}", "ein Anteil ab einem bestimmten {}", of)},
      {"max(knee - {0}, 0)", Tell("what begins below some {}", "ein Anteil bis zu einem bestimmten {}", of)},
      {"(max({0} - reach, 0) + min({0} + reach, 0))",
       Tell("what begins beyond some {} on both sides", "ein Anteil beiderseits ab einem bestimmten {}",
            of)}};
}

std::optional<Told> BetterGeneralLaw(FoundSets& found, const std::string& effect) {
  const StatesExplanation& out = found.out;
  const StateCandidate& rest = out.final.added.size() == 1 ? out.base : found.Without(effect);
  if (!rest.fitted()) return {};
  // What is left tells where another law stands that the effect imitates from its own equation.
  const GeneralLaws general(found.machine, EquationsOf(found.machine, {&effect, 1}), out.final_left.about,
                            rest.fit, found.episodes, out.final_left.structured);
  const CandidateFits fits(general.machine(), found.episodes, found.starts_on, found.options, out.base);
  std::vector<std::string> alone = found.machine.added_effects;
  alone.push_back(effect);
  const auto effect_alone = BuildStateModel(found.machine, alone);
  if (!effect_alone) return {};
  const double enough =
      out.final.held_out *
      (1 - (out.final_left.structured ? found.options.min_removed * out.final_left.least_share : 0));
  const std::vector<LawContender> laws = ContendersBeside(rest, general, fits);
  for (const auto& [law, fit] : FitsInPlace(laws, fits, found)) {
    const StateCandidate other = fit();
    if (other.fitted() && other.held_out < enough &&
        !SameLaw(out.base.fit, out.final, other, found.episodes, found.options.same_law, effect_alone->get()))
      return NotToldFromGeneral(effect, *law);
  }
  return {};
}

std::optional<Told> GeneralLawInPlaceOfAll(FoundSets& found) {
  const StatesExplanation& out = found.out;
  const GeneralLaws general(found.machine, EquationsOf(found.machine, out.final.added), "", out.base.fit,
                            found.episodes, true);
  const CandidateFits fits(general.machine(), found.episodes, found.starts_on, found.options, out.base);
  const std::vector<LawContender> laws = ContendersBeside(out.base, general, fits);
  for (const auto& [law, fit] : FitsInPlace(laws, fits, found)) {
    const StateCandidate alone = fit();
    if (alone.fitted() && alone.held_out < out.final.held_out)
      return NotToldFromGeneral(fmt::format("{}", fmt::join(out.final.added, " + ")), *law);
  }
  return {};
}

std::optional<LawBeside> FindLawBeside(FoundSets& found) {
  const StateCandidate& set = found.out.final;
  std::optional<LawBeside> best;
  const GeneralLaws general(found.machine, EquationsOf(found.machine, set.added), "", set.fit, found.episodes,
                            true);
  const CandidateFits fits(general.machine(), found.episodes, found.starts_on, found.options, found.out.base);
  const std::vector<LawContender> laws = ContendersBeside(set, general, fits);
  for (const LawContender& beside : First(laws, found.options.laws_beside)) {
    const StateCandidate both = fits.Fitted(beside.contender);
    const double removed = set.held_out - both.held_out;
    if (both.fitted() && removed > (best ? best->removed : 0)) best = LawBeside{*beside.law, removed};
  }
  return best;
}

}  // namespace hydroscope
