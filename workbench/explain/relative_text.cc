#include "workbench/explain/relative_text.h"

#include "diagnosis/remainder/feature_banks.h"

namespace hydroscope {

std::vector<Relative> RelativesOf(const ExplainResult& result) {
  std::vector<Relative> out;
  const Explanation& x = result.explanation;
  if (!x.partial) return out;
  for (auto k = static_cast<std::size_t>(x.started); k < x.chosen.size(); ++k) {
    const Effect& effect = result.effect(x.chosen[k].effect);
    if (effect.family.empty()) continue;
    // Whatever changed from log to log looks like anything that drifts through all of them.
    if (!effect.drifting.empty() && x.base_left.about == kOrderOfLogs) continue;
    const Told where =
        effect.where ? Tell(" {}", ", {}", effect.where(result.NonlinearOf(x.chosen[k]))) : Told{};
    out.push_back(
        {effect.id, Tell("{}{}; nearest relative: {} ({})", "{}{}; nächster Verwandter: {} ({})",
                         effect.family, where, Told(effect.title, effect.german.title), effect.id)});
  }
  return out;
}

Told LateSignal(const ProposedLaw& law) {
  if (law.late_signal.empty()) return {};
  return Tell(
      "as if {} and the other signals were not of the same moment: one comes late, or through a filter",
      "als gehörten {} und die anderen Signale nicht zum selben Augenblick: eines kommt später oder durch ein Filter",
      law.late_signal);
}

}  // namespace hydroscope
