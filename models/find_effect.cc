#include "models/find_effect.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/contains.h"
#include "core/told_error.h"
#include "core/units.h"
#include "models/effect.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

bool FitsSignals(const Effect& effect, const ModelStructure& model) {
  return std::all_of(effect.channels.begin(), effect.channels.end(),
                     [&](int channel) { return model.channel_source[channel] >= 0; });
}

}  // namespace

Result<int> FindEffect(const ModelStructure& model, const std::string& id) {
  for (std::size_t e = 0; e < model.effects.size(); ++e)
    if (model.effects[e]->id == id) return static_cast<int>(e);
  for (const auto& effect : model.sample_effects)
    if (effect->id == id && FitsSignals(*effect, model))
      return BadInput(Tell(
          "effect '{}' cannot be judged on stored strokes, which keep no columns of it: give a log",
          "Effekt '{}' lässt sich an gespeicherten Hüben nicht beurteilen, sie enthalten keine Spalten von ihm: ein "
          "Log angeben",
          id));
  std::vector<std::string> ids;
  for (const auto& effect : model.effects) ids.push_back(effect->id);
  const bool built_in = model.kind != nullptr && model.kind->effects != nullptr;
  for (const auto& effect : built_in ? model.kind->effects({}) : model.sample_effects) {
    if (!Contains(ids, effect->id)) ids.push_back(effect->id);
    if (effect->id != id) continue;
    std::vector<std::string> missing;
    for (int channel : effect->channels)
      if (model.channel_source[channel] < 0) missing.push_back(model.channel_names[channel]);
    return BadInput(Tell("effect '{}' needs signal {}, which the machine file does not have",
                         "Effekt '{}' braucht das Signal {}, das die Maschinendatei nicht hat", id,
                         fmt::join(missing, ", ")));
  }
  const std::string near = Nearest(id, ids);
  return BadInput(Tell("unknown effect '{}'; {}", "unbekannter Effekt '{}'; {}", id,
                       near.empty()
                           ? Tell("known effects: {}", "bekannt sind: {}", fmt::join(ids, ", "))
                           : Tell("did you mean '{}'? 'hydroscope model effects' lists them all",
                                  "ist '{}' gemeint? 'hydroscope model effects' listet alle auf", near)));
}

}  // namespace hydroscope
