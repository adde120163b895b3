#include "replay/csv_reader.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/told_error.h"
#include "replay/date_time.h"
#include "replay/decimal.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsForPeriod = 1000;
constexpr int kLessons = 64;  // shapes learned per column and block: logs without any are not slowed
constexpr std::size_t kLongestQuote = 60;  // characters of the log quoted in a finding

/// The same pointer, of which the compiler knows nothing: it cannot be replaced by one that depends on what
/// was read.
template <typename T>
const T* Opaque(const T* p) {
  asm volatile("" : "+r"(p));
  return p;
}

std::string_view LineAt(const char* text) {
  const char* end = static_cast<const char*>(::rawmemchr(text, '\n'));
  std::string_view line(text, static_cast<std::size_t>(end - text));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

}  // namespace

Result<std::unique_ptr<CsvReader>> CsvReader::Open(std::unique_ptr<ByteSource> source, const Machine& machine,
                                                   const std::string& origin) {
  std::unique_ptr<CsvReader> reader(new CsvReader(std::move(source), machine, origin));
  TRY(reader->lines_.Fill());
  const std::string_view head(reader->lines_.cursor(),
                              static_cast<std::size_t>(reader->lines_.limit() - reader->lines_.cursor()));
  reader->layout_ =
      TRY(DetectLayout(head.substr(0, kLayoutHead), machine.log, origin, head.size() <= kLayoutHead));
  reader->plan_ = TRY(PlanColumns(reader->layout_, machine, origin, reader->counters_));
  TRY(reader->Prepare(machine.log));
  return reader;
}

Status CsvReader::Prepare(const LogFormat& format) {
  lines_.Advance(lines_.cursor() + layout_.data_offset);
  line_ = layout_.data_line;
  MakeColumns();
  TRY(FindSamplePeriod(format));
  return {};
}

void CsvReader::MakeColumns() {
  const auto column = [this](int index) -> Column& {
    if (columns_.size() <= static_cast<std::size_t>(index))
      columns_.resize(static_cast<std::size_t>(index) + 1);
    return columns_[index];
  };
  if (plan_.time != ColumnPlan::kAbsent) {
    SplitFields(LineAt(lines_.cursor()), layout_.separator, fields_);
    const auto index = static_cast<std::size_t>(plan_.time);
    time_is_text_ = index < fields_.size() && !FieldNumber(fields_[index], layout_.decimal) &&
                    ParseDateTime(fields_[index]).has_value();
    column(plan_.time).use = time_is_text_ ? Use::kTimeText : Use::kNumber;
    column(plan_.time).signal = kTime;
  }
  for (std::size_t s = 0; s < plan_.column.size(); ++s) {
    if (plan_.column[s] == ColumnPlan::kAbsent) continue;
    Column& use = column(plan_.column[s]);
    if (use.signal != kNone) continue;
    use.use = Use::kNumber;
    use.signal = static_cast<int>(s);
  }
  if (columns_.empty()) columns_.resize(1);  // nothing is used: rows are only counted
  shaped_ = CanReadShapes() && layout_.separator != ' ';
}

std::optional<double> CsvReader::TimeOf(std::string_view field) const {
  if (time_is_text_) return ParseDateTime(field);
  const auto number = FieldNumber(field, layout_.decimal);
  if (!number || !std::isfinite(*number)) return std::nullopt;
  return *number;
}

Status CsvReader::FindSamplePeriod(const LogFormat& format) {
  if (format.sample_period) {
    sample_period_ = *format.sample_period;
    time_check_ = TimeChecker(sample_period_);
    return {};
  }
  std::vector<double> times;
  for (const char* at = lines_.cursor(); at < lines_.limit() && times.size() < kRowsForPeriod;) {
    const std::string_view line = LineAt(at);
    at = static_cast<const char*>(::rawmemchr(line.data() + line.size(), '\n')) + 1;
    SplitFields(line, layout_.separator, fields_);
    if (static_cast<std::size_t>(plan_.time) >= fields_.size()) continue;
    if (const auto time = TimeOf(fields_[plan_.time]))
      times.push_back(time_is_text_ ? *time : *time * plan_.time_scale);
  }
  sample_period_ = SamplePeriodOf(times);
  time_check_ = TimeChecker(sample_period_, LongestStep(times, sample_period_));
  if (sample_period_ > 0) return {};
  return NoSamplePeriod(origin_, layout_.names[plan_.time], times, format.time_unit);
}

void CsvReader::PointInto(SampleBlock& block) {
  for (Column& column : columns_) {
    if (column.use == Use::kSkip) continue;
    column.out = column.signal == kTime ? block.time.data() : block.signal[column.signal].data();
    column.lessons = kLessons;
  }
}

Result<std::size_t> CsvReader::Read(SampleBlock& block, std::size_t max_rows) {
  block.Resize(signals_.size(), max_rows);
  for (auto& column : block.quality) std::ranges::fill(column, quality::kGood);
  PointInto(block);
  std::size_t rows = 0;
  while (rows < max_rows) {
    const auto more = lines_.Fill();
    if (!more) {
      if (rows == 0) return tl::unexpected(more.error());
      break;  // the next call meets the same error
    }
    if (!*more) break;
    rows = ReadLines(block, rows, max_rows);
  }
  block.Resize(signals_.size(), rows);
  FillDerived(block, rows);
  ConvertToSi(plan_, rows, block);
  time_check_.Check(block, counters_);
  counters_.rows += static_cast<std::int64_t>(rows);
  return rows;
}

std::size_t CsvReader::ReadLines(SampleBlock& block, std::size_t row, std::size_t max_rows) {
  const char* at = lines_.cursor();
  const char* const limit = lines_.limit();
  const bool blanks = layout_.separator == ' ';
  while (at < limit && row < max_rows) {
    const char* next = shaped_  ? ReadShapedRow(at, row)
                       : blanks ? ReadPlainRow<true>(at, row)
                                : ReadPlainRow<false>(at, row);
    bool delivered = next != nullptr;
    if (!delivered) {
      const std::string_view line = LineAt(at);
      delivered = ReadOddRow(line, row, block);
      next = static_cast<const char*>(::rawmemchr(line.data() + line.size(), '\n')) + 1;
    }
    if (delivered) {
      if (plan_.time == ColumnPlan::kAbsent)
        block.time[row] = static_cast<double>(row_number_) * sample_period_;
      ++row_number_;
      ++row;
    }
    ++line_;
    at = next;
  }
  lines_.Advance(at);
  return row;
}

/// Where the next field starts: `next`, taken from the guess that this field is as wide as the one above it.
/// The processor can then begin the next field before this one is read; a chain of pointers through all
/// fields of a row costs twice the time.
inline const char* CsvReader::NextStart(const char* start, const char* next, const char* guess,
                                        Column& column) {
  if (next - start == column.width) return guess;
  column.width = next - start;
  return Opaque(next);
}

/// Start of the next line, or nullptr if the row is not plain; values already written are then overwritten.
template <bool kBlanks>
const char* CsvReader::ReadPlainRow(const char* text, std::size_t row) {
  const char separator = layout_.separator;
  const char point = layout_.decimal;
  const auto separates = [separator](char c) { return kBlanks ? c == ' ' || c == '\t' : c == separator; };
  Column* column = columns_.data();
  Column* const last = column + columns_.size() - 1;
  const char* p = text;
  for (; column != last; ++column) {
    const char* const guess = Opaque(p + column->width);
    const char* end = column->use == Use::kNumber ? ParseDecimal(p, point, column->out[row]) : nullptr;
    if (end == nullptr || !separates(*end)) {
      end = ReadPlainField<kBlanks>(p, *column, row);
      if (end == nullptr || !separates(*end)) return nullptr;
    }
    p = NextStart(p, end + 1, guess, *column);
  }
  const char* const guess = Opaque(p + last->width);
  const char* end = last->use == Use::kNumber ? ParseDecimal(p, point, last->out[row]) : nullptr;
  if (end == nullptr || (*end != '\n' && !separates(*end))) end = ReadPlainField<kBlanks>(p, *last, row);
  if (end == nullptr) return nullptr;
  const char* const next =
      *end == '\n' && columns_.size() == layout_.fields ? end + 1 : SkipRest<kBlanks>(end);
  return next == nullptr ? nullptr : NextStart(p, next, guess, *last);
}

#ifdef HYDROSCOPE_HAS_FIELD_SHAPES
/// As ReadPlainRow<false>, quick for fields of the shape of those above.
[[gnu::target("avx2")]] const char* CsvReader::ReadShapedRow(const char* text, std::size_t row) {
  const char* p = text;
  for (Column& column : columns_) {
    // A branch, which is foretold: the next field begins without waiting for the sign of this one.
    const FieldShape* shape = &column.shape[0];
    if (*p == '-') shape = Opaque(&column.shape[1]);
    if (column.use == Use::kNumber && ReadShape(p, *shape, column.out[row])) {
      p += shape->width;
      continue;
    }
    p = ReadUnlikeField(p, column, row);
    if (p == nullptr) return nullptr;
  }
  const char* const end = p - 1;
  return *end == '\n' && columns_.size() == layout_.fields ? p : SkipRest<false>(end);
}
#else
const char* CsvReader::ReadShapedRow(const char* text, std::size_t row) {
  return ReadPlainRow<false>(text, row);
}
#endif

/// A field of another shape than the one above, which it teaches. Returns the character after its separator.
const char* CsvReader::ReadUnlikeField(const char* p, Column& column, std::size_t row) {
  const bool last = &column == &columns_.back();
  const auto ends = [this, last](char c) {
    return c == layout_.separator || (last && (c == '\n' || c == '\r'));
  };
  if (column.use == Use::kNumber) {
    const char* const end = ParseDecimal(p, layout_.decimal, column.out[row]);
    if (end != nullptr && ends(*end)) {
      if (column.lessons > 0 && column.shape[*p == '-'].Learn(p, end + 1 - p, layout_.decimal))
        --column.lessons;
      return end + 1;
    }
  }
  const char* const end = ReadPlainField<false>(p, column, row);
  return end != nullptr && ends(*end) ? end + 1 : nullptr;
}

/// A field that is no bare decimal number: blanks around it, an exponent, a date, a column not used. Returns
/// its end, nullptr if it is not plain either.
template <bool kBlanks>
const char* CsvReader::ReadPlainField(const char* p, const Column& column, std::size_t row) const {
  const char separator = layout_.separator;
  while (*p == ' ' || (kBlanks && *p == '\t')) ++p;
  if (column.use == Use::kNumber) {
    p = ParseDecimalFinite(p, layout_.decimal, column.out[row]);
    if (p == nullptr) return nullptr;
    while (!kBlanks && *p == ' ') ++p;
    return p;
  }
  const char* const start = p;
  while (*p != separator && *p != '\n' && *p != '"' && !(kBlanks && *p == '\t')) ++p;
  if (*p == '"' || column.use == Use::kSkip) return *p == '"' ? nullptr : p;
  const auto time = ParseDateTime({start, static_cast<std::size_t>(p - start)});
  if (!time) return nullptr;
  column.out[row] = *time;
  return p;
}

/// From the end of the last field used to the start of the next line; nullptr if the number of fields is
/// wrong or there are quotes.
template <bool kBlanks>
const char* CsvReader::SkipRest(const char* p) const {
  const char separator = layout_.separator;
  for (std::size_t field = columns_.size(); field < layout_.fields; ++field) {
    if (*p != separator) return nullptr;
    while (kBlanks && *p == ' ') ++p;
    for (p += !kBlanks; *p != separator && *p != '\n'; ++p)
      if (*p == '"') return nullptr;
  }
  if (layout_.ragged && *p == separator) p = static_cast<const char*>(::rawmemchr(p, '\n'));
  while (kBlanks && *p == ' ') ++p;
  p += *p == '\r';
  return *p == '\n' ? p + 1 : nullptr;
}

bool CsvReader::FieldCountFits(std::size_t count) const {
  if (layout_.ragged) return count >= layout_.fields;
  if (count == layout_.fields + 1) return fields_.back().empty();
  if (count + 1 == layout_.fields) return layout_.names.back().empty();
  return count == layout_.fields;
}

/// A row that is not plain: false if it cannot be delivered.
bool CsvReader::ReadOddRow(std::string_view line, std::size_t row, SampleBlock& block) {
  if (Trimmed(line).empty()) return false;
  SplitFields(line, layout_.separator, fields_);
  if (!FieldCountFits(fields_.size())) {
    Reject("", fmt::format("{} fields: {}", fields_.size(), line.substr(0, kLongestQuote)),
           fmt::format("{}{} fields", layout_.ragged ? "at least " : "", layout_.fields));
    return false;
  }
  if (plan_.time != ColumnPlan::kAbsent) {
    const auto index = static_cast<std::size_t>(plan_.time);
    const std::string_view field = index < fields_.size() ? fields_[index] : std::string_view();
    const auto time = TimeOf(field);
    if (!time) {
      Reject(layout_.names[index], field, time_is_text_ ? "date and time" : "time as a number");
      return false;
    }
    block.time[row] = *time;
  }
  for (std::size_t c = 0; c < columns_.size(); ++c)
    if (columns_[c].signal >= 0)
      ReadOddValue(c < fields_.size() ? fields_[c] : "", static_cast<std::size_t>(columns_[c].signal), row,
                   block);
  return true;
}

void CsvReader::ReadOddValue(std::string_view field, std::size_t signal, std::size_t row,
                             SampleBlock& block) {
  const auto number = FieldNumber(field, layout_.decimal);
  const bool finite = number && std::isfinite(*number);
  block.signal[signal][row] = finite ? *number : kNaN;
  if (finite) return;
  block.quality[signal][row] |= quality::kMissing;
  ++counters_.flagged[FlagBit(quality::kMissing)];
  if (number || IsMissingMark(field)) return;
  AddFinding(counters_,
             {line_, layout_.names[plan_.column[signal]], std::string(field.substr(0, kLongestQuote)),
              fmt::format("number in {}", signals_[signal].unit)});
}

void CsvReader::Reject(const std::string& column, std::string_view found, const std::string& expected) {
  ++counters_.rejected_rows;
  ++row_number_;
  AddFinding(counters_, {line_, column, std::string(found.substr(0, kLongestQuote)), expected});
}

/// Signals that share a column with another one or the time, and optional signals the log does not have.
void CsvReader::FillDerived(SampleBlock& block, std::size_t rows) {
  for (std::size_t s = 0; s < signals_.size(); ++s) {
    const int column = plan_.column[s];
    if (column == ColumnPlan::kAbsent) {
      std::fill_n(block.signal[s].begin(), rows, kNaN);
      std::fill_n(block.quality[s].begin(), rows, quality::kMissing);
      continue;
    }
    const int writer = columns_[column].signal;
    if (writer == static_cast<int>(s)) continue;
    block.signal[s] = writer == kTime ? block.time : block.signal[writer];
    if (writer != kTime) block.quality[s] = block.quality[writer];
  }
  if (plan_.time != ColumnPlan::kAbsent && !time_is_text_ && plan_.time_scale != 1.0)
    for (std::size_t row = 0; row < rows; ++row) block.time[row] *= plan_.time_scale;
}

}  // namespace hydroscope
