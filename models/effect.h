#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/told.h"
#include "models/machine.h"
#include "models/model_structure.h"

namespace hydroscope {

/// A number of the effect that does not enter linearly: threshold, dead band, exponent, width.
struct NonlinearParameter {
  std::string name;
  std::string unit;         ///< SI
  double min = 0, max = 0;  ///< SI, admissible
  /// SI, standard deviation of what is known beforehand, about the middle of min ... max: for numbers that no data sheet
  /// gives and that data may not show (a polytropic exponent). 0: nothing is known but the limits.
  double std = 0;
};

/// A number of a law that is taken as given though nobody knows it well: the size's interval holds its share.
struct UncertainConstant {
  std::string name;
  std::string unit;           ///< SI
  double value = 0, std = 0;  ///< SI
};

/// The effect at given values of its nonlinear parameters: its regressor is sum_j weight_j * column_j, with weights that
/// may depend on the base parameters.
struct EffectVariant {
  std::vector<Column::Fill> columns;
  std::function<std::vector<double>(const ShapeContext&)> weights;  ///< one per column
};
/// The common case: one column with weight 1.
EffectVariant PlainVariant(Column::Fill column);

/// A physical effect that the base model may be missing. One law, one file in machines/<kind>/effects/. Of a balance it is
/// columns (`variant`), of a model with states texts that are added to its equations (`adds`).
struct Effect {
  std::string id;           ///< fixed, see docs/effects.md
  std::string title;        ///< "Internal leakage past the piston seal"
  std::string law;          ///< formula
  std::string source;       ///< author, year, equation
  std::string parameter;    ///< name of the linear parameter
  std::string unit;         ///< its SI unit
  double min = 0, max = 0;  ///< admissible range of the linear parameter, SI
  double typical = 0;       ///< a size that is worth knowing about
  std::vector<NonlinearParameter> nonlinear;
  std::vector<UncertainConstant>
      constants;  ///< `variant` takes other values of them after those of `nonlinear`
  std::string
      edition;  ///< ends the columns' names: columns stored under an older form of the law are told apart
  /// A law with one parameter that enters in both ways: the value of nonlinear[0] that base parameters and size imply.
  /// Empty: the nonlinear parameters are free.
  std::function<double(const ShapeContext&)> implied;
  /// Acts on signals, sensors' or the edge's: takes the effect at `value` of nonlinear[0] out of those of a stretch, derived
  /// channels included, so that the base balance of what is left is base and effect of what was measured. `state` as in
  /// Column::Fill. Empty: it acts on no signal.
  std::function<void(double value, double& state, Stretch&)> correct;
  std::vector<std::string> confused_with;  ///< ids of effects with a similar signature
  /// An effect that is the same to first order: what tells the two apart is as small as the errors of their columns.
  struct Twin {
    std::string id;
    double share = 0.9;  ///< stays beside the better one while it gains this share of what that does ...
    /// Share of its gain that the law needs its twin to reach: of one that only smooths noise the twin explains nothing.
    double least = 0;
    double excess = 0.2;  ///< ... and leaves no more of the noise energy beyond what that leaves
  };
  std::vector<Twin> twins;  ///< told by one of the two
  /// Of a signal that is late: up to so many rows it may be how the signal moves between two rows, unseen.
  double unseen_rows = 0;
  std::string hidden_in;  ///< base parameters that swallow it when it is not modelled
  std::string plain;      ///< one sentence for the maintenance engineer: what it is, what to look for
  /// What tells it from effects that no stroke can tell it from: "relieve the cushion and read the sensor". Empty: strokes
  /// can, see ProposeExperiment.
  std::string told_apart_by;
  /// title, plain and told_apart_by as the page says them in German; of users' own a title as far as the machine file has one.
  struct German {
    std::string title, plain, told_apart_by = {};
  };
  German german;
  /// Strokes that show it where those at hand do not: "strokes with cold and with warm oil". Empty: any.
  Told shown_by;
  /// Strokes that tell it from another effect; said by one of the two.
  struct Separation {
    std::string id;  ///< of the other one
    Told strokes;    ///< that vary only what the two laws differ in
  };
  std::vector<Separation> separations;
  /// A test off the log that gives its size, to be told to `explain --measured`: "the reading of the pressure sensor with its
  /// line vented". Empty: there is none.
  Told measured_by;
  /// What is wrong wherever a law of its kind is at work, though not quite this law: "oil is lost".
  Told family;
  /// Where it is at work with these values of `nonlinear`, "above 170 bar"; empty: nowhere in particular.
  std::function<Told(const std::vector<double>& nonlinear)> where;
  /// What it lets move over time, "K" or "the zero of the sensor": its size is then a rate, of `drifts_by` (SI) per second,
  /// or relative if that is "". Empty: nothing.
  Told drifting;
  std::string drifts_by;
  /// What a law of a machine file is a function of: signals and rates as they stand there.
  std::vector<std::string> reads;
  std::vector<int> channels;  ///< DieCushionChannel needed beyond the base model's
  bool walks = false;         ///< Column::walks of its columns
  /// Of a model with states: a state or an output (TermSpec::parameter) and what is added to its equation, over what the
  /// model's equations may name and `parameters`, which are sought within their ranges. SI.
  std::vector<TermSpec> adds;
  std::vector<ParameterSpec> parameters;
  /// The effect at values of `nonlinear`, in their order.
  std::function<EffectVariant(const std::vector<double>& nonlinear)> variant;
  /// Values whose columns every stroke's Gram carries; one empty vector if nothing is nonlinear.
  std::vector<std::vector<double>> grid = {{}};
  /// A law without a name, one of the first powers and products of the signals. It never becomes a verdict; it tells
  /// whether a named effect has left something, and whether a law that nobody thought of would do as well.
  bool generic = false;
  std::string
      late_signal;  ///< generic: the signal whose rate it is, as one leaves that comes late or through a filter
  bool plain_flow = false;  ///< generic, and a flow that goes with a signal, like a leak
  /// Its columns are in no stored Gram: it is tried where samples are at hand (AddSampleEffects).
  bool needs_samples = false;
  /// Its law lives on a signal that must move: below this span over the strokes, in SI of the channel, even a size of several
  /// times the typical one would change less than what drifts by itself. Such strokes cannot test it.
  struct LeastSpan {
    int channel = 0;
    double span = 0;
    Told name = {};         ///< for messages: "the oil"
    std::string unit = {};  ///< SI, "K"
  };
  std::optional<LeastSpan> least_span;
};

/// Appends the effect's columns at these nonlinear values to the model as one more shape of effect `index`, if asked for on
/// the signals as another effect corrects them. Returns the shape's index.
int AddShape(ModelStructure& model, int index, const std::vector<double>& nonlinear,
             const std::optional<Correction>& on = {});

/// Appends every effect whose channels the machine measures, with the shapes of its grid.
void AddLibrary(std::vector<std::shared_ptr<const Effect>> effects, ModelStructure& model);

/// Appends ModelStructure::generic_laws.
void AddGenericLaws(ModelStructure& model);

/// Appends the effects of ModelStructure::sample_effects that the model does not have yet, with the shapes of their grids.
/// Only those of `ids`, if it is not empty.
void AddSampleEffects(ModelStructure& model, const std::vector<std::string>& ids = {});

}  // namespace hydroscope
