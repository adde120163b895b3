#include "service/log_head.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "replay/byte_source.h"
#include "replay/date_time.h"

namespace hydroscope {
namespace {

constexpr std::size_t kHeadBytes = std::size_t{8} << 20;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Result<std::string> ReadHead(const std::string& path, bool& complete) {
  auto source = OpenFileSource(path);
  if (!source) return tl::unexpected(source.error());
  std::string text(kHeadBytes, '\0');
  std::size_t size = 0;
  while (size < kHeadBytes) {
    const auto read = (*source)->Read(text.data() + size, kHeadBytes - size);
    if (!read) return tl::unexpected(read.error());
    if (*read == 0) break;
    size += *read;
  }
  complete = size < kHeadBytes;
  text.resize(size);
  return text;
}

bool IsUtf8(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80         ? 1
                               : lead >> 5 == 0x6  ? 2
                               : lead >> 4 == 0xe  ? 3
                               : lead >> 3 == 0x1e ? 4
                                                   : 0;
    if (length == 0 || lead == 0xc0 || lead == 0xc1 || i + length > text.size()) return false;
    for (std::size_t k = 1; k < length; ++k)
      if ((static_cast<unsigned char>(text[i + k]) >> 6) != 0x2) return false;
    i += length;
  }
  return true;
}

/// A name that a machine file can hold and that leads back to this column, else the column's number.
std::string ReferenceOf(const LogLayout& layout, std::size_t column) {
  const std::string& name = layout.names[column];
  if (!name.empty() && IsUtf8(name) && layout.Find(name) == column) return name;
  return std::to_string(column + 1);
}

void ReadRows(const std::string& text, bool complete, LogHead& head) {
  std::vector<std::string_view> fields;
  for (std::size_t at = head.layout.data_offset; at < text.size();) {
    std::size_t end = text.find('\n', at);
    if (end == std::string::npos) {
      if (!complete) break;
      end = text.size();
    }
    const std::string_view line = Trimmed(std::string_view(text).substr(at, end - at));
    at = end + 1;
    if (line.empty()) continue;
    SplitFields(line, head.layout.separator, fields);
    if (fields.size() < head.layout.fields) continue;
    for (std::size_t i = 0; i < head.columns.size(); ++i) {
      const std::string_view field = i < fields.size() ? fields[i] : std::string_view();
      auto number = FieldNumber(field, head.layout.decimal);
      if (!number && !field.empty()) {
        number = ParseDateTime(field);
        head.columns[i].date = head.columns[i].date || number.has_value();
      }
      head.columns[i].value.push_back(number && std::isfinite(*number) ? *number : kNaN);
    }
    ++head.rows;
  }
}

double Quantile(std::vector<double>& values, double share) {
  if (values.empty()) return kNaN;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double StandardDeviation(const std::vector<double>& values) {
  if (values.empty()) return 0;
  double mean = 0, square = 0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) square += (value - mean) * (value - mean);
  return std::sqrt(square / static_cast<double>(values.size()));
}

void Describe(HeadColumn& column) {
  std::vector<double> values, steps;
  std::size_t same = 0;
  column.rising = true;
  for (const double value : column.value) {
    if (std::isnan(value)) continue;
    if (!values.empty()) {
      steps.push_back(value - values.back());
      same += steps.back() == 0;
      column.rising = column.rising && steps.back() > 0;
    }
    values.push_back(value);
  }
  column.rising = column.rising && values.size() > 2;
  const double spread = StandardDeviation(values);
  column.roughness = spread > 0 ? StandardDeviation(steps) / spread : 0;
  column.repeated = steps.empty() ? 0 : static_cast<double>(same) / static_cast<double>(steps.size());
  column.step = steps.empty() ? 0 : Quantile(steps, 0.5);
  column.low = Quantile(values, 0.01);
  column.high = Quantile(values, 0.99);
}

}  // namespace

Result<LogHead> ParseLogHead(const std::string& text, const std::string& path, bool complete) {
  if (text.starts_with("MATLAB 5.0") || text.starts_with("\x89HDF"))
    return BadInput(
        "log '{}' is a MAT file; expected a text log (CSV): export a few strokes as CSV, or start from a "
        "file "
        "in machines/ and name the variables as columns",
        path);
  const bool head_complete = complete && text.size() <= kLayoutHead;
  auto layout = DetectLayout(std::string_view(text).substr(0, kLayoutHead), {}, path, head_complete);
  if (!layout) return tl::unexpected(layout.error());
  LogHead head;
  head.path = path;
  head.layout = std::move(*layout);
  for (std::size_t i = 0; i < head.layout.names.size(); ++i) {
    HeadColumn column;
    column.reference = ReferenceOf(head.layout, i);
    column.name = IsUtf8(head.layout.names[i]) ? head.layout.names[i] : "column " + column.reference;
    column.unit = head.layout.units[i];
    head.columns.push_back(std::move(column));
  }
  ReadRows(text, complete, head);
  for (HeadColumn& column : head.columns) Describe(column);
  return head;
}

Result<LogHead> ReadLogHead(const std::string& path) {
  bool complete = false;
  const auto text = ReadHead(path, complete);
  if (!text) return tl::unexpected(text.error());
  return ParseLogHead(*text, path, complete);
}

}  // namespace hydroscope
