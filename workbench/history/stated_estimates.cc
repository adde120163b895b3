#include "workbench/history/stated_estimates.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/contains.h"
#include "core/quantile.h"
#include "core/records/reason_told.h"
#include "models/machine_kind.h"
#include "models/model_structure.h"
#include "pipeline/doubtful_estimates.h"
#include "pipeline/run_summary.h"
#include "workbench/history/kept_noise.h"
#include "workbench/model/model_record.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kMostStrokesFitted = 400;
constexpr std::int64_t kMostSummaries = 256;  ///< strokes that are asked what they were driven at

/// Of a machine that is followed from episode to episode, each was predicted with the parameters as they stood before it.
/// Medians over the last run; no fit.
Status TakeErrorsOfEpisodes(const Database& database, const RunInfo& run, GramFit& figures) {
  const auto episodes = TRY(database.Strokes(run.id));
  std::vector<double> errors, floors;
  for (const StrokeSummary& episode : episodes) {
    errors.push_back(episode.rms_error);
    floors.push_back(episode.noise_floor);
  }
  figures.rms_holdout = Median(errors, 0);
  figures.noise_floor = Median(floors, 0);
  return {};
}

/// Strokes first <= sequence < end under `model`, without those of which other columns were stored.
Result<StrokeHistory> HistoryOf(const Database& database, std::int64_t machine_id, const Machine& machine,
                                std::shared_ptr<const ModelStructure> model, double period,
                                std::int64_t first, std::int64_t end) {
  StrokeHistory history;
  history.machine = machine;
  history.window = WindowSamples::From(machine.window, period);
  history.window.level_form = model->level_form;
  history.units = TRY(database.Grams(machine_id, first, end));
  std::erase_if(history.units,
                [&](const StrokeGram& gram) { return gram.flow.dimension() != model->column_count(); });
  history.model = std::move(model);
  return history;
}

double PeriodOf(const RunInfo& run, const Machine& machine) {
  const double period = ParseRunSummary(run.summary_json).sample_period;
  return period > 0 ? period : machine.live ? machine.live->grid_period : 0;
}

/// The fit to the last run that was read to its end; nothing where that excites too little, which each parameter tells.
Status FitLastRun(const Database& database, std::int64_t machine_id, const Machine& machine,
                  std::shared_ptr<const ModelStructure> model, const std::vector<RunInfo>& runs,
                  StatedEstimates& out) {
  const auto run =
      std::find_if(runs.rbegin(), runs.rend(), [](const RunInfo& r) { return r.complete && r.strokes > 0; });
  if (run == runs.rend()) return {};
  if (InEpisodes(KindOf(machine))) return TakeErrorsOfEpisodes(database, *run, out.figures);
  const double period = PeriodOf(*run, machine);
  if (!(period > 0)) return {};
  const std::int64_t end = run->first_sequence + run->strokes;
  auto history = TRY(HistoryOf(database, machine_id, machine, std::move(model), period,
                               std::max(run->first_sequence, end - kMostStrokesFitted), end));
  const auto noise = NoiseOf(ParseRunSummary(run->summary_json));
  history.floor_scale = noise ? noise->floor : std::nullopt;
  out.floor_known = history.floor_scale.has_value();
  if (const auto fitted = FitHistoryModel(machine, history)) out.figures = fitted->figures;
  return {};
}

void Confound(Told why, EstimateStatement& statement) {
  statement.confounded = true;
  statement.why = std::move(why);
}

/// The recursive estimate takes strokes for independent, and shapes of effects as given. Where strokes of the last run hang
/// together, or an effect has a shape (`shaped`), its intervals are at least those of the fit to them. Nor can it be trusted where the error of that fit could be taken for the parameter.
void StateByLastRun(const GramFit& figures, bool shaped, std::vector<EstimateStatement>& statements,
                    const std::vector<Estimate>& latest) {
  const bool together = shaped || figures.clusters.unit != ClusterUnit::kStroke;
  for (EstimateStatement& statement : statements)
    for (const Estimate& fitted : figures.parameters) {
      if (fitted.parameter != statement.parameter) continue;
      if (together && std::isfinite(fitted.std))
        statement.least_std = std::max(statement.least_std, fitted.std);
      const auto known = std::ranges::find(latest, fitted.parameter, &Estimate::parameter);
      const bool wider = known != latest.end() && statement.least_std > known->std;
      if (fitted.reason == EstimateReason::kConfounded && (fitted.excitation > 0 || wider))
        Confound(ReasonTold(fitted.reason), statement);
    }
}

bool HasShapes(const Machine& machine, const ModelStructure& model) {
  return std::ranges::any_of(model.effects, [&](const auto& effect) {
    return !effect->nonlinear.empty() && Contains(machine.added_effects, effect->id);
  });
}

/// The estimator follows a size at the shape that the machine file holds. How well the log that gave the shape told it, and with it
/// the size, stands in the history of the model; no number of further strokes at that shape tells it better.
void StateByShape(const Machine& machine, const ModelStructure& model,
                  std::vector<EstimateStatement>& statements) {
  for (const auto& effect : model.effects) {
    if (effect->nonlinear.empty() || !Contains(machine.added_effects, effect->id)) continue;
    const std::string size = effect->id + "." + effect->parameter;
    for (auto record = machine.model_history.rbegin(); record != machine.model_history.rend(); ++record) {
      const auto told = std::ranges::find(record->parameters, size, &RecordedValue::name);
      if (told == record->parameters.end()) continue;
      statements.push_back({.parameter = size, .least_std = told->std, .why = {}});
      break;
    }
  }
}

/// `latest` in the order of the model's parameters; one without an estimate cannot be moved out of its interval.
std::vector<Estimate> InOrder(const ModelStructure& model, const std::vector<Estimate>& latest) {
  std::vector<Estimate> out;
  for (const DerivedParameter& derived : model.derive(Eigen::VectorXd::Ones(model.base_count))) {
    const auto known = std::ranges::find(latest, derived.name, &Estimate::parameter);
    out.push_back(known != latest.end() ? *known : Estimate{.parameter = derived.name, .std = kInfinity});
  }
  return out;
}

/// Over the newest strokes, of whatever run.
Status ConfoundNewest(const Database& database, std::int64_t machine_id, const Machine& machine,
                      std::shared_ptr<const ModelStructure> model, const std::vector<RunInfo>& runs,
                      const std::vector<Estimate>& latest, StatedEstimates& out) {
  if (runs.empty() || model->effects.empty()) return {};
  const double period = PeriodOf(runs.back(), machine);
  const std::int64_t end = runs.back().first_sequence + runs.back().strokes;
  const std::int64_t first = std::max<std::int64_t>(0, end - kMostStrokesFitted);
  if (!(period > 0)) return {};
  const auto history = TRY(HistoryOf(database, machine_id, machine, model, period, first, end));
  const auto summaries = TRY(database.SummariesOf(machine_id, first, end, kMostSummaries));
  out.confounded = ConfoundingsOf(machine.added_effects, model, history.units, history.window,
                                  RangesOf(model->conditions, summaries), InOrder(*model, latest));
  return {};
}

}  // namespace

Result<StatedEstimates> StateEstimates(const Database& database, std::int64_t machine_id,
                                       const Machine& machine, const ModelStructure& model,
                                       const std::vector<RunInfo>& runs, std::vector<Estimate>& latest) {
  StatedEstimates out;
  Machine tolerant = machine;
  out.assumed = AssumeTolerances(tolerant);
  const auto assumed = TRY(BuildModel(tolerant));
  out.statements = ToleranceStatements(machine, model);
  StateByShape(machine, model, out.statements);
  TRY(FitLastRun(database, machine_id, tolerant, assumed, runs, out));
  std::vector<Estimate> known = latest;
  for (Estimate& e : known) StateEstimate(out.statements, e);
  StateByLastRun(out.figures, HasShapes(machine, model), out.statements, known);
  for (Estimate& e : latest) StateEstimate(out.statements, e);
  TRY(ConfoundNewest(database, machine_id, tolerant, assumed, runs, latest, out));
  for (const Confounding& c : out.confounded)
    for (EstimateStatement& statement : out.statements)
      if (statement.parameter == c.parameter)
        Confound(Tell("{}; {}", "{}; {}", c.reason, c.advice), statement);
  out.unusual = DoubtsOfNewest(machine, latest, runs);
  MarkConfounded(out.confounded, latest);
  return out;
}

}  // namespace hydroscope
