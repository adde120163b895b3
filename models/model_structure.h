#pragma once

#include <Eigen/Dense>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/records.h"
#include "core/result.h"
#include "models/machine.h"
#include "models/stretch.h"

namespace hydroscope {

struct Effect;

/// Entry of ModelStructure::channel_source for a channel that the model derives.
inline constexpr int kDerivedChannel = -2;

/// One column of the stacked balance: fills `increments` (samples - 1 entries, output unit per unit parameter, times s).
/// `state` is one number the column may keep from stretch to stretch (play of a hysteresis); 0 at the start.
struct Column {
  using Fill = std::function<void(const Stretch&, double& state, std::span<double> increments)>;
  std::string name;
  Fill fill;
};

/// What the weights of a composite effect may depend on: the base regression parameters (SI, in the order of
/// ModelStructure::parameters) and the present estimate of the effect's own linear parameter (0 at first).
struct ShapeContext {
  Eigen::VectorXd theta;
  double size = 0.0;
};

/// One way an effect of the library looks in the columns: regressor = sum_j weight_j * column_j.
struct EffectShape {
  std::vector<int> columns;
  std::function<std::vector<double>(const ShapeContext&)> weights;
  std::vector<double> nonlinear;  ///< values of the effect's nonlinear parameters, SI
  bool refined = false;           ///< values found on the samples, not of the grid
};

/// A physical parameter computed from the regression parameters, with its gradient for the propagated interval.
struct DerivedParameter {
  std::string name;
  std::string unit;  ///< SI
  double value = 0.0;
  Eigen::VectorXd gradient;  ///< d value / d theta, SI
  bool admissible = true;    ///< sign and size that physics allows
  double geometry_std = 0.0; ///< standard uncertainty from the machine file's geometry alone
};

/// The model of a machine, linear in its regression parameters:
///   output = sum_i theta_i base_i + (effects).
/// Columns are stacked base first, then the output, then the library of effects that may be missing.
struct ModelStructure {
  std::string name;
  std::vector<Column> columns;
  int base_count = 0;                     ///< base columns 0 ... base_count - 1; the output is column base_count
  std::vector<std::string> parameters;    ///< names of the base regression parameters
  std::vector<std::string> channel_names; ///< channels of Stretch, measured ones first
  std::vector<int> channel_source;        ///< machine signal index of each measured channel, -1 = not measured; or kDerivedChannel
  std::vector<std::shared_ptr<const Effect>> effects;  ///< library effects whose columns are in `columns`
  std::vector<std::vector<EffectShape>> effect_shapes;     ///< shapes of each of `effects`
  double piston_area = 0.0;               ///< m^2, die cushion
  std::string output_unit;                ///< SI unit of the flow form, "m3/s"
  /// The balance has no derivative with respect to time: columns fill values (one per sample) in place of increments,
  /// and equations are block means without an intercept.
  bool level_form = false;
  bool output_integrated = false;         ///< `integrated_noise` speaks of the output column too

  /// A channel that maps of the error run over: where the built-in list of the die cushion does not apply.
  struct ShownChannel {
    int channel = 0;
    std::string unit;  ///< SI, "" = not known
  };
  std::vector<ShownChannel> shown;

  /// Fills the derived channels of a stretch whose measured channels are there.
  std::function<void(Stretch&)> derive_channels;
  /// Standard deviation that sensor noise gives the rates of the base columns that are integrated over time, all from
  /// one common source, at samples `first`, `first + step`, ...: a column of `rate_noise` each, which comes in as
  /// zeros. Integrated, it is a random walk.
  std::function<void(const Stretch&, int first, int step, Eigen::MatrixXd& rate_noise)> integrated_noise;
  /// Base columns whose sensor noise is nearly all of that kind; the noise floor counts it as a walk.
  std::vector<int> walk_columns;
  /// Physical parameters of a regression result; all of them, admissible or not.
  std::function<std::vector<DerivedParameter>(const Eigen::VectorXd& theta)> derive;

  int output_column() const { return base_count; }
  /// Columns that `integrated_noise` fills, the first ones.
  int integrated_columns() const { return output_integrated ? base_count + 1 : base_count; }
  int column_count() const { return static_cast<int>(columns.size()); }
  /// Machine signals the base model reads; a bad value in one of them ends a window.
  std::vector<int> needed_signals;
  std::vector<std::string> ColumnNames() const;
};

/// Builds the structure a machine file describes. Errors: a signal or geometry the model needs is missing.
Result<std::shared_ptr<const ModelStructure>> BuildModel(const Machine& machine);

}  // namespace hydroscope
