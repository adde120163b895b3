#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "models/expressions/evaluator.h"
#include "models/model_structure.h"

namespace hydroscope {

/// One part of an expression as a Stieltjes integral: weight d(level), or weight dt without a level. No weight is 1.
/// Neither contains ddt: where a rate is needed as a value, it is the name of a channel of rates.
struct ExpressionPart {
  Expression weight, level;
};

/// Channels of a model that expressions read: measured signals and the windowed rates ddt(...) they ask for.
class ExpressionChannels {
 public:
  /// Adds to `model.channel_names`; `half_width` in s is the window of ddt. `model` must outlive this builder.
  ExpressionChannels(ModelStructure& model, double half_width) : model_(model), half_width_(half_width) {}

  /// The expression with every ddt(...) replaced by the name of its channel, which is added if new.
  Expression Windowed(const Expression& expression);
  /// The expression as a sum of parts in which a ddt that enters linearly is a level: its integral is a
  /// difference, and no sample is ever differenced.
  std::vector<ExpressionPart> Parts(const Expression& expression);
  /// Channel of each name, for evaluators.
  std::map<std::string, int> Indices() const;
  /// Fills the channels of rates, in the order in which they depend on each other. Valid when the builder is gone.
  std::function<void(Stretch&)> Derivation() const;

 private:
  struct Rate {
    int inner = -1, channel = -1;
    std::shared_ptr<const ExpressionEvaluator> evaluator;  ///< of the inner channel; none if that is measured
  };
  int AddChannel(const std::string& name);

  ModelStructure& model_;
  double half_width_;
  std::map<std::string, int> rate_channel_;  ///< canonical text of ddt(...) -> channel
  std::vector<Rate> rates_;
};

/// Whether some ddt enters linearly, so that the balance has to be integrated.
bool HasLevel(const std::vector<ExpressionPart>& parts);

/// Parts ready to be computed.
class ExpressionParts {
 public:
  ExpressionParts(const std::vector<ExpressionPart>& parts, const std::map<std::string, int>& channel_of);
  /// Increments between samples (samples - 1 of them), as Column::Fill gives them in the integral form.
  void Increments(const Stretch& stretch, std::span<double> increments) const;
  /// Values at the samples: the level form, where no part has a level.
  void Values(const Stretch& stretch, std::span<double> values) const;
  /// Half the sum of samples -2 ... 1 around `sample` with signs + - - +, over the parts that are integrated
  /// over time: sees neither level nor slope, and white noise of one sample with its standard deviation.
  double Contrast(const Stretch& stretch, int sample) const;

 private:
  struct Compiled {
    std::unique_ptr<const ExpressionEvaluator> weight, level;
  };
  std::vector<Compiled> parts_;
};

/// A column of the balance from parts.
Column::Fill FillOf(std::shared_ptr<const ExpressionParts> parts, bool level_form);

}  // namespace hydroscope
