#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/records/stroke_record.h"
#include "core/result.h"
#include "models/machine.h"
#include "models/machine_words.h"
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
  /// Integral over time of a flow so large that its sensor noise, integrated to a random walk, counts: that through the
  /// valve. Leaks are small; a volume (a function of the signals themselves) has white noise.
  bool walks = false;
};

/// What the weights of a composite effect may depend on: the base regression parameters (SI, in the order of
/// ModelStructure::parameters) and the present estimate of the effect's own linear parameter (0 at first).
struct ShapeContext {
  Eigen::VectorXd theta;
  double size = 0.0;
};

/// An effect that acts on signals (Effect::correct), at a value of its nonlinear parameter: what else acts, acts on the
/// signals as it corrects them.
struct Correction {
  int effect = 0;    ///< index into ModelStructure::effects
  double value = 0;  ///< SI
  bool operator==(const Correction&) const = default;
};

/// One way an effect of the library looks in the columns: regressor = sum_j weight_j * column_j.
struct EffectShape {
  std::vector<int> columns;
  std::function<std::vector<double>(const ShapeContext&)> weights;
  std::vector<double> nonlinear;  ///< values of the effect's nonlinear parameters, SI
  std::optional<Correction>
      on;                ///< its columns are of signals corrected so: for models that have that effect too
  bool refined = false;  ///< values found on the samples, not of the grid
};

/// A physical parameter computed from the regression parameters, with its gradient for the propagated interval.
struct DerivedParameter {
  std::string name;
  std::string unit;  ///< SI
  double value = 0.0;
  Eigen::VectorXd gradient;   ///< d value / d theta, SI
  bool admissible = true;     ///< sign and size that physics allows
  double geometry_std = 0.0;  ///< standard uncertainty from the machine file's geometry alone

  /// A std beyond which the value says nothing useful about the parameter.
  double useful_std() const { return unit == "1" ? 0.05 : 0.3 * std::abs(value); }
};

struct MachineKind;

/// A measured channel that the balance can give by itself, from its first value on.
struct FreeRunChannel {
  int channel = 0;
  std::string_view si;           ///< its unit
  std::string called;            ///< "pressure"
  std::vector<int> as_measured;  ///< derived channels that stay those of the measurement
  double step = 0;               ///< SI, over which the slope of the balance is taken
  double closed = 0;             ///< SI, change below which the value is found
};

/// The balance as a paper published it, point by point from filtered channels.
struct PublishedForm {
  std::vector<int> channels;            ///< to be filtered
  std::vector<double> regressor_scale;  ///< SI sizes that bring regressors ...
  double output_scale = 1;              ///< ... and output to order one
  /// Regressors, then the output, SI, from values and rates of the channels.
  std::function<void(std::span<const double> value, std::span<const double> rate, std::span<double> balance)>
      at;
};

/// The model of a machine, linear in its regression parameters:
///   output = sum_i theta_i base_i + (effects).
/// Columns are stacked base first, then the output, then the library of effects that may be missing.
struct ModelStructure {
  std::string name;
  const MachineKind* kind = nullptr;  ///< never nullptr in a model that BuildModel gave
  MachineWords words;                 ///< how people call the things of the machine
  std::vector<Column> columns;
  int base_count = 0;  ///< base columns 0 ... base_count - 1; the output is column base_count
  std::vector<std::string> parameters;     ///< names of the base regression parameters
  std::vector<std::string> channel_names;  ///< channels of Stretch, measured ones first
  std::vector<int>
      channel_source;  ///< machine signal index of each measured channel, -1 = not measured; or kDerivedChannel
  std::vector<std::shared_ptr<const Effect>> effects;   ///< library effects whose columns are in `columns`
  std::vector<std::vector<EffectShape>> effect_shapes;  ///< shapes of each of `effects`
  std::vector<std::shared_ptr<const Effect>> sample_effects;  ///< Effect::needs_samples: see AddSampleEffects
  std::vector<std::shared_ptr<const Effect>> generic_laws;    ///< Effect::generic: see AddGenericLaws
  std::string output_unit;                                    ///< SI unit of the flow form, "m3/s"
  /// The balance has no derivative with respect to time: columns fill values (one per sample) in place of increments,
  /// and equations are block means without an intercept.
  bool level_form = false;

  /// A channel that maps of the error run over.
  struct ShownChannel {
    int channel = 0;
    std::string unit;          ///< SI, "" = not known
    std::string display = {};  ///< in which it is shown; "" = the usual one of `unit`
    double factor = 1;         ///< of `display`
  };
  std::vector<ShownChannel> shown;  ///< those not measured included
  std::vector<Condition>
      conditions;                ///< ConditionsOf the machine; their signals are channels where it has them
  int temperature_channel = -1;  ///< of MachineKind::temperature, -1 = not measured
  std::optional<FreeRunChannel> free_run;  ///< nothing: the model only compares
  std::optional<PublishedForm> published;  ///< for EquationForm::kPublished

  /// Fills the derived channels of a stretch whose measured channels are there.
  std::function<void(Stretch&)> derive_channels;
  /// Standard deviation that sensor noise gives the rates of base columns and output that are integrated over time, all
  /// from one common source, at samples `first`, `first + step`, ...: a column of `rate_noise` each, which comes in as
  /// zeros. Integrated, it is a random walk.
  std::function<void(const Stretch&, int first, int step, Eigen::MatrixXd& rate_noise)> integrated_noise;
  /// The same for every column that walks, of base and effects, where single sensors are the sources: `copies`, which comes
  /// with the number of samples asked for, is filled with the samples `first`, `first + step`, ... of a stretch, all channels,
  /// and behind them, once per sensor, with the same at noise of that sensor one standard deviation up. What a column's rates
  /// differ by is its noise. Where it is there, it stands in for `integrated_noise`.
  std::function<void(const Stretch&, int first, int step, Stretch& copies)> disturb;
  /// Physical parameters of a regression result; all of them, admissible or not.
  std::function<std::vector<DerivedParameter>(const Eigen::VectorXd& theta)> derive;

  int output_column() const { return base_count; }
  /// Entries of a fit's parameters, those of the base first, then one per effect of `added`, whose regressors walk.
  std::vector<int> WalkingParameters(const std::vector<int>& added = {}) const;
  int column_count() const { return static_cast<int>(columns.size()); }
  /// Machine signals the base model reads; a bad value in one of them ends a window.
  std::vector<int> needed_signals;
  std::vector<std::string> ColumnNames() const;
  std::vector<ConditionName> ConditionNames() const;
  /// Measured channel of that name, -1 if there is none.
  int MeasuredChannel(std::string_view channel) const;
};

/// Builds the structure a machine file describes. Errors: a signal or geometry the model needs is missing.
Result<std::shared_ptr<const ModelStructure>> BuildModel(const Machine& machine);

}  // namespace hydroscope
