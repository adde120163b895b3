#pragma once

#include <toml++/toml.h>

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/told_error.h"

namespace hydroscope {

/// What is wrong with a machine file, each with its line. The first few are reported together so that a file
/// is mended in one go.
class FileProblems {
 public:
  explicit FileProblems(std::string origin) : origin_(std::move(origin)) {}

  /// Notes "origin:line: text", with a column (from 1) "origin:line:column: text".
  void Add(const toml::source_region& where, const Told& text, std::size_t column = 0);
  bool any() const { return !problems_.empty(); }
  /// The first ten, in the order of the file; in German where all of them are told so.
  Error ToError() const;

 private:
  static constexpr std::size_t kReported = 10;
  std::string origin_;
  struct Problem {
    toml::source_index line;
    std::size_t column;
    Told text;
  };
  std::vector<Problem> problems_;
};

/// What a number in a machine file must be. Limits are SI.
struct Quantity {
  std::string_view si = "1";           ///< SI unit of the quantity; "" = any unit is taken
  std::string_view default_unit = {};  ///< unit of a plain number; "" = the SI unit
  bool difference = false;             ///< a width or deviation: zero of the unit (degC) does not count
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above_low = false;  ///< must be greater than `low`, not equal
};

/// A time that must not be 0.
const Quantity kSecondsAboveZero{.si = "s", .default_unit = "s", .low = 0, .above_low = true};

/// A unit that the file may name, also a rate such as "mm/s" or "bar/s": SI = number * scale + offset.
struct FileUnit {
  double scale = 1.0;
  double offset = 0.0;
  std::string si;
};
std::optional<FileUnit> FindFileUnit(std::string_view name);

/// Typed access to one table of a machine file. Every wrong value becomes a problem that names file, line,
/// key, value found and what was expected, and the caller's default stays.
class TableReader {
 public:
  struct Entry {
    std::string key;
    const toml::node* node;
    toml::source_region where;
  };

  /// `path` stands in messages, e.g. "signals.p_A".
  TableReader(const toml::table& table, std::string path, FileProblems& problems);

  bool Has(std::string_view key) const { return table_.contains(key); }
  /// The value under `key`, nullptr if there is none.
  const toml::node* Node(std::string_view key) const { return table_.get(key); }
  /// Entries in the order of the file.
  std::vector<Entry> Entries() const;
  /// Every key that is not in `known` is a problem with the nearest known one.
  void AllowOnly(const std::vector<std::string>& known);

  void Text(std::string_view key, std::string& value);
  void Flag(std::string_view key, bool& value);
  void Integer(std::string_view key, int& value, int low, int high = std::numeric_limits<int>::max());
  void Integer(std::string_view key, std::optional<int>& value, int low, int high);
  /// One of `choices`; returns its index.
  std::optional<std::size_t> Choice(std::string_view key, const std::vector<std::string>& choices);
  void Texts(std::string_view key, std::vector<std::string>& values);
  /// A plain number in `quantity.default_unit`, or { value, unit }; converted to SI.
  void Number(std::string_view key, double& value, const Quantity& quantity);
  void Number(std::string_view key, std::optional<double>& value, const Quantity& quantity);
  /// Name of a unit of the quantity `si` ("" = any), checked.
  void UnitName(std::string_view key, std::string& value, std::string_view si);
  /// The table under `key`; nullptr if absent or (a problem) no table.
  const toml::table* Table(std::string_view key);

  /// Notes a problem at `key`: `[path] key = found: expected ...`.
  void Wrong(std::string_view key, const std::string& expected);
  /// Notes a problem of the table as a whole.
  void Problem(const std::string& text);
  void Problem(const toml::source_region& where, const Told& text, std::size_t column = 0);

  const std::string& path() const { return path_; }
  FileProblems& problems() { return problems_; }

 private:
  std::optional<double> Convert(std::string_view key, const toml::node& node, const Quantity& quantity);
  toml::source_region Where(std::string_view key) const;

  const toml::table& table_;
  std::string path_;
  FileProblems& problems_;
};

/// "did you mean "x"? " with the nearest candidate, or "".
Told DidYouMean(std::string_view name, const std::vector<std::string>& candidates);
/// "a, b, c".
std::string Listed(const std::vector<std::string>& names);

}  // namespace hydroscope
