#pragma once

#include <string>

#include "core/records/alarm_records.h"
#include "diagnosis/explain.h"
#include "estimation/gram_fit.h"
#include "models/counted_words.h"

namespace hydroscope {

/// What the figures of a model (rms over all strokes, output unit) allow to say.
enum class ModelStanding {
  kDescribes,      ///< nothing but sensor noise is left
  kDescribesSome,  ///< ... but for strokes that differ from the rest and are left out
  kMisses,         ///< more than sensor noise is left
  kNotJudged,      ///< the figures contradict themselves or carry no judgement
};

/// What a command found beyond the noise of the sensors.
enum class ErrorFinding {
  kNoise,       ///< nothing
  kMore,        ///< something
  kMayBeNoise,  ///< an error that nothing predicts (Explanation::may_be_noise)
};
inline constexpr Wording kNothingPredicts = {
    "the error is more than the noise that rows show, and nothing predicts it",
    "der Fehler ist mehr als das Rauschen, das Zeilen zeigen, und nichts sagt ihn vorher"};
/// What such an error may be, and how to tell; sentences.
std::string WhatItMayBe(const CountedWords& counted);

struct ModelHeadline {
  ModelStanding standing = ModelStanding::kNotJudged;
  std::string text;  ///< one sentence
};

/// How far an explanation carries the cause, as alarms tell it; kNotSought where nothing is missing.
CauseKind CauseKindOf(const Explanation& explanation);

/// Whether a swap is what an explanation says first: it explains what the model as it is leaves.
bool SwapLeads(const Explanation& explanation);
/// What an effect that the model has and need not have comes to, a clause without a full stop: "the model has external_leakage, and
/// internal_leakage in its place does better".
Told SwapTold(const EffectSwap& swap);

/// What is impossible about the figures of a fit, as a sentence, or "": no numbers, an output or a model that
/// is 0 throughout, an error above the output itself, noise above the output, an error on strokes left out
/// that is kUnstable times that on the strokes of the fit.
Told ImpossibleFigures(const GramFit& figures);

/// Strokes that a verdict left out of `strokes`.
struct LeftOut {
  std::size_t strokes = 0, odd = 0;
  Told which;  ///< WhichDiffer

  std::size_t described() const { return strokes - odd; }
};

/// Every sentence in which a command says how well a model describes its strokes comes from here: `found` is
/// the command's own of all strokes but those left out, which only possible figures can carry, and no strokes that carry no
/// verdict (`no_verdict` says why, "" = they do).
ModelHeadline HeadlineOf(const GramFit& figures, ErrorFinding found, const Told& no_verdict = {},
                         const CountedWords& counted = {}, const LeftOut& left_out = {});

}  // namespace hydroscope
