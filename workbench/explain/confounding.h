#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/records/estimate.h"
#include "core/records/stroke_gram.h"
#include "estimation/span_equations.h"
#include "models/model_structure.h"
#include "workbench/condition_ranges.h"

namespace hydroscope {

/// A parameter whose value rests on the absence of effects that these strokes could not show.
struct Confounding {
  std::string parameter;
  std::string effect;                ///< id of the one that would move it most
  std::vector<std::string> effects;  ///< all of them, that one first
  double bias = 0;                   ///< SI, by which `effect` of typical size moves the parameter
  Told reason;                       ///< "confounded with internal_leakage: ...", what it would do
  Told advice;                       ///< what to record
};

/// Of the base of `model` with the effects `added` (ids), fitted to strokes; at most 400 of them are looked at, evenly
/// spread. `ranges` are those of their conditions, `parameters` what the fit gave. See diagnosis/hidden_bias.h.
std::vector<Confounding> ConfoundingsOf(const std::vector<std::string>& added,
                                        std::shared_ptr<const ModelStructure> model,
                                        std::span<const StrokeGram> grams, const WindowSamples& window,
                                        std::span<const ConditionRange> ranges,
                                        std::span<const Estimate> parameters);

/// Takes the trust from the parameters concerned: EstimateReason::kConfounded.
void MarkConfounded(const std::vector<Confounding>& confounded, std::span<Estimate> parameters);

/// "K, Q_vn: confounded with internal_leakage, external_leakage"; "" of none.
std::string ConfoundedNames(const std::vector<Confounding>& confounded);

/// That of a parameter, nullptr if there is none.
const Confounding* FindConfounding(const std::vector<Confounding>& confounded, const std::string& parameter);

}  // namespace hydroscope
