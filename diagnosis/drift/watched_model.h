#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/records/stroke_record.h"
#include "core/told.h"
#include "estimation/gram_fit.h"
#include "models/model_structure.h"
#include "models/oil_law.h"

namespace hydroscope::drift {

/// A quantity that is watched: a physical parameter of the model or the size of an effect that is absent when healthy.
struct Quantity {
  std::string name;  ///< "K", "V0", "Q_vn", "y_0", "internal_leakage"
  std::string unit;  ///< SI
  OilLaw over_oil = OilLaw::kSmooth;
  bool effect = false;  ///< reference is zero
  bool share = false;  ///< of a whole, as a spool position is of its stroke: changes are told in its per cent
  Told title = {};     ///< of an effect: what people call it
  bool relative = true;  ///< changes are told in per cent of the value (ToldInPercent)
};

/// What one stroke says, apart from all others: its own normal equations over the watched columns, sensor
/// noise taken out. Unlike the recursive estimate it shares no data with the strokes before, so deviations of
/// strokes are independent.
struct StrokeEvidence {
  std::int64_t sequence = 0;                        ///< machine-wide stroke number
  double time = 0;                                  ///< s, end of the stroke
  double oil_temperature = 0;                       ///< K, NaN if not measured
  std::array<double, kMaxConditions> conditions{};  ///< of StrokeSummary
  NormalEquations equations;
};

/// Deviation of a stroke from a reference, linearised there: the gradient of the log-likelihood and its
/// information, in units of the equations' noise variance. Alone, quantity j deviates by score[j] / information(j, j).
struct Score {
  Eigen::VectorXd score;
  Eigen::MatrixXd information;
};

/// The watched quantities of a model with the map between them and the regression parameters.
class WatchedModel {
 public:
  /// Parameters of the model (of more than it has regressors the first that are independent: the others follow from them),
  /// then those of `effects` (ids) that its Gram carries and that have no nonlinear parameter.
  static Result<WatchedModel> Create(std::shared_ptr<const ModelStructure> model,
                                     const std::vector<std::string>& effects);

  const std::vector<Quantity>& quantities() const { return quantities_; }
  int size() const { return static_cast<int>(quantities_.size()); }
  int base_count() const { return model_->base_count; }
  const MachineKind& kind() const { return *model_->kind; }
  const std::vector<Condition>& conditions() const { return model_->conditions; }
  /// Gram columns in the order of the quantities' regression parameters.
  const std::vector<int>& columns() const { return columns_; }

  StrokeEvidence Evidence(const StrokeRecord& record, std::int64_t sequence) const;
  /// Quantities of the base model fitted to these equations, effects zero; empty if they are not independent.
  Eigen::VectorXd Solve(const NormalEquations& equations) const;
  /// Regression parameters of these quantities, by Newton's method; empty if there are none near.
  Eigen::VectorXd Theta(const Eigen::VectorXd& quantities, const Eigen::VectorXd& start) const;
  Eigen::VectorXd Values(const Eigen::VectorXd& theta) const;
  Score Deviation(const NormalEquations& equations, const Eigen::VectorXd& theta) const;
  /// d theta / d quantities.
  Eigen::MatrixXd Jacobian(const Eigen::VectorXd& theta) const;

 private:
  Eigen::VectorXd SolveBase(const NormalEquations& equations) const;
  std::shared_ptr<const ModelStructure> model_;
  std::vector<Quantity> quantities_;
  /// Parameters of the model that are watched: as many as there are regressors.
  std::vector<std::size_t> picked_;
  std::vector<int> columns_;
};

}  // namespace hydroscope::drift
