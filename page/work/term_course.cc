#include "page/work/term_course.h"

#include <algorithm>
#include <numeric>

#include "core/json_value.h"
#include "models/expressions/check.h"
#include "models/expressions/user_effect.h"

namespace hydroscope {
namespace {

/// SI unit of the term, "" if it is not exact.
std::string UnitOfTerm(const Machine& machine, const UserEffectSpec& effect) {
  const auto checked = CheckExpression(effect.terms.front().expression, ExpressionNamesOf(machine, effect));
  return checked && checked->unit.exact ? SiUnitName(checked->unit.dimension) : "";
}

/// An effect that reads them all, so that they are kept: strokes hold the signals that the model reads.
UserEffectSpec OfEverySignal(const Machine& machine) {
  std::string product;
  for (const SignalSpec& signal : machine.signals) product += (product.empty() ? "" : "*") + signal.name;
  UserEffectSpec effect;
  effect.id = "every_signal";
  effect.terms = {{"k", product}};
  return effect;
}

/// Whether the term reads no measured channel beyond those that the stroke was kept with.
bool HoldsAll(const ModelStructure& model, std::size_t kept) {
  for (std::size_t c = kept; c < model.channel_source.size(); ++c)
    if (model.channel_source[c] != kDerivedChannel) return false;
  return true;
}

/// Means of the term over the blocks of a stretch.
std::vector<double> BlockMeans(const ModelStructure& model, Stretch stretch, int block) {
  const auto length = static_cast<std::size_t>(stretch.before + stretch.samples + stretch.after);
  stretch.channel.resize(model.channel_names.size(), std::vector<double>(length));
  model.derive_channels(stretch);
  // Of the level form values, one per sample; else increments of the integral over time.
  std::vector<double> filled(static_cast<std::size_t>(stretch.samples - (model.level_form ? 0 : 1)));
  double state = 0;
  const int column = model.effect_shapes.back().front().columns.front();
  model.columns[static_cast<std::size_t>(column)].fill(stretch, state, filled);
  const double scale = model.level_form ? 1.0 : 1.0 / stretch.period;
  std::vector<double> means;
  for (auto at = filled.begin(); filled.end() - at >= block; at += block)
    means.push_back(scale * std::accumulate(at, at + block, 0.0) / block);
  return means;
}

}  // namespace

std::shared_ptr<const TermStroke> TermStroke::Of(const CompareResult& compared,
                                                 const std::vector<std::string>& logs) {
  Machine machine = compared.log.machine;
  machine.user_effects.push_back(OfEverySignal(machine));
  const auto all = ReadStrokes(logs, machine, KeepSamples::kYes);
  const LogStrokes& log = all ? *all : compared.log;
  const std::size_t worst = compared.WorstStroke();
  if (worst >= log.stretches.size()) return nullptr;
  return Of(log, worst, compared.per_stroke[worst].stroke);
}

std::shared_ptr<const TermStroke> TermStroke::Of(const std::string& log, const Machine& machine) {
  Machine every = machine;
  every.user_effects = {OfEverySignal(machine)};
  const auto read = ReadStrokes(log, every, KeepSamples::kYes);
  if (!read || read->stretches.empty()) return nullptr;
  const auto samples = [](const StrokeStretches& stretches) {
    std::int64_t sum = 0;
    for (const Stretch& stretch : stretches) sum += stretch.samples;
    return sum;
  };
  const auto longest = std::ranges::max_element(read->stretches, {}, samples);
  const auto at = static_cast<std::size_t>(longest - read->stretches.begin());
  return Of(*read, at, static_cast<std::int64_t>(at));
}

std::shared_ptr<const TermStroke> TermStroke::Of(const LogStrokes& log, std::size_t stroke,
                                                 std::int64_t number) {
  auto kept = std::make_shared<TermStroke>();
  kept->stroke_ = number;
  kept->stretches_ = log.stretches[stroke];
  kept->model_ = log.model;
  kept->block_ = log.window.block;
  return kept;
}

nlohmann::json TermStroke::Course(const Machine& machine, const UserEffectSpec& effect) const {
  Machine alone = machine;
  alone.user_effects = {effect};
  ModelStructure model = *model_;
  const std::size_t kept = model.channel_names.size(), effects = model.effect_shapes.size();
  if (!AddUserEffects(alone, 1.0, model) || model.effect_shapes.size() == effects) return nullptr;
  if (!HoldsAll(model, kept)) return nullptr;
  nlohmann::json values = nlohmann::json::array();
  double period = 0;
  for (const Stretch& stretch : stretches_) {
    if (stretch.samples <= block_) continue;
    if (!values.empty() && !stretch.continues) values.push_back(nullptr);
    period = stretch.period;
    for (const double mean : BlockMeans(model, stretch, block_)) values.push_back(JsonNumber(mean));
  }
  return {{"stroke", stroke_},
          {"step", block_ * period},
          {"values", std::move(values)},
          {"unit", UnitOfTerm(machine, effect)}};
}

}  // namespace hydroscope
