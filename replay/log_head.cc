#include "replay/log_head.h"

#include <algorithm>

#include "core/constants.h"
#include "replay/byte_source.h"
#include "replay/date_time.h"
#include "replay/mat_reader.h"

namespace hydroscope {
namespace {

Result<LogHead> ReadMatHead(const std::string& path, std::size_t rows) {
  auto mat = TRY(MatColumns::Open(path));
  LogHead head;
  head.mat = true;
  head.layout.names = mat->names();
  head.layout.units.assign(head.layout.names.size(), "");
  head.is_date.assign(head.layout.names.size(), false);
  std::int64_t longest = 0;
  for (std::size_t c = 0; c < head.layout.names.size(); ++c) longest = std::max(longest, mat->rows(c));
  const auto wanted = static_cast<std::size_t>(std::min(longest, static_cast<std::int64_t>(rows)));
  for (std::size_t c = 0; c < head.layout.names.size(); ++c) {
    std::vector<double> column(wanted, kNaN);
    const std::int64_t count = std::min(mat->rows(c), static_cast<std::int64_t>(wanted));
    TRY(mat->Read(c, 0, count, column.data()));
    head.columns.push_back(std::move(column));
  }
  head.words.resize(head.layout.names.size());
  return head;
}

void AddWord(std::string_view text, LogWords& words) {
  int word = -1;
  if (!text.empty()) {
    ++words.rows;
    const auto known = std::ranges::find(words.seen, text);
    if (known != words.seen.end() || words.seen.size() < LogWords::kMost) {
      word = static_cast<int>(known - words.seen.begin());
      if (known == words.seen.end()) words.seen.emplace_back(text);
    }
  }
  words.of_row.push_back(word);
}

void AddRow(const std::vector<std::string_view>& fields, LogHead& head) {
  for (std::size_t c = 0; c < head.columns.size(); ++c) {
    const std::string_view field = c < fields.size() ? fields[c] : std::string_view();
    std::optional<double> value = FieldNumber(field, head.layout.decimal);
    if (!value) {
      value = ParseDateTime(field);
      if (value) head.is_date[c] = true;
    }
    AddWord(value || IsMissingMark(field) ? std::string_view() : field, head.words[c]);
    head.columns[c].push_back(value.value_or(kNaN));
  }
}

}  // namespace

Result<LogHead> ReadLogHead(const std::string& path, std::size_t rows, const LogFormat& hints) {
  if (IsMatFile(path)) return ReadMatHead(path, rows);
  auto source = TRY(OpenFileSource(path));
  LineBuffer lines(std::move(source), path);
  TRY(lines.Fill());
  const std::string_view text(lines.cursor(), static_cast<std::size_t>(lines.limit() - lines.cursor()));
  auto layout = TRY(DetectLayout(text.substr(0, kLayoutHead), hints, path, text.size() <= kLayoutHead));

  LogHead head;
  head.layout = std::move(layout);
  head.columns.resize(head.layout.names.size());
  head.is_date.assign(head.layout.names.size(), false);
  head.words.resize(head.layout.names.size());
  lines.Advance(lines.cursor() + head.layout.data_offset);
  std::vector<std::string_view> fields;
  while (head.rows() < rows) {
    const auto more = TRY(lines.Fill());
    if (!more) break;
    const std::string_view rest(lines.cursor(), static_cast<std::size_t>(lines.limit() - lines.cursor()));
    const std::string_view line = rest.substr(0, rest.find('\n'));
    SplitFields(line, head.layout.separator, fields);
    if (fields.size() >= head.layout.fields) AddRow(fields, head);
    lines.Advance(lines.cursor() + line.size() + 1);
  }
  return head;
}

}  // namespace hydroscope
