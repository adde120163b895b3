#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/contains.h"
#include "models/effect.h"

namespace hydroscope {

EffectVariant PlainVariant(Column::Fill column) {
  return {{std::move(column)}, [](const ShapeContext&) { return std::vector<double>{1.0}; }};
}

namespace {

Column::Fill OnCorrected(Column::Fill fill, std::shared_ptr<const Effect> by, double value) {
  return [fill = std::move(fill), by = std::move(by), value](const Stretch& s, double& state,
                                                             std::span<double> out) {
    if (s.scattered) return fill(s, state, out);
    Stretch corrected = s;
    by->correct(value, state, corrected);
    fill(corrected, state, out);
  };
}

}  // namespace

int AddShape(ModelStructure& model, int index, const std::vector<double>& nonlinear,
             const std::optional<Correction>& on) {
  const Effect& effect = *model.effects[index];
  EffectVariant variant = effect.variant(nonlinear);
  EffectShape shape{{}, std::move(variant.weights), nonlinear, on};
  for (std::size_t j = 0; j < variant.columns.size(); ++j) {
    std::string name = effect.id;
    if (!nonlinear.empty()) name += fmt::format("[{:g}]", fmt::join(nonlinear, ","));
    if (variant.columns.size() > 1) name += fmt::format(".{}", j);
    if (!effect.edition.empty()) name += " " + effect.edition;
    Column::Fill fill = std::move(variant.columns[j]);
    if (on) {
      name += fmt::format(" after {}[{:g}]", model.effects[on->effect]->id, on->value);
      fill = OnCorrected(std::move(fill), model.effects[on->effect], on->value);
    }
    shape.columns.push_back(model.column_count());
    model.columns.push_back({std::move(name), std::move(fill), effect.walks});
  }
  model.effect_shapes[index].push_back(std::move(shape));
  return static_cast<int>(model.effect_shapes[index].size()) - 1;
}

void AddLibrary(std::vector<std::shared_ptr<const Effect>> effects, ModelStructure& model) {
  for (auto& effect : effects) {
    const bool measured = std::all_of(effect->channels.begin(), effect->channels.end(),
                                      [&](int channel) { return model.channel_source[channel] >= 0; });
    if (!measured) continue;
    model.effects.push_back(std::move(effect));
    model.effect_shapes.emplace_back();
    for (const std::vector<double>& nonlinear : model.effects.back()->grid)
      AddShape(model, static_cast<int>(model.effects.size()) - 1, nonlinear);
  }
}

void AddSampleEffects(ModelStructure& model, const std::vector<std::string>& ids) {
  std::vector<std::shared_ptr<const Effect>> missing;
  for (const auto& effect : model.sample_effects) {
    const auto same = [&](const auto& other) { return other->id == effect->id; };
    if (std::any_of(model.effects.begin(), model.effects.end(), same)) continue;
    if (ids.empty() || Contains(ids, effect->id)) missing.push_back(effect);
  }
  AddLibrary(std::move(missing), model);
}

void AddGenericLaws(ModelStructure& model) { AddLibrary(model.generic_laws, model); }

}  // namespace hydroscope
