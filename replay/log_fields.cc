#include <array>
#include <cstring>

#include "core/units.h"
#include "replay/decimal.h"
#include "replay/log_layout.h"

namespace hydroscope {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

bool EqualIgnoringCase(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const char lower = a[i] >= 'A' && a[i] <= 'Z' ? static_cast<char>(a[i] + 32) : a[i];
    if (lower != b[i]) return false;
  }
  return true;
}

/// End of the field that starts at `at`: the next separator outside quotes.
std::size_t FieldEnd(std::string_view line, std::size_t at, char separator) {
  std::size_t first = at;
  while (first < line.size() && line[first] == ' ' && separator != ' ') ++first;
  if (first < line.size() && line[first] == '"') {
    const std::size_t quote = line.find('"', first + 1);
    if (quote != std::string_view::npos) at = quote + 1;
  }
  if (separator == ' ') return std::min(line.find_first_of(" \t", at), line.size());
  return std::min(line.find(separator, at), line.size());
}

std::string_view Unquoted(std::string_view field) {
  field = Trimmed(field);
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
    field = Trimmed(field.substr(1, field.size() - 2));
  return field;
}

}  // namespace

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && IsBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsBlank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view BracketedUnit(std::string_view name) {
  if (name.size() < 3) return {};
  const char close = name.back();
  const char open = close == ']' ? '[' : close == ')' ? '(' : '\0';
  if (open == '\0') return {};
  const std::size_t at = name.rfind(open);
  if (at == std::string_view::npos) return {};
  return Trimmed(name.substr(at + 1, name.size() - at - 2));
}

HeaderName SplitHeader(std::string_view header) {
  if (const auto unit = BracketedUnit(header); !unit.empty())
    return {Trimmed(header.substr(0, header.find_last_of("[("))), unit};
  if (FindUnit(header)) return {header, {}};  // "m/s" is no "m" in seconds
  for (std::size_t at = header.find('/'); at != std::string_view::npos; at = header.find('/', at + 1)) {
    const HeaderName split{Trimmed(header.substr(0, at)), Trimmed(header.substr(at + 1))};
    const auto unit = FindUnit(split.unit);
    if (!unit || split.name.empty()) continue;
    const bool rate =
        unit->si == "s" && split.name != "t" && !split.name.ends_with("ime") && !split.name.ends_with("eit");
    return rate ? HeaderName{header, {}} : split;  // "cycles/min" are no minutes
  }
  return {header, {}};
}

void SplitFields(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  if (separator == ' ') {
    line = Trimmed(line);
    if (line.empty()) return;
  }
  for (std::size_t at = 0;;) {
    const std::size_t end = FieldEnd(line, at, separator);
    fields.push_back(Unquoted(line.substr(at, end - at)));
    if (end >= line.size()) return;
    at = end + 1;
    if (separator == ' ')
      while (at < line.size() && IsBlank(line[at])) ++at;
  }
}

std::optional<double> FieldNumber(std::string_view field, char decimal) {
  field = Trimmed(field);
  constexpr std::size_t kLongest = 400;  // characters; longer than any double written out in full
  if (field.empty() || field.size() > kLongest) return std::nullopt;
  std::array<char, kLongest + 1 + kDecimalPadding> text{};
  std::memcpy(text.data(), field.data(), field.size());
  double value;
  if (ParseDecimalGeneral(text.data(), decimal, value) != text.data() + field.size()) return std::nullopt;
  return value;
}

bool IsMissingMark(std::string_view field) {
  field = Trimmed(field);
  if (!field.empty() && (field.front() == '-' || field.front() == '+')) field.remove_prefix(1);
  static constexpr std::array<std::string_view, 13> kMarks = {
      "",     "nan",  "nan(ind)", "inf",     "infinity", "na",    "n/a",
      "#n/a", "null", "none",     "1.#qnan", "1.#inf",   "1.#ind"};
  for (const std::string_view mark : kMarks)
    if (EqualIgnoringCase(field, mark)) return true;
  return false;
}

}  // namespace hydroscope
