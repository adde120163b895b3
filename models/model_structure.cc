#include "models/model_structure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/limits.h"
#include "core/told_error.h"
#include "models/effect.h"
#include "models/episode_structure.h"
#include "models/machine_kind.h"

namespace hydroscope {

std::vector<std::string> ModelStructure::ColumnNames() const {
  std::vector<std::string> names;
  for (const Column& column : columns) names.push_back(column.name);
  return names;
}

std::vector<ConditionName> ModelStructure::ConditionNames() const {
  std::vector<ConditionName> names;
  for (const Condition& condition : conditions) names.push_back({condition.name, condition.unit});
  return names;
}

int ModelStructure::MeasuredChannel(std::string_view channel) const {
  for (std::size_t c = 0; c < channel_source.size(); ++c)
    if (channel_names[c] == channel && channel_source[c] >= 0) return static_cast<int>(c);
  return -1;
}

std::vector<int> ModelStructure::WalkingParameters(const std::vector<int>& added) const {
  std::vector<int> entries;
  for (int c = 0; c < base_count; ++c)
    if (columns[c].walks) entries.push_back(c);
  for (std::size_t k = 0; k < added.size(); ++k)
    if (effects[added[k]]->walks) entries.push_back(base_count + static_cast<int>(k));
  // The entry after the last parameter stands for the output.
  if (columns[output_column()].walks) entries.push_back(base_count + static_cast<int>(added.size()));
  return entries;
}

namespace {

Result<std::shared_ptr<ModelStructure>> BuildKind(const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  if (kind.build != nullptr || InEpisodes(kind)) {
    auto model = kind.build != nullptr ? kind.build(machine) : BuildEpisodeStructure(machine);
    if (!model) return model;
    (*model)->name = kind.id;
    (*model)->kind = &kind;
    (*model)->words = kind.words(machine);
    (*model)->conditions = ConditionsOf(machine);
    (*model)->temperature_channel = (*model)->MeasuredChannel(kind.temperature);
    return model;
  }
  std::vector<std::string_view> known;
  for (const MachineKind* other : MachineKinds())
    if (other->build != nullptr || InEpisodes(*other)) known.push_back(other->id);
  return BadInput(Tell(
      "machine '{}': model '{}' cannot be identified from strokes: `hydroscope frf LOG --machine FILE` measures its "
      "frequency response; from strokes: {}",
      "Maschine '{}': das Modell '{}' kann nicht aus Hüben identifiziert werden: `hydroscope frf LOG --machine DATEI` misst "
      "seinen Frequenzgang; aus Hüben: {}",
      machine.name, machine.model, fmt::join(known, ", ")));
}

}  // namespace

Result<std::shared_ptr<const ModelStructure>> BuildModel(const Machine& machine) {
  const auto model = TRY(BuildKind(machine));
  if (machine.estimator.equation == EquationForm::kPublished && !model->published)
    return BadInput(Tell(
        "machine '{}': nothing was published of model {} that equation = \"published\" "
        "in [estimator] could mean; leave it out",
        "Maschine '{}': vom Modell {} wurde nichts veröffentlicht, was equation = \"published\" in [estimator] meinen "
        "könnte; es weglassen",
        machine.name, model->name));
  // The parameters of a model with states hold those of its effects.
  const std::size_t effects = KindOf(machine).has_states ? 0 : machine.added_effects.size();
  if (static_cast<std::size_t>(model->base_count) + effects > kMaxParameters)
    return BadInput(Tell(
        "machine '{}': {} parameters and {} added effects, at most {} can be fitted at once: take an effect "
        "out with 'hydroscope model remove'",
        "Maschine '{}': {} Parameter und {} hinzugefügte Effekte, höchstens {} lassen sich zusammen bestimmen: einen "
        "Effekt mit 'hydroscope model remove' herausnehmen",
        machine.name, model->base_count, effects, kMaxParameters));
  if (model->conditions.size() > kMaxConditions)
    return BadInput(Tell(
        "machine '{}': {} conditions of its strokes, at most {} can be stored: leave some out of [conditions]",
        "Maschine '{}': {} Bedingungen ihrer Hübe, höchstens {} lassen sich speichern: einige aus [conditions] "
        "weglassen",
        machine.name, model->conditions.size(), kMaxConditions));
  return model;
}

}  // namespace hydroscope
