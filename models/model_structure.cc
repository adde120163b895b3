#include "models/model_structure.h"

#include "core/limits.h"
#include "models/die_cushion.h"
#include "models/effect.h"
#include "models/expression_balance.h"

namespace hydroscope {

std::vector<std::string> ModelStructure::ColumnNames() const {
  std::vector<std::string> names;
  for (const Column& column : columns) names.push_back(column.name);
  return names;
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

Result<std::shared_ptr<const ModelStructure>> BuildKind(const Machine& machine) {
  if (machine.model == "die_cushion") return BuildDieCushion(machine);
  if (machine.model == "expressions") return BuildExpressionBalance(machine);
  return BadInput(
      "machine '{}': model '{}' cannot be identified from strokes; known models: die_cushion, expressions",
      machine.name, machine.model);
}

}  // namespace

Result<std::shared_ptr<const ModelStructure>> BuildModel(const Machine& machine) {
  auto model = BuildKind(machine);
  if (!model) return model;
  const std::size_t effects = machine.added_effects.size();
  if (static_cast<std::size_t>((*model)->base_count) + effects > kMaxParameters)
    return BadInput(
        "machine '{}': {} parameters and {} added effects, at most {} can be fitted at once: take an effect "
        "out "
        "with 'hydroscope model remove'",
        machine.name, (*model)->base_count, effects, kMaxParameters);
  return model;
}

}  // namespace hydroscope
