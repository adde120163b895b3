#include "monitor/promoted_model.h"

#include "core/contains.h"
#include "workbench/model/model_edit.h"
#include "workbench/model/promotion.h"

namespace hydroscope {

Result<std::optional<PromotedMachine>> PromotedFor(const Database& database, const std::string& path,
                                                   std::int64_t id, const Machine& machine,
                                                   const std::string& text) {
  const auto promoted = TRY(database.PromotedModel(id));
  if (!promoted) return std::nullopt;
  const int version = promoted->version;
  const auto model = ParseMachine(promoted->definition, machine.name);
  if (!model)
    return BadInput("{}: the promoted model (version {}) cannot be read: {}", path, version,
                    model.error().text);
  if (model->added_effects == machine.added_effects && model->effect_values == machine.effect_values)
    return std::nullopt;
  auto next = WithModelOf(machine, *model);
  if (!next)
    return BadInput("{}: the promoted model (version {}) does not fit the machine file: {}", path, version,
                    next.error().text);
  PromotedMachine taken{version, std::move(*next), promoted->definition};
  if (taken.machine != *model) taken.text = EditedMachineText(text, taken.machine);
  return taken;
}

Result<std::vector<Machine>> StoredAxes(const std::string& path, const Machine& machine, Database& database) {
  const auto names = TRY(database.MachineNames());
  std::vector<Machine> axes;
  for (int axis = 0; axis < AxisCount(machine); ++axis) {
    const std::string name = AxisMachineName(machine, axis);
    if (!Contains(names, name)) continue;
    const auto id = TRY(database.MachineId(name));
    auto promoted = TRY(PromotedFor(database, path, id, machine, ""));
    axes.push_back(MachineOfAxis(promoted ? promoted->machine : machine, axis));
  }
  return axes;
}

Result<int> VersionFor(Database& database, std::int64_t id, const ModelVersion& model) {
  const auto promoted = TRY(database.PromotedModel(id));
  if (promoted && promoted->definition == model.definition && promoted->columns == model.columns)
    return promoted->version;
  return database.PutModelVersion(id, model);
}

}  // namespace hydroscope
