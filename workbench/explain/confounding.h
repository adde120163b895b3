#pragma once

#include <span>
#include <string>
#include <vector>

#include "estimation/gram_fit.h"
#include "models/machine.h"
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

/// Of the model of `machine` (base and added effects) fitted to strokes; at most 400 of them are
/// looked at, evenly spread. `ranges` are those of their conditions. See diagnosis/hidden_bias.h.
std::vector<Confounding> ConfoundingsOf(const Machine& machine, std::shared_ptr<const ModelStructure> model,
                                        std::span<const StrokeGram> grams, const WindowSamples& window,
                                        std::span<const ConditionRange> ranges, const GramFit& figures);

/// Takes the trust from the parameters concerned: EstimateReason::kConfounded.
void MarkConfounded(const std::vector<Confounding>& confounded, GramFit& figures);

/// That of a parameter, nullptr if there is none.
const Confounding* FindConfounding(const std::vector<Confounding>& confounded, const std::string& parameter);

}  // namespace hydroscope
