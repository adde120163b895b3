#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "estimation/frequency_response/frequency_response.h"
#include "models/machine.h"

namespace hydroscope {

/// What a page may ask to be worked out.
struct WorkRequest {
  enum class Kind { kCheck, kFit, kCompare, kExplain, kFrf, kPicture, kPreview, kAdd, kRemove, kRestore };
  Kind kind = Kind::kCheck;
  std::string effect;                      ///< kPreview, kAdd, kRemove
  int version = 0;                         ///< kRestore
  std::string log;                         ///< kPicture; "" = the first
  FrequencyResponseOptions response = {};  ///< kFrf
};
const char* WorkName(WorkRequest::Kind kind);
/// Of {"kind": ..., "effect": ..., "version": ..., "log": ..., and of kFrf what ParseResponseOptions takes}. Errors name the key, what it holds, and what was expected.
Result<WorkRequest> ParseWorkRequest(const std::string& body);

/// What a person says of the machine of a log: which kind it is, and which column is which of its sensors.
struct ColumnMapping {
  struct Entry {
    std::string column;  ///< LogColumn::reference
    std::string signal;  ///< name in a machine file, "time"; "" = not used
    std::string unit;    ///< "" = as proposed
  };
  std::string model;  ///< id of a kind of machine; "": as recognised
  std::vector<Entry> columns;
  std::map<std::string, double> geometry;              ///< by name, SI
  std::optional<std::vector<GateBound>> gate;          ///< nothing: as proposed
  std::optional<BalanceSpec> balance;                  ///< of a machine of one's own; nothing: as proposed
  std::optional<std::vector<UserEffectSpec>> effects;  ///< the same
};
/// Of {"model": id, "balance": {"output": ..., "terms": [{"name", "expression"}]}, "effects": [{"id", "expression", "not_negative"}], "columns": [{"column", "signal", "unit"}], "geometry": {name: SI}, "gate": [{"signal", "rate", "magnitude", "min",
/// "max"}]}; all may be absent.
Result<ColumnMapping> ParseColumnMapping(const std::string& body);

/// Strokes `first` to `last` of a machine of a trend database.
struct StrokeStretch {
  std::string machine;
  std::int64_t first = 0, last = -1;
};
/// Of {"machine", "first", "last"}. Errors name the key and what was expected.
Result<StrokeStretch> ParseStrokeStretch(const std::string& body);

/// The value of `key` in {"key": "text"}. Error: it is none.
Result<std::string> ParseText(const std::string& body, const std::string& key);

/// A file name without a folder that may be written: letters, digits, - _ . and no dot in front; made so where it is not.
/// "" if nothing is left.
std::string PlainFileName(const std::string& name);

}  // namespace hydroscope
