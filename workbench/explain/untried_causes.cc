#include "workbench/explain/untried_causes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/contains.h"
#include "diagnosis/effect_ranking.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

bool IsTwin(const Effect& one, const Effect& other) {
  return std::ranges::any_of(one.twins, [&](const Effect::Twin& twin) { return twin.id == other.id; });
}

/// Whether one may pass for the other.
bool IsLike(const Effect& untried, const Effect& named) {
  return (AreConfused(untried, named) || IsTwin(untried, named) || IsTwin(named, untried)) &&
         untried.nonlinear.size() <= named.nonlinear.size();
}

}  // namespace

void DoubtForUntried(const Machine& machine, const std::function<bool(int channel)>& measured,
                     Explanation& x) {
  const ModelStructure& model = *x.model;
  if (x.set.empty() || model.kind->effects == nullptr) return;
  std::vector<std::string> untried;
  for (const auto& effect : model.kind->effects(machine)) {
    const bool like_a_name = std::ranges::any_of(model.effects, [&](const auto& named) {
      return Contains(x.set, named->id) && IsLike(*effect, *named);
    });
    if (!like_a_name || Contains(x.set, effect->id)) continue;
    bool missing = false;
    for (const int channel : effect->channels) {
      if (measured(channel)) continue;
      missing = true;
      if (!Contains(x.unmeasured, model.channel_names[channel]))
        x.unmeasured.push_back(model.channel_names[channel]);
    }
    if (missing) untried.push_back(effect->id);
  }
  if (untried.empty()) return;
  for (const std::string& id : untried)
    if (!Contains(x.untried, id)) x.untried.push_back(id);
  const std::string signals = fmt::to_string(fmt::join(x.unmeasured, ", "));
  const bool one = x.unmeasured.size() == 1;
  const Told why = Tell("{} may be the cause as well and could not be tried: {} {} not measured",
                        "{} kann ebenso die Ursache sein und war nicht zu prüfen: {} {} nicht gemessen",
                        fmt::to_string(fmt::join(untried, ", ")), signals,
                        one ? Told("is", "wird") : Told("are", "werden"));
  x.doubt = x.partial && !x.doubt.empty() ? Tell("{}; {}", "{}; {}", why, x.doubt) : why;
  x.partial = true;
}

}  // namespace hydroscope
