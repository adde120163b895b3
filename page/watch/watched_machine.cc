#include "page/watch/watched_machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/constants.h"
#include "core/json_value.h"
#include "core/records/reason_told.h"
#include "core/relative_change.h"
#include "core/time_text.h"
#include "models/counted_words.h"
#include "models/model_structure.h"
#include "monitor/mean_deviation.h"
#include "monitor/rules_for.h"
#include "monitor/statement_json.h"
#include "page/watch/trend_cache.h"
#include "pipeline/doubtful_estimates.h"
#include "storage/valve_check_words.h"
#include "workbench/history/stated_estimates.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kStrokesCompared = 64;  ///< newest judged ones, together against the reference
constexpr std::int64_t kSparkPoints = 60;      ///< of the small course of a parameter
constexpr std::int64_t kSparkGlance = 4;       ///< strokes that each of its points looks at

std::vector<std::pair<std::string, double>> LimitsOf(const Machine& machine, const std::string& parameter) {
  std::vector<std::pair<std::string, double>> limits;
  for (const MonitorSpec& spec : machine.monitors) {
    if (spec.parameter != parameter) continue;
    for (const auto& [name, limit] : {std::pair{"alarm_low", spec.alarm_low},
                                      {"warn_low", spec.warn_low},
                                      {"warn_high", spec.warn_high},
                                      {"alarm_high", spec.alarm_high}})
      if (limit) limits.emplace_back(name, *limit);
  }
  return limits;
}

/// Place of a quantity of the drift watch; -1: it is not watched.
int QuantityIndex(const drift::DriftMonitor& monitor, const std::string& name) {
  const auto& quantities = monitor.model().quantities();
  const auto found =
      std::find_if(quantities.begin(), quantities.end(), [&](const auto& q) { return q.name == name; });
  const int quantity = found == quantities.end() ? -1 : static_cast<int>(found - quantities.begin());
  return quantity >= 0 && monitor.watched(quantity) ? quantity : -1;
}

/// Whether a change of the quantity is found and stands.
bool HasMoved(const drift::DriftMonitor& monitor, const std::string& name) {
  for (const drift::DriftFinding& finding : monitor.findings())
    for (const drift::FindingPart& part : finding.parts)
      if (part.quantity == name && finding.state != drift::FindingState::kGone) return true;
  return false;
}

/// What the service tells of the newest stroke of the axis.
std::vector<Told> ToldWarnings(const nlohmann::json& told) {
  std::vector<Told> warnings;
  if (!told.is_object()) return warnings;
  const nlohmann::json english = told.value("warnings", nlohmann::json::array()),
                       german = told.value("german", nlohmann::json::object()).value("warnings", english);
  for (std::size_t i = 0; i < english.size() && i < german.size(); ++i)
    warnings.emplace_back(english[i].get<std::string>(), german[i].get<std::string>());
  return warnings;
}

/// NE 107 as a running service and its feeds tell it.
Health ToldHealth(const nlohmann::json& told) {
  Health health;
  health.state = HealthStateOf(told.value("health", "C").front());
  health.reason = HealthReasonNamed(told.value("health_reason", ""));
  health.text = told.value("health_text", "");
  health.german = told.value("health_text_german", "");
  if (told.value("reference_version", 0) > 0) return health;
  health.learned = told.value("commissioning_strokes", std::int64_t{0});
  health.needed = told.value("commissioning_needed", std::int64_t{0});
  return health;
}

nlohmann::json HealthJson(const Health& health, bool live) {
  return {{"letter", std::string(1, health.letter())},
          {"reason", HealthReasonName(health.reason)},
          {"text", health.text},
          {"german", health.german},
          {"learned", health.learned},
          {"needed", health.needed},
          {"live", live}};
}

nlohmann::json UnitJson(const WatchedParameter& parameter) {
  const ParameterInfo& info = parameter.info;
  return {{"si", parameter.si},
          {"factor", info.factor},
          {"offset", info.offset},
          {"name", info.unit},
          {"symbol", info.symbol},
          {"meaning", info.name},
          {"sentence", info.sentence},
          {"relative", info.relative},
          {"german", {{"meaning", parameter.german}, {"sentence", parameter.german_sentence}}}};
}

}  // namespace

Result<std::unique_ptr<WatchedMachine>> WatchedMachine::Create(const Sources& sources,
                                                               const std::string& name, std::int64_t id) {
  std::unique_ptr<WatchedMachine> watched(new WatchedMachine(sources));
  watched->name_ = name;
  watched->id_ = id;
  TRY(watched->ReadRuns());
  if (watched->end_ == 0) return watched;
  auto machine = TRY(StoredMachine(sources.database, sources.path, {name, id, 0, watched->end_}));
  watched->described_ = watched->machine_ = std::move(machine);
  watched->machine_.name = name;
  watched->model_ = TRY(BuildModel(watched->machine_));
  watched->rules_ = TRY(RulesFor(sources.machine_file, watched->machine_));
  if (sources.journal != nullptr)
    watched->monitor_ = std::make_unique<AxisMonitor>(watched->machine_, watched->model_, watched->rules_,
                                                      sources.database, sources.path, id, *sources.journal);
  return watched;
}

Status WatchedMachine::ReadRuns() {
  const auto runs = TRY(sources_.database.Runs(id_));
  runs_ = runs.size();
  marks_.clear();
  int version = 0;
  for (const RunInfo& run : runs) {
    end_ = run.first_sequence + run.strokes;
    if (run.strokes == 0 && &run != &runs.back()) continue;
    if (version != 0 && run.model_version != version)
      marks_.push_back(
          {"model", run.first_sequence, Tell("version {}", "Version {}", run.model_version),
           Tell("model version {} after {}", "Modell Version {} nach {}", run.model_version, version)});
    version = run.model_version;
  }
  const auto promoted = TRY(sources_.database.PromotedModel(id_));
  model_version_ = promoted ? promoted->version : version;
  return {};
}

Status WatchedMachine::ReadValveChecks() {
  const auto checks = TRY(sources_.database.ValveChecks(id_));
  for (const ValveCheckRecord& check : checks) {
    const auto stroke = TRY(sources_.database.SequenceNear(id_, check.check.time));
    if (stroke == 0) continue;  // before anything that is stored
    marks_.push_back(
        {"valve_check", stroke, check.outcome, valve_check::ToldOf(check.detail), check.check.time});
  }
  return {};
}

/// As a running service states them; else as the database has it, asked anew after as many strokes as there.
Status WatchedMachine::StateLatest(const nlohmann::json& told, std::vector<TrendPoint>& latest) {
  if (told.is_object() && told.contains("statements")) {
    statements_.clear();
    for (const nlohmann::json& statement : told["statements"]) statements_.push_back(StatementOf(statement));
  } else if (!latest.empty() && (stated_to_ < 0 || end_ - stated_to_ >= AxisMonitor::kStrokesPerStatement)) {
    const auto runs = TRY(sources_.database.Runs(id_));
    std::vector<Estimate> stored;
    for (const TrendPoint& point : latest) stored.push_back(point.estimate);
    if (auto stated = StateEstimates(sources_.database, id_, machine_, *model_, runs, stored))
      statements_ = std::move(stated->statements);
    stated_to_ = end_;
  }
  std::vector<Estimate> estimates;
  for (TrendPoint& point : latest) {
    StateEstimate(statements_, point.estimate);
    estimates.push_back(point.estimate);
  }
  doubts_ = DoubtsOfNewest(machine_, estimates, TRY(sources_.database.Runs(id_)));
  AddDoubts(ToldWarnings(told), doubts_);
  return {};
}

Status WatchedMachine::DescribeParameters(const std::vector<TrendPoint>& latest) {
  parameters_.clear();
  for (const TrendPoint& point : latest) {
    const Estimate& estimate = point.estimate;
    WatchedParameter& parameter = parameters_[estimate.parameter];
    parameter.info = InfoFor(*model_->kind, estimate.parameter, estimate.unit, estimate.value);
    parameter.si = estimate.unit;
    if (const MachineParameter* known = FindParameter(*model_->kind, estimate.parameter)) {
      parameter.german = known->meaning.german;
      parameter.german_sentence = known->sentence.german;
    }
    parameter.limits = LimitsOf(machine_, estimate.parameter);
  }
  const drift::DriftMonitor* monitor = monitor_ ? monitor_->monitor() : nullptr;
  if (monitor == nullptr) return {};
  for (int q = 0; q < monitor->model().size(); ++q) {
    const drift::Quantity& quantity = monitor->model().quantities()[static_cast<std::size_t>(q)];
    if (!monitor->watched(q)) continue;
    const double typical = monitor->reference().typical(q);
    WatchedParameter& parameter = parameters_[quantity.name];
    if (parameter.si.empty()) {
      parameter.si = quantity.unit;
      parameter.info = InfoForQuantity(*model_->kind, quantity, typical);
      for (const auto& effect : model_->effects) {
        if (!quantity.effect || effect->id != quantity.name) continue;
        parameter.info.name = effect->title;
        parameter.german = effect->german.title;
      }
    }
    parameter.smallest = monitor->sizes(q).smallest;
    if (!quantity.effect) parameter.healthy = monitor->reference().curves()[static_cast<std::size_t>(q)];
  }
  return {};
}

/// The newest judged strokes together against the reference, beside what was found; null where there is none.
nlohmann::json WatchedMachine::ReferenceJson(const std::string& parameter,
                                             const std::vector<AxisMonitor::JudgedValue>& judged) const {
  const drift::DriftMonitor* monitor = monitor_ ? monitor_->monitor() : nullptr;
  const int quantity = monitor == nullptr ? -1 : QuantityIndex(*monitor, parameter);
  if (quantity < 0) return {};
  const MeanDeviation mean = MeanDeviationBesideFindings(judged, quantity, *monitor);
  if (mean.strokes == 0) return {};
  const double std = std::hypot(mean.std, mean.doubt);
  nlohmann::json json = {{"value", JsonNumber(mean.reference)},
                         {"deviation", JsonNumber(mean.value)},
                         {"std", JsonNumber(std)},
                         {"smallest", JsonNumber(parameters_.at(parameter).smallest)},
                         {"strokes", mean.strokes},
                         {"moved", HasMoved(*monitor, parameter)},
                         {"percent", nullptr}};
  if (const auto share = RelativeChange(mean.reference, std, mean.value);
      share && parameters_.at(parameter).info.relative) {
    json["percent"] = 100 * *share;
    json["percent_std"] = 100 * std / std::abs(mean.reference);
  }
  return json;
}

Result<nlohmann::json> WatchedMachine::ParametersJson(const std::vector<TrendPoint>& latest) const {
  std::vector<AxisMonitor::JudgedValue> judged;
  if (monitor_ && monitor_->monitor() != nullptr) {
    const std::int64_t first = std::max(monitor_->monitor()->reference().last_sequence() + 1,
                                        monitor_->next_stroke() - kStrokesCompared);
    judged = TRY(monitor_->JudgedValues(first, std::max<std::int64_t>(0, monitor_->next_stroke() - first)));
  }
  nlohmann::json list = nlohmann::json::array();
  const auto add = [&](const std::string& name, const Estimate* estimate) -> Status {
    const WatchedParameter& parameter = parameters_.at(name);
    nlohmann::json json = {
        {"parameter", name}, {"unit", UnitJson(parameter)}, {"reference", ReferenceJson(name, judged)}};
    if (estimate == nullptr) {
      json["trend"] = false;
    } else {
      const std::int64_t width = std::max<std::int64_t>(1, (end_ + kSparkPoints - 1) / kSparkPoints);
      const auto bins = TRY(end_ > TrendCache::kMostRead
                                ? GlancedBins(sources_.path, id_, name, 0, end_, width, kSparkGlance)
                                : sources_.database.TrendBins(id_, name, 0, end_, width, kSparkGlance));
      const EstimateStatement* statement = FindStatement(statements_, name);
      const bool marked =
          estimate->reason == EstimateReason::kConfounded && statement != nullptr && statement->confounded;
      const Told why = marked ? statement->why : Told(ReasonTold(estimate->reason));
      nlohmann::json spark = nlohmann::json::array();
      for (const TrendBin& bin : bins) spark.push_back(JsonNumber(bin.mean));
      json.update({{"trend", true},
                   {"value", JsonNumber(estimate->value)},
                   {"std", JsonNumber(estimate->std)},
                   {"reason", ReasonName(estimate->reason)},
                   {"reason_text", why.english},
                   {"german", {{"reason_text", why.german}}},
                   {"spark", std::move(spark)}});
    }
    list.push_back(std::move(json));
    return {};
  };
  for (const TrendPoint& point : latest) TRY(add(point.estimate.parameter, &point.estimate));
  for (const auto& [name, parameter] : parameters_) {
    const bool estimated =
        std::any_of(latest.begin(), latest.end(),
                    [&, &sought = name](const TrendPoint& p) { return p.estimate.parameter == sought; });
    if (estimated) continue;
    TRY(add(name, nullptr));
  }
  return list;
}

void WatchedMachine::AddTitles(nlohmann::json& effects) const {
  if (model_ == nullptr) return;
  std::vector<std::shared_ptr<const Effect>> named = model_->effects;
  // An alarm may name one that needs a signal which this machine does not measure.
  if (model_->kind->effects != nullptr)
    std::ranges::copy(model_->kind->effects(machine_), std::back_inserter(named));
  for (const auto& effect : named) {
    const bool there = std::any_of(effects.begin(), effects.end(),
                                   [&](const nlohmann::json& known) { return known["id"] == effect->id; });
    if (there || effect->title.empty()) continue;
    effects.push_back({{"id", effect->id}, {"title", effect->title}, {"german", nullptr}});
    if (!effect->german.title.empty()) effects.back()["german"] = {{"title", effect->german.title}};
  }
}

/// As its own monitor answers; nothing known where there is none.
hydroscope::Health WatchedMachine::Health() const {
  hydroscope::Health health;
  if (monitor_ && not_looked_.empty()) health = monitor_->JudgedHealth();
  if (!not_looked_.empty()) {
    const Told unknown = Tell("not known here: {}", "hier nicht bekannt: {}", not_looked_);
    health.text = unknown.english;
    health.german = unknown.german;
  }
  return health;
}

Status WatchedMachine::Refresh(const nlohmann::json& told) {
  TRY(ReadRuns());
  TRY(ReadValveChecks());
  not_looked_.clear();
  if (monitor_)
    if (const Status looked = monitor_->Look(); !looked) not_looked_ = looked.error().text;
  std::vector<TrendPoint> latest;
  if (model_ != nullptr) {  // first strokes make another object (Watcher)
    latest = TRY(sources_.database.Trend(id_, "", end_ - 1, end_));
  }
  TRY(StateLatest(told, latest));
  TRY(DescribeParameters(latest));
  auto parameters = TRY(ParametersJson(latest));
  const double last = latest.empty() ? kNaN : latest.front().time;
  const double oil = latest.empty() ? kNaN : latest.front().oil_temperature;
  dated_ = CountsFrom1970(last);
  picture_ = {name_,
              name_.substr(name_.rfind('/') + 1),
              told.is_object() ? ToldHealth(told) : Health(),
              {},
              end_,
              std::move(latest)};
  const drift::DriftMonitor* monitor = monitor_ ? monitor_->monitor() : nullptr;
  json_ = {{"machine", name_},
           {"health", HealthJson(picture_.health, told.is_object())},
           {"counted", (model_ == nullptr ? CountedWords{} : CountedWordsOf(machine_)).one},
           {"strokes", end_},
           {"runs", runs_},
           {"last_s", JsonNumber(last)},
           {"dated", dated_},
           {"oil_temperature_K", JsonNumber(oil)},
           {"model_version", model_version_},
           {"effects", machine_.added_effects},
           {"reference_version", monitor == nullptr ? 0 : monitor->reference().version()},
           {"judged_to", monitor_ ? monitor_->next_stroke() : 0},
           {"parameters", std::move(parameters)},
           {"warnings", InEnglish(doubts_)},
           {"german", {{"warnings", InGerman(doubts_)}}}};
  return {};
}

}  // namespace hydroscope
