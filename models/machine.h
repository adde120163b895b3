#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "models/condition.h"
#include "models/live_spec.h"
#include "models/model_history.h"
#include "models/part_settings.h"
#include "models/states_spec.h"

namespace hydroscope {

/// One signal of the machine: where it comes from and how it becomes SI.
/// SI value = (raw * scale + offset) converted from `unit`.
struct SignalSpec {
  std::string name;    ///< the model's name: p_A, p_B, p_0, z, y_v, U_v, T_oil, or the user's own
  std::string column;  ///< column header in the log, or 1-based number ("3") for logs without header
  std::string unit = "1";
  double scale = 1.0;
  double offset = 0.0;
  std::optional<double> min, max;   ///< SI; values outside are flagged out of range
  std::optional<double> noise_std;  ///< SI; known sensor noise; estimated from the data if absent
  double stuck_time = 0.1;          ///< s; the very same reading for longer is flagged stuck; 0 = never
  bool required = true;  ///< a log without the column is an error (true) or the signal is missing (false)
  std::optional<PartSettings> origin;  ///< where it comes from live; absent: only from logs

  /// Where it comes from, if that is a place of this kind (acquisition/<source>/settings.h); else nullptr.
  template <typename Origin>
  const Origin* From() const {
    return origin ? origin->As<Origin>() : nullptr;
  }
  bool operator==(const SignalSpec&) const = default;
};

/// A number the machine file gives with its standard uncertainty, SI.
struct KnownValue {
  double value = 0.0;
  double std = 0.0;
  std::string unit = {};  ///< SI unit, where the file says it; "" = that of the built-in model, or not known

  bool operator==(const KnownValue&) const = default;
};

/// What a signal does between two rows.
enum class InputHold { kZero, kLinear, kSmooth };
/// As machine files name them.
inline constexpr std::array<const char*, 3> kInputHoldNames = {"zero", "linear", "smooth"};

/// How a text log is laid out; what is absent is found by looking at the file.
struct LogFormat {
  std::optional<char> separator;  ///< ',' ';' '\t' ' '
  std::optional<char> decimal;    ///< '.' or ','
  std::optional<int> skip_lines;  ///< lines before the header row
  std::optional<bool> header;     ///< false: columns are named by number
  std::optional<bool> unit_row;   ///< a row of units follows the header
  std::string time_column = "t";  ///< "" = no time column: rows are `sample_period` apart
  std::string time_unit = "s";
  std::optional<double> sample_period;  ///< s; found from the time column if absent
  InputHold hold = InputHold::kLinear;  ///< models with states are integrated between rows
  /// s by which the outputs of a row are older than its inputs (below 0: newer), of models with states; found if absent.
  std::optional<double> outputs_late;

  bool operator==(const LogFormat&) const = default;
};

/// Bounds on one signal (block mean, SI) or on its rate of change, for the gate.
struct GateBound {
  std::string signal;              ///< signal name
  bool rate = false;               ///< true: bounds are on d/dt (written as "ddt(z)" in the file)
  std::optional<double> min, max;  ///< SI
  bool magnitude = false;          ///< true: bounds are on the absolute value ("abs(z)", "abs(ddt(z))")

  bool operator==(const GateBound&) const = default;
};

struct GateSpec {
  std::vector<GateBound> bounds;  ///< all must hold
  double stroke_gap = 0.25;       ///< s outside the gate that end a stroke
  double min_stroke = 0.3;        ///< s inside the gate below which a stroke is too short
  double max_stroke = 0;          ///< s after which a stroke ends and the next begins; 0 = never

  bool operator==(const GateSpec&) const = default;
};

struct WindowSpec {
  double block = 0.02;       ///< s averaged into one equation
  double span = 0.56;        ///< s that share one intercept (integration constant)
  double half_width = 0.04;  ///< s, half width of the triangular window of flows and of the gate's rates

  bool operator==(const WindowSpec&) const = default;
};

enum class EstimatorForm { kDirectional, kExponential };
enum class EquationForm { kIntegral, kPublished };

struct EstimatorSpec {
  EquationForm equation = EquationForm::kIntegral;
  EstimatorForm form = EstimatorForm::kDirectional;
  double forgetting_factor = 0.998;              ///< exponential form, per update
  double time_constant = 60.0;                   ///< s of excited data, directional form
  std::map<std::string, double> time_constants;  ///< s, per regression parameter, overrides `time_constant`
  double initial_covariance = 500.0;             ///< alpha of P(0) = alpha I, in scaled units
  double initial_parameter = 1.0;                ///< theta(0), in scaled units (as published) ...
  bool initial_from_first_stroke = true;         ///< ... or start from the first stroke's least squares
  double max_covariance = 1e6;                   ///< bound on the eigenvalues of P, scaled units
  double dead_zone = 0.0;           ///< innovations (rms over a span) below this many noise std do not update
  double clip = 4.0;                ///< innovations beyond this many noise std are clipped; 0 = never
  int moving_average = 31;          ///< samples, published form
  int symmetrical_derivative = 25;  ///< samples, published form
  double update_period = 0.01;      ///< s, published form

  bool operator==(const EstimatorSpec&) const = default;
};

/// Limits of one monitored parameter, SI.
struct MonitorSpec {
  std::string parameter;
  std::optional<double> warn_low, warn_high, alarm_low, alarm_high;
  std::optional<double> reference;  ///< healthy value, if known

  bool operator==(const MonitorSpec&) const = default;
};

/// What `frf` needs to know of the valve.
struct ValveSpec {
  std::string input = "U_v";   ///< command signal
  std::string output = "y_v";  ///< response signal
  double full_scale = 10.0;    ///< SI of the input at full command: gain = output / (input / full_scale)

  bool operator==(const ValveSpec&) const = default;
};

/// What the machine may be asked to do to tell effects apart. What is absent stays as in the strokes recorded.
struct ExperimentSpec {
  struct Limits {
    std::optional<double> min, max;  ///< SI
    bool operator==(const Limits&) const = default;
  };
  std::map<std::string, Limits, std::less<>> settings;  ///< of those of its kind (StrokeSetting), by key
  int max_strokes = 400;                                ///< more than these nobody records
  /// Own machines: what strokes may be run at, means of signals or of their speeds.
  std::vector<GateBound> signals;

  Limits Of(std::string_view setting) const {
    const auto at = settings.find(setting);
    return at == settings.end() ? Limits{} : at->second;
  }
  bool operator==(const ExperimentSpec&) const = default;
};

/// A term the user wrote: parameter name -> expression over the machine's signals.
struct TermSpec {
  std::string parameter;
  std::string expression;
  std::string unit = {};  ///< optional

  bool operator==(const TermSpec&) const = default;
};

/// A constant of a user's effect that is found from the data, within limits (a threshold, a width).
struct ShapeSpec {
  std::string name;
  double min = 0.0, max = 0.0;  ///< SI
  std::string unit;             ///< SI, optional

  bool operator==(const ShapeSpec&) const = default;
};

/// An effect the user wrote.
struct UserEffectSpec {
  std::string id;
  std::string description;
  std::vector<TermSpec> terms;               ///< exactly one
  std::vector<ShapeSpec> shape = {};         ///< names that its expression may use beside the signals
  std::optional<double> min = {}, max = {};  ///< SI, sizes of the parameter that physics allows
  std::optional<double> typical = {};        ///< SI, a size worth knowing about
  /// Of a model with states, in place of `terms`: state or output (TermSpec::parameter) and what is added to its
  /// equation, with the effect's own parameters.
  std::vector<TermSpec> adds = {};
  std::vector<ParameterSpec> parameters = {};
  std::string german = {};  ///< the description in German

  bool operator==(const UserEffectSpec&) const = default;
};

/// The balance of a machine of the user's own; empty output = built-in balance of `model`.
struct BalanceSpec {
  std::string output;
  std::string unit;
  std::vector<TermSpec> terms;
  std::vector<TermSpec> derived = {};  ///< quantities computed from the parameters

  bool operator==(const BalanceSpec&) const = default;
};

/// One machine file (TOML). docs/machine_file.md documents every key.
struct Machine {
  std::string name;
  std::string model;  ///< id of its MachineKind; "" = the first of MachineKinds()
  std::string description;
  std::vector<SignalSpec> signals;             ///< index here = index in SampleBlock::signal
  std::map<std::string, KnownValue> geometry;  ///< A_A (m2), dp_nom (Pa), p_t (Pa), ... SI
  LogFormat log;
  GateSpec gate;
  std::string episode_marker;         ///< signal whose change begins a new stroke or episode; "" = none
  std::vector<Condition> conditions;  ///< that strokes are told apart by, beside those of its kind
  WindowSpec window;
  EstimatorSpec estimator;
  std::vector<MonitorSpec> monitors;
  ValveSpec valve;
  ExperimentSpec experiment;
  BalanceSpec balance;
  StatesSpec states;  ///< of the file, or those of its kind with the file's [parameters]
  std::vector<UserEffectSpec> user_effects;
  std::vector<std::string> added_effects;  ///< effects that are part of the model, in order of adding
  /// Nonlinear parameters (thresholds, widths, ...) of added effects, by effect and name, SI; those not given
  /// are found from the data.
  std::map<std::string, std::map<std::string, double>> effect_values;
  int model_version = 1;
  std::vector<ModelRecord> model_history;  ///< what the versions of the model achieved, oldest first
  std::optional<LiveSpec> live;            ///< how the machine is watched live; absent: only logs are read
  std::optional<PartsSpec> feeds;          ///< whom `serve` tells; absent: nobody

  /// Settings of a live source; nullptr if the file does not ask for it.
  template <typename Settings>
  const Settings* Source() const {
    return live ? live->sources.Of<Settings>() : nullptr;
  }
  /// Index of a signal, -1 if the machine has none of that name.
  int SignalIndex(std::string_view signal_name) const;
  /// Whether a signal is a share of something, as a spool position is of its stroke; false of unknown signals.
  bool IsShare(std::string_view signal_name) const;
  /// Geometry value or nullopt.
  std::optional<KnownValue> Geometry(const std::string& key) const;

  bool operator==(const Machine&) const = default;
};

/// Reads a machine file. Errors name file, line, key, value and what was expected; an unknown key is an error
/// that suggests the nearest known one.
Result<Machine> LoadMachine(const std::string& path);
/// The same from text; `origin` stands in messages.
Result<Machine> ParseMachine(const std::string& text, const std::string& origin);
/// Writes a machine file with comments that LoadMachine reads back to an equal Machine.
std::string FormatMachine(const Machine& machine);

}  // namespace hydroscope
