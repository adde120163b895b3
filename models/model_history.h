#pragma once

#include <map>
#include <string>
#include <vector>

namespace hydroscope {

/// A parameter as it was fitted with one version of a model.
struct RecordedValue {
  std::string name;               ///< K, V0, ..., or "internal_leakage.G" of an effect
  double value = 0.0, std = 0.0;  ///< SI; +-1.96 std is the 95 % interval
  std::string unit;

  bool operator==(const RecordedValue&) const = default;
};

/// One version of a machine's model with what it achieved, as the machine file keeps it.
struct ModelRecord {
  int version = 1;
  std::string name;                             ///< "base", "base + internal_leakage", or the user's own
  std::vector<std::string> effects;             ///< in order of adding
  std::string source;                           ///< log or database it was judged on, "" = it was not
  int strokes = 0;                              ///< judged on
  double rms_holdout = 0.0, noise_floor = 0.0;  ///< SI of `unit`, on strokes left out; sensor noise alone
  std::string unit = "m3/s";
  std::vector<RecordedValue> parameters;

  bool judged() const { return !source.empty(); }
  bool operator==(const ModelRecord&) const = default;
};

/// The records as sections [[model_history]] of a machine file, behind the comment line kModelHistoryComment.
std::string FormatModelHistory(const std::vector<ModelRecord>& history);
inline constexpr const char* kModelHistoryComment =
    "# Versions of the model, written by 'hydroscope model': errors on strokes left out, "
    "parameters with their std, SI.";

/// Machine::effect_values as an inline table.
std::string FormatEffectValues(const std::map<std::string, std::map<std::string, double>>& values);

}  // namespace hydroscope
