#include "replay/log_layout.h"

#include <algorithm>
#include <charconv>

#include "core/text_encoding.h"
#include "core/told_error.h"
#include "core/units.h"
#include "replay/date_time.h"

namespace hydroscope {
namespace {

struct Line {
  std::string_view text;
  std::size_t offset = 0;  ///< of its first byte in the log
};

/// The lines of the head; the last one only if it is complete.
std::vector<Line> SplitLines(std::string_view head, std::size_t start, bool complete) {
  std::vector<Line> lines;
  for (std::size_t at = start; at < head.size();) {
    const std::size_t end = head.find('\n', at);
    if (end == std::string_view::npos) {
      if (complete || lines.empty()) lines.push_back({Trimmed(head.substr(at)), at});
      break;
    }
    std::string_view text = head.substr(at, end - at);
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    lines.push_back({text, at});
    at = end + 1;
  }
  return lines;
}

enum class FieldKind { kEmpty, kNumber, kText };

FieldKind FieldKindOf(std::string_view field, char decimal) {
  if (IsMissingMark(field)) return FieldKind::kEmpty;
  if (FieldNumber(field, decimal) || ParseDateTime(field)) return FieldKind::kNumber;
  return FieldKind::kText;
}

struct Dialect {
  char separator = ',';
  char decimal = '.';
};

/// What rows of data look like, learnt from the last lines of the head.
struct RowShape {
  std::size_t fields = 0;    ///< the most frequent number of fields
  std::vector<bool> number;  ///< columns that hold numbers or dates in most rows
  double score = -1;         ///< numbers less texts per row; the better dialect has more
};

/// Columns that hold a number in at least half of the rows that have them.
std::vector<bool> NumberColumns(const std::vector<std::vector<FieldKind>>& rows, std::size_t fields) {
  std::vector<bool> number(fields);
  for (std::size_t column = 0; column < fields; ++column) {
    int numbers = 0;
    int texts = 0;
    for (const auto& row : rows) {
      if (column >= row.size()) continue;
      numbers += row[column] == FieldKind::kNumber;
      texts += row[column] == FieldKind::kText;
    }
    number[column] = numbers > 0 && numbers >= texts;
  }
  return number;
}

RowShape LearnShape(const std::vector<Line>& lines, Dialect dialect) {
  constexpr std::size_t kMostLines = 60;
  // The second half: whatever stands above the data, most of these lines are data.
  const auto filled = static_cast<std::size_t>(
      std::ranges::count_if(lines, [](const Line& line) { return !Trimmed(line.text).empty(); }));
  const std::size_t looked_at = std::clamp<std::size_t>(filled / 2, 1, kMostLines);
  std::vector<std::vector<FieldKind>> rows;
  std::vector<std::string_view> fields;
  double score = 0;
  for (std::size_t i = lines.size(); i > 0 && rows.size() < looked_at; --i) {
    if (Trimmed(lines[i - 1].text).empty()) continue;
    SplitFields(lines[i - 1].text, dialect.separator, fields);
    std::vector<FieldKind> kinds;
    for (const std::string_view field : fields) {
      kinds.push_back(FieldKindOf(field, dialect.decimal));
      score += kinds.back() == FieldKind::kNumber ? 1 : kinds.back() == FieldKind::kText ? -1 : 0;
    }
    rows.push_back(std::move(kinds));
  }
  RowShape shape;
  if (rows.empty()) return shape;
  shape.score = score / static_cast<double>(rows.size());
  std::vector<std::size_t> counts;
  for (const auto& row : rows) counts.push_back(row.size());
  std::ranges::sort(counts);
  shape.fields = counts[counts.size() / 2];
  shape.number = NumberColumns(rows, shape.fields);
  return shape;
}

std::vector<Dialect> CandidateDialects(const LogFormat& hints) {
  std::vector<Dialect> candidates;
  for (const char decimal : {'.', ','})
    for (const char separator : {'\t', ';', ',', ' '}) {
      if (separator == decimal) continue;
      if (hints.separator && *hints.separator != separator) continue;
      if (hints.decimal && *hints.decimal != decimal) continue;
      candidates.push_back({separator, decimal});
    }
  return candidates;
}

/// A row of data has numbers in at least half of the columns that hold numbers.
bool LooksLikeData(const std::vector<std::string_view>& fields, const RowShape& shape, char decimal) {
  int expected = 0;
  int numbers = 0;
  for (std::size_t i = 0; i < shape.fields; ++i) {
    if (!shape.number[i]) continue;
    ++expected;
    numbers += i < fields.size() && FieldKindOf(fields[i], decimal) == FieldKind::kNumber;
  }
  return numbers > 0 && 2 * numbers >= expected;
}

bool LooksLikeUnits(const std::vector<std::string_view>& fields) {
  int units = 0;
  int others = 0;
  for (std::string_view field : fields) {
    if (const auto inside = BracketedUnit(field); !inside.empty() && inside.size() + 2 == field.size())
      field = inside;
    if (FindUnit(ToUtf8(field)) || field == "-") {
      ++units;
    } else if (!field.empty()) {
      ++others;
    }
  }
  return units > 0 && units >= others;
}

/// A header has at least two fields (or the data have only one), at least half as many as the data.
bool CanBeHeader(const std::vector<std::string_view>& fields, const RowShape& shape) {
  if (shape.fields == 1) return fields.size() == 1 && !fields[0].empty();
  return fields.size() >= 2 && 2 * fields.size() >= shape.fields;
}

/// The header text may begin with a comment sign.
std::string_view WithoutCommentSign(std::string_view line) {
  line = Trimmed(line);
  while (!line.empty() && (line.front() == '#' || line.front() == '%')) line = Trimmed(line.substr(1));
  return line;
}

/// Numbers of the lines that make up the head of the log, -1 if there is none.
struct HeadLines {
  int header = -1;
  int unit_row = -1;
  int data = -1;
};

class HeadFinder {
 public:
  HeadFinder(const std::vector<Line>& lines, const LogFormat& hints, Dialect dialect, const RowShape& shape)
      : lines_(lines), hints_(hints), dialect_(dialect), shape_(shape) {}

  HeadLines Find() {
    if (hints_.skip_lines && hints_.header.value_or(true)) return FromGivenHeader(*hints_.skip_lines);
    HeadLines found;
    found.data = FirstData(hints_.skip_lines.value_or(0));
    if (found.data < 0 || !hints_.header.value_or(true)) return found;
    if (found.data == 0) return hints_.header ? FromGivenHeader(0) : found;
    int before = LineBefore(found.data);
    if (before < 0) return found;
    if (hints_.unit_row.value_or(IsUnitRow(before))) {
      found.unit_row = before;
      before = LineBefore(before);
    }
    if (before >= 0 && (hints_.header || CanBeHeader(Fields(before), shape_))) found.header = before;
    return found;
  }

 private:
  const std::vector<std::string_view>& Fields(int line) {
    SplitFields(WithoutCommentSign(lines_[line].text), dialect_.separator, fields_);
    return fields_;
  }
  int Count() const { return static_cast<int>(lines_.size()); }
  bool Empty(int line) const { return Trimmed(lines_[line].text).empty(); }

  int FirstData(int from) {
    for (int line = from; line < Count(); ++line) {
      if (Empty(line)) continue;
      SplitFields(lines_[line].text, dialect_.separator, fields_);
      if (LooksLikeData(fields_, shape_, dialect_.decimal)) return line;
    }
    return -1;
  }
  int LineBefore(int line) const {
    do {
      --line;
    } while (line >= std::max(0, hints_.skip_lines.value_or(0)) && Empty(line));
    return line >= std::max(0, hints_.skip_lines.value_or(0)) ? line : -1;
  }
  /// Units directly below a line with as many fields.
  bool IsUnitRow(int line) {
    const std::size_t fields = Fields(line).size();
    if (!LooksLikeUnits(fields_)) return false;
    const int above = LineBefore(line);
    return above >= 0 && Fields(above).size() == fields && CanBeHeader(fields_, shape_);
  }
  HeadLines FromGivenHeader(int header) {
    HeadLines found;
    if (header < 0 || header >= Count()) return found;
    found.header = header;
    int next = header + 1;
    while (next < Count() && Empty(next)) ++next;
    if (next >= Count()) return found;
    Fields(next);
    if (hints_.unit_row.value_or(LooksLikeUnits(fields_) &&
                                 !LooksLikeData(fields_, shape_, dialect_.decimal)))
      found.unit_row = next++;
    found.data = FirstData(next);
    return found;
  }

  const std::vector<Line>& lines_;
  const LogFormat& hints_;
  Dialect dialect_;
  const RowShape& shape_;
  std::vector<std::string_view> fields_;
};

void SetNames(std::string_view header, const RowShape& shape, LogLayout& layout) {
  std::vector<std::string_view> fields;
  if (layout.header) SplitFields(WithoutCommentSign(header), layout.separator, fields);
  for (const std::string_view field : fields) layout.names.push_back(ToUtf8(field));
  for (std::size_t i = layout.names.size(); i < shape.fields; ++i)
    layout.names.push_back(std::to_string(i + 1));
}

void SetUnits(std::string_view unit_row, LogLayout& layout) {
  layout.units.assign(layout.names.size(), "");
  for (std::size_t i = 0; i < layout.names.size(); ++i) layout.units[i] = SplitHeader(layout.names[i]).unit;
  if (!layout.unit_row) return;
  std::vector<std::string_view> fields;
  SplitFields(WithoutCommentSign(unit_row), layout.separator, fields);
  for (std::size_t i = 0; i < std::min(fields.size(), layout.units.size()); ++i) {
    const auto inside = BracketedUnit(fields[i]);
    layout.units[i] =
        ToUtf8(!inside.empty() && inside.size() + 2 == fields[i].size() ? inside : std::string(fields[i]));
  }
}

/// Ragged: the header names more or fewer columns than the rows have, or many rows differ among each other.
void SetFields(const std::vector<Line>& lines, int data, const RowShape& shape, LogLayout& layout) {
  std::vector<std::string_view> fields;
  int rows = 0;
  int other = 0;
  std::size_t least = shape.fields;
  for (std::size_t i = static_cast<std::size_t>(data); i < lines.size(); ++i) {
    if (Trimmed(lines[i].text).empty()) continue;
    SplitFields(lines[i].text, layout.separator, fields);
    if (!LooksLikeData(fields, shape, layout.decimal)) continue;
    ++rows;
    other += fields.size() != shape.fields;
    least = std::min(least, fields.size());
  }
  layout.fields = shape.fields;
  layout.ragged = layout.names.size() > shape.fields || 5 * other > rows;
  if (5 * other > rows) layout.fields = least;
}

Status CheckText(std::string_view head, const std::string& origin) {
  if (Trimmed(head).empty())
    return BadInput(Tell("log '{}' is empty; expected a header and rows of numbers",
                         "Log '{}' ist leer; erwartet: eine Kopfzeile und Zeilen mit Zahlen", origin));
  if (head.substr(0, 64).find('\0') != std::string_view::npos)
    return BadInput(Tell(
        "log '{}' is binary; expected text (CSV), gzip-compressed text or a MAT file",
        "Log '{}' ist binär; erwartet: Text (CSV), mit gzip gepackter Text oder eine MAT-Datei", origin));
  return {};
}

}  // namespace

std::optional<std::size_t> LogLayout::Find(std::string_view column) const {
  const auto all = FindAll(column);
  return all.empty() ? std::nullopt : std::optional(all.front());
}

std::vector<std::size_t> LogLayout::FindAll(std::string_view column) const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == column) found.push_back(i);
  if (!found.empty()) return found;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const HeaderName header = SplitHeader(names[i]);
    if (!header.unit.empty() && header.name == column) found.push_back(i);
  }
  if (!found.empty()) return found;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(column.data(), column.data() + column.size(), number);
  if (error != std::errc() || end != column.data() + column.size()) return {};
  if (number < 1 || number > names.size()) return {};
  return {number - 1};
}

Result<LogLayout> DetectLayout(std::string_view head, const LogFormat& hints, const std::string& origin,
                               bool complete) {
  TRY(CheckText(head, origin));
  const auto candidates = CandidateDialects(hints);
  if (candidates.empty())
    return BadInput(Tell(
        "log '{}': separator and decimal sign of the machine file are both '{}'; give different ones",
        "Log '{}': Trennzeichen und Dezimalzeichen der Maschinendatei sind beide '{}'; verschiedene angeben",
        origin, *hints.separator));
  const std::size_t start = head.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  const std::vector<Line> lines = SplitLines(head, start, complete);

  Dialect dialect = candidates.front();
  RowShape shape;
  for (const Dialect candidate : candidates) {
    RowShape learnt = LearnShape(lines, candidate);
    if (learnt.score <= shape.score) continue;
    dialect = candidate;
    shape = std::move(learnt);
  }
  const HeadLines found = HeadFinder(lines, hints, dialect, shape).Find();
  if (found.data < 0)
    return BadInput(Tell(
        "log '{}': no rows of numbers found (lines looked at: {}); expected a header row with column names "
        "and rows of numbers separated by ',', ';', tab or blanks",
        "Log '{}': keine Zahlenreihen gefunden (angesehene Zeilen: {}); erwartet: eine Kopfzeile mit den Namen der "
        "Spalten "
        "und Zeilen mit Zahlen, getrennt durch ',', ';', Tabulator oder Leerzeichen",
        origin, lines.size()));

  LogLayout layout;
  layout.separator = dialect.separator;
  layout.decimal = dialect.decimal;
  layout.header = found.header >= 0;
  layout.unit_row = found.unit_row >= 0;
  layout.skip_lines = layout.header ? found.header : layout.unit_row ? found.unit_row : found.data;
  layout.data_offset = lines[found.data].offset;
  layout.data_line = found.data + 1;
  SetNames(layout.header ? lines[found.header].text : "", shape, layout);
  SetUnits(layout.unit_row ? lines[found.unit_row].text : "", layout);
  SetFields(lines, found.data, shape, layout);
  return layout;
}

}  // namespace hydroscope
