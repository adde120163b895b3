#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/records/stroke_gram.h"
#include "estimation/span_equations.h"
#include "models/stretch.h"

namespace hydroscope {

/// The model with its base and output columns alone, and no shapes of its effects.
ModelStructure BaseOnly(const ModelStructure& model);

/// The strokes with their derived channels filled (Stretch::derived), for Grams that are formed again and again.
std::vector<StrokeStretches> WithDerivedChannels(const ModelStructure& model,
                                                 std::span<const StrokeStretches> strokes);

/// `kept` with its derived channels filled: itself if they are, else in `work`.
const Stretch& Derived(const ModelStructure& model, const Stretch& kept, Stretch& work);

/// Grams of kept samples under any model over the same channels.
std::vector<StrokeGram> GramsOf(std::shared_ptr<const ModelStructure> model,
                                std::span<const StrokeStretches> strokes, const WindowSamples& window);

/// The same under models that begin with the columns of a first one, of which equations and products are formed once. Equal to those
/// of GramsOf to the bit.
class GrowingGrams {
 public:
  /// `strokes` must outlive it.
  GrowingGrams(std::shared_ptr<const ModelStructure> first, std::span<const StrokeStretches> strokes,
               const WindowSamples& window);

  /// Of a model with the columns of the first one and further ones behind them.
  std::vector<StrokeGram> Of(std::shared_ptr<const ModelStructure> model) const;

 private:
  std::span<const StrokeStretches> strokes_;
  WindowSamples window_;
  int known_;
  std::vector<StrokeGram> grams_;  ///< of the columns known
  std::vector<SpanEquations>
      spans_;  ///< of each stretch in turn; none: they would have taken too much memory
};

}  // namespace hydroscope
