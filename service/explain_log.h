#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/explain.h"
#include "diagnosis/locate.h"
#include "service/batch_fit.h"

namespace hydroscope {

/// An effect of the library that needs a signal the machine does not measure.
struct UnmeasuredEffect {
  std::shared_ptr<const Effect> effect;
  std::vector<std::string> missing;  ///< signals it needs
};

/// "signal p_B is not in the machine file".
std::string WhyUnmeasured(const UnmeasuredEffect& unmeasured);

/// Everything `hydroscope explain` knows of one log.
struct ExplainResult {
  std::string machine_file;
  LogStrokes log;
  std::size_t strokes = 0;  ///< strokes explained: those whose samples were kept
  GramFit base;             ///< the model as it is, of the same strokes; `theta` holds its effects' sizes too
  Explanation explanation;
  std::vector<UnmeasuredEffect> unmeasured;
  ErrorLocation location;  ///< of the error of the model as it is

  const Effect& effect(int index) const { return *log.model->effects[static_cast<std::size_t>(index)]; }
  /// Nonlinear parameters of an effect of the explanation, SI.
  const std::vector<double>& NonlinearOf(const EffectChoice& choice) const {
    return explanation.model->effect_shapes[choice.effect][choice.shape].nonlinear;
  }
};

/// Strokes below which held-out errors and intervals clustered by stroke say nothing.
inline constexpr std::size_t kMinExplainStrokes = 4;

/// Reads the log, fits the model of the machine file (base balance and the effects added to it) and finds what it
/// misses. Errors: log or machine file are wrong, fewer than kMinExplainStrokes strokes, or strokes that do not excite
/// the model. ExplainOptions::start is taken from the machine file.
Result<ExplainResult> ExplainLog(const std::string& log, const std::string& machine_file,
                                 const ExplainOptions& options = {});

/// The same for strokes already read with their samples; ExplainResult::machine_file stays empty.
Result<ExplainResult> ExplainStrokes(LogStrokes strokes, const ExplainOptions& options = {});

/// Physical base parameters of an extended fit, SI, as FitBaseModel gives them for the base model.
std::vector<Estimate> BaseParameters(const ModelStructure& model, const ExtendedFit& fit, int strokes);

}  // namespace hydroscope
