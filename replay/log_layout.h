#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "models/machine.h"

namespace hydroscope {

/// How a text log is laid out.
struct LogLayout {
  char separator = ',';            ///< ',' ';' '\t', or ' ' for runs of blanks and tabs
  char decimal = '.';              ///< '.' or ','
  bool header = true;              ///< false: columns are named "1", "2", ...
  bool unit_row = false;           ///< a row of units follows the header
  int skip_lines = 0;              ///< lines before the header row (before the data, if there is no header)
  std::vector<std::string> names;  ///< as written in the header, without quotes and blanks around
  std::vector<std::string> units;  ///< per column: from the unit row or from "p_A [bar]"; "" if unknown
  bool ragged = false;             ///< rows of the file differ in their number of fields
  std::size_t fields = 0;          ///< fields of a row (the smallest number, if ragged)
  std::size_t data_offset = 0;     ///< bytes before the first row of data
  std::int64_t data_line = 1;      ///< 1-based line number of the first row of data

  /// Column named `column`: the header text, the header text without its "[unit]", or a 1-based number;
  /// nullopt if there is none.
  std::optional<std::size_t> Find(std::string_view column) const;
  /// All columns that `column` means by the first of these ways that finds one; Find() is the first of them.
  std::vector<std::size_t> FindAll(std::string_view column) const;
};

/// Bytes at the beginning of a log that DetectLayout should be given.
inline constexpr std::size_t kLayoutHead = 64 * 1024;

/// Finds separator, decimal sign, lines to skip, header, unit row and column names from the first bytes of a text log;
/// what `hints` gives is taken as given. `complete`: `head` is the whole log (its last line counts though no line end
/// follows). Errors: empty, binary, or no rows of numbers; they begin with "log 'origin'".
Result<LogLayout> DetectLayout(std::string_view head, const LogFormat& hints, const std::string& origin,
                               bool complete = true);

/// Cuts a line (without its line end) into fields; blanks around a field and quotes around it are left out.
/// With separator ' ', any run of blanks and tabs separates. `fields` is refilled and keeps its memory; the
/// views point into `line`.
void SplitFields(std::string_view line, char separator, std::vector<std::string_view>& fields);

/// Reads a whole field as a number; nullopt if anything else is in it. Blanks around it are allowed.
std::optional<double> FieldNumber(std::string_view field, char decimal);

/// True for "", "NaN", "inf", "n/a", "null", "-", ...: what loggers write when there is no value.
bool IsMissingMark(std::string_view field);

/// The text without blanks, tabs and '\r' at both ends.
std::string_view Trimmed(std::string_view text);

/// "p_A [bar]" or "p_A (bar)" -> "bar"; "" if there is no unit in brackets at the end.
std::string_view BracketedUnit(std::string_view name);

/// A header's name and unit.
struct HeaderName {
  std::string_view name, unit;  ///< "p_A", "bar"; unit "" if there is none
};
/// Of "p_A [bar]", "p_A (bar)" and, as ISO 80000-1 writes the heads of tables, "p_A/bar". Behind a stroke only a unit the
/// project knows is one.
HeaderName SplitHeader(std::string_view header);

}  // namespace hydroscope
