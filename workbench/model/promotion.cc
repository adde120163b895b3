#include "workbench/model/promotion.h"

#include "core/told_error.h"
#include "models/machine_kind.h"
#include "models/model_structure.h"
#include "pipeline/added_effects_estimator.h"
#include "storage/alarm_journal.h"
#include "workbench/model/model_record.h"

namespace hydroscope {
namespace {

/// Whether a run can begin with it. Error: why not.
Status CanBeRecorded(const Machine& machine) {
  const auto model = TRY(BuildModel(machine));
  if (InEpisodes(KindOf(machine))) return {};
  const auto wide = AddedEffectsEstimator::ModelWithValues(machine, *model);
  return wide ? Status() : tl::unexpected(wide.error());
}

Result<std::string> TextOf(const Database& database, const Promotion& promotion) {
  if (!promotion.text.empty()) return promotion.text;
  const auto version = TRY(database.GetModelVersion(promotion.id, promotion.version));
  return version.definition;
}

/// The machine as its last run recorded it lacks nothing; true of one without runs.
Status FitsLastRun(const Database& database, const Promotion& promotion, const Machine& model) {
  const auto runs = TRY(database.Runs(promotion.id));
  if (runs.empty()) return CanBeRecorded(model);
  const auto last = TRY(database.GetModelVersion(promotion.id, runs.back().model_version));
  const auto recorded = TRY(ParseMachine(last.definition, promotion.machine));
  if (const auto next = WithModelOf(recorded, model); !next)
    return BadInput(Tell("{} cannot be watched with this model: {}",
                         "{} kann mit diesem Modell nicht überwacht werden: {}", promotion.machine,
                         ToldOf(next.error())));
  return {};
}

}  // namespace

Result<Machine> WithModelOf(const Machine& machine, const Machine& model) {
  Machine next = machine;
  next.added_effects = model.added_effects;
  next.effect_values = model.effect_values;
  next.model_version = model.model_version;
  next.model_history = model.model_history;
  Machine with_own_effects = next;
  with_own_effects.user_effects = model.user_effects;
  if (with_own_effects == model) next = std::move(with_own_effects);
  TRY(CanBeRecorded(next));
  return next;
}

Result<int> StoreModel(Database& database, std::int64_t id, const std::string& text, const Machine& machine) {
  const auto model = TRY(BuildModel(machine));
  return database.PutModelVersion(id, {0, text, model->ColumnNames(), 0, model->ConditionNames()});
}

Result<Promoted> Promote(Database& database, const std::string& path, const Promotion& promotion) {
  const auto text = TRY(TextOf(database, promotion));
  const auto machine = TRY(ParseMachine(text, promotion.machine));
  TRY(FitsLastRun(database, promotion, machine));
  const auto strokes = TRY(database.EndSequence(promotion.id));
  const auto version =
      TRY(promotion.text.empty() ? Result<int>(promotion.version)
                                 : StoreModel(database, promotion.id, promotion.text, machine));
  TRY(database.PromoteModel(promotion.id, version));
  auto journal = AlarmJournal::OpenExisting(AlarmJournal::PathFor(path));
  if (!journal) return Promoted{machine, version};  // nothing is judged here
  TRY(journal->Change(promotion.machine, promotion.wall, [&](AxisContent& axis) -> Status {
    AlarmEvent event;
    event.event = "model_promoted";
    event.stroke = strokes;
    event.model_version = version;
    event.user = promotion.user;
    event.comment = promotion.comment;
    event.text = fmt::format("model version {}: {}", version, ModelName(machine));
    axis.events.push_back(std::move(event));
    return {};
  }));
  return Promoted{machine, version};
}

}  // namespace hydroscope
