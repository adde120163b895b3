#include "setup/log_shape.h"

#include <algorithm>

#include "core/told_error.h"
#include "replay/time_check.h"

namespace hydroscope {
namespace {

constexpr double kMost = 0.5;            ///< share of rows that shows a habit of the whole log
constexpr std::size_t kFewestRows = 20;  ///< that show one

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

/// "2.935.570,5", "-1,234.5", "12 345 678,0", "1'200.0": three digits behind each sign of grouping, and one sign of another kind
/// or two of the same.
bool GroupsDigits(std::string_view text) {
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  if (text.empty() || !IsDigit(text.front())) return false;
  const std::size_t first = text.find_first_of(".,' ");
  if (first == std::string_view::npos || first > 3) return false;
  const char sign = text[first];
  std::size_t groups = 0, at = first;
  while (at < text.size() && text[at] == sign) {
    if (at + 3 >= text.size() || !std::all_of(text.begin() + at + 1, text.begin() + at + 4, IsDigit))
      return false;
    ++groups;
    at += 4;
  }
  if (at == text.size()) return groups > 1;
  const bool decimal = (text[at] == '.' || text[at] == ',') && text[at] != sign;
  return decimal && std::all_of(text.begin() + at + 1, text.end(), IsDigit);
}

Status CheckGroups(const LogHead& head, const std::string& path) {
  for (std::size_t c = 0; c < head.words.size(); ++c) {
    const LogWords& words = head.words[c];
    if (static_cast<double>(words.rows) < kMost * static_cast<double>(head.rows())) continue;
    if (words.seen.empty() || !std::ranges::all_of(words.seen, GroupsDigits)) continue;
    return BadInput(Tell(
        "log '{}', column '{}': the numbers group their digits (\"{}\"), which can mean several things; export "
        "them without a sign between thousands",
        "Log '{}', Spalte '{}': die Zahlen gruppieren ihre Ziffern („{}“), was mehreres heißen kann; ohne "
        "Tausendertrennzeichen exportieren",
        path, head.layout.names[c], words.seen.front()));
  }
  return {};
}

/// The column that holds the time of each row: dates, or the first of numbers.
std::size_t TimeColumn(const LogHead& head) {
  for (std::size_t c = 0; c < head.columns.size(); ++c)
    if (head.is_date[c]) return c;
  for (std::size_t c = 0; c < head.columns.size(); ++c)
    if (head.words[c].rows == 0) return c;
  return 0;
}

/// A column of names beside one of values: names change from row to row, or the time begins anew where they change.
Status CheckLongForm(const LogHead& head, const std::string& path) {
  constexpr std::size_t kMostColumns = 6;  // time, name, value, and perhaps quality, unit, address
  const std::size_t rows = head.rows(), time = TimeColumn(head);
  if (head.columns.size() > kMostColumns || rows < kFewestRows) return {};
  for (std::size_t c = 0; c < head.words.size(); ++c) {
    const LogWords& words = head.words[c];
    if (c == time || words.rows != rows || words.seen.size() < 2) continue;
    std::size_t changes = 0, anew = 0;
    for (std::size_t row = 1; row < rows; ++row) {
      if (words.of_row[row] == words.of_row[row - 1]) continue;
      ++changes;
      anew += !(head.columns[time][row] > head.columns[time][row - 1]);
    }
    const bool alternates = static_cast<double>(changes) > kMost * static_cast<double>(rows);
    if (changes == 0 || (!alternates && anew < changes)) continue;
    return BadInput(Tell(
        "log '{}': each row holds one value, and column '{}' names its signal (\"{}\", \"{}\", ...); expected one "
        "row for each time with a column for each signal. Export it so, or pivot it",
        "Log '{}': jede Zeile enthält einen Wert, und Spalte '{}' nennt sein Signal („{}“, „{}“, ...); erwartet "
        "eine Zeile je Zeitpunkt mit einer Spalte je Signal. So exportieren, oder pivotieren",
        path, head.layout.names[c], words.seen[0], words.seen[1]));
  }
  return {};
}

}  // namespace

Status CheckShape(const LogHead& head, const std::string& path) {
  TRY(CheckGroups(head, path));
  TRY(CheckLongForm(head, path));
  const std::size_t time = TimeColumn(head);
  if (head.rows() >= kFewestRows && Falls(head.columns[time]))
    return NewestFirst(path, head.layout.names[time]);
  return {};
}

}  // namespace hydroscope
