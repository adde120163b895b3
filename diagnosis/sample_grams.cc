#include "diagnosis/sample_grams.h"

#include "estimation/stroke_accumulator.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMostKept = 16'000'000;  ///< numbers, 128 MB

/// `add` takes the equations of each stretch, `take` gives the Gram of the stroke that they were.
template <typename Add, typename Take>
std::vector<StrokeGram> FormGrams(const ModelStructure& model, std::span<const StrokeStretches> strokes,
                                  SpanEquationBuilder& builder, Add add, Take take) {
  std::vector<StrokeGram> grams;
  Stretch work;
  for (const StrokeStretches& stroke : strokes) {
    for (const Stretch& stretch : stroke) add(builder.BuildDerived(Derived(model, stretch, work), 0.0));
    grams.push_back(take());
    if (!stroke.empty()) grams.back().log = stroke.front().log;
  }
  return grams;
}

/// What products with further columns need of them.
SpanEquations WhatIsKnownOf(const SpanEquations& span) {
  SpanEquations known;
  known.integral = span.integral.leftCols(span.equations);
  known.noise = span.noise.leftCols(span.blocks);
  known.walk = span.walk;
  known.flow = span.flow.leftCols(static_cast<Eigen::Index>(span.flow_time.size()));
  return known;
}

std::size_t NumbersOf(const SpanEquations& span) {
  return static_cast<std::size_t>(span.integral.size() + span.noise.size() + span.walk.size() +
                                  span.flow.size());
}

}  // namespace

ModelStructure BaseOnly(const ModelStructure& model) {
  ModelStructure base = model;
  base.columns.resize(model.output_column() + 1);
  for (auto& shapes : base.effect_shapes) shapes.clear();
  return base;
}

std::vector<StrokeStretches> WithDerivedChannels(const ModelStructure& model,
                                                 std::span<const StrokeStretches> strokes) {
  std::vector<StrokeStretches> derived(strokes.begin(), strokes.end());
  for (StrokeStretches& stroke : derived)
    for (Stretch& stretch : stroke) {
      model.derive_channels(stretch);
      stretch.derived = true;
    }
  return derived;
}

const Stretch& Derived(const ModelStructure& model, const Stretch& kept, Stretch& work) {
  if (kept.derived) return kept;
  work = kept;
  model.derive_channels(work);
  return work;
}

std::vector<StrokeGram> GramsOf(std::shared_ptr<const ModelStructure> model,
                                std::span<const StrokeStretches> strokes, const WindowSamples& window) {
  SpanEquationBuilder builder(model, window);
  StrokeAccumulator accumulator(model->column_count());
  return FormGrams(
      *model, strokes, builder, [&](const SpanEquations& span) { accumulator.Add(span); },
      [&] { return accumulator.Take(); });
}

GrowingGrams::GrowingGrams(std::shared_ptr<const ModelStructure> first,
                           std::span<const StrokeStretches> strokes, const WindowSamples& window)
    : strokes_(strokes), window_(window), known_(first->column_count()) {
  SpanEquationBuilder builder(first, window);
  StrokeAccumulator accumulator(known_);
  std::size_t numbers = 0;
  const auto add = [&](const SpanEquations& span) {
    accumulator.Add(span);
    if (numbers > kMostKept) return;
    spans_.push_back(WhatIsKnownOf(span));
    numbers += NumbersOf(spans_.back());
  };
  grams_ = FormGrams(*first, strokes, builder, add, [&] { return accumulator.Take(); });
  if (numbers > kMostKept) spans_.clear();
}

std::vector<StrokeGram> GrowingGrams::Of(std::shared_ptr<const ModelStructure> model) const {
  if (model->column_count() == known_) return grams_;
  if (spans_.empty()) return GramsOf(model, strokes_, window_);
  SpanEquationBuilder builder(model, window_, known_);
  StrokeAccumulator accumulator(known_, model->column_count() - known_);
  auto known = spans_.begin();
  auto gram = grams_.begin();
  return FormGrams(
      *model, strokes_, builder, [&](const SpanEquations& span) { accumulator.Add(*known++, span); },
      [&] { return accumulator.Take(*gram++); });
}

}  // namespace hydroscope
