#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "replay/byte_source.h"
#include "replay/column_plan.h"
#include "replay/field_shape.h"
#include "replay/log_layout.h"
#include "replay/log_reader.h"
#include "replay/time_check.h"

namespace hydroscope {

/// Reads a text log row by row. Rows of plain numbers take a quick way without looking at the line as a
/// whole; any row that is not plain (quotes, empty fields, texts, wrong number of fields) is cut into fields
/// and judged. A date or time of day as time column gives s since 1970-01-01 UTC or s of the day.
class CsvReader : public LogReader {
 public:
  /// `origin` stands in messages (the path).
  static Result<std::unique_ptr<CsvReader>> Open(std::unique_ptr<ByteSource> source, const Machine& machine,
                                                 const std::string& origin);

  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) override;
  double Progress() const override { return lines_.Progress(); }
  double SamplePeriod() const override { return sample_period_; }
  const LogCounters& counters() const override { return counters_; }
  const LogLayout& layout() const { return layout_; }

 private:
  /// What becomes of one column of the log, in order of columns.
  enum class Use : unsigned char { kSkip, kNumber, kTimeText };
  struct Column {
    Use use = Use::kSkip;
    int signal = kNone;        ///< index of the signal it is written to; kTime for the time
    double* out = nullptr;     ///< where the present block keeps it
    std::ptrdiff_t width = 0;  ///< of the field last read, with its separator
    FieldShape shape[2] = {};  ///< of a number without and with a sign
    int lessons = 0;           ///< how often shapes may still be learned in this block
  };
  static constexpr int kTime = -1;
  static constexpr int kNone = -2;

  CsvReader(std::unique_ptr<ByteSource> source, const Machine& machine, const std::string& origin)
      : origin_(origin), signals_(machine.signals), lines_(std::move(source), origin) {}

  Status Prepare(const LogFormat& format);
  void MakeColumns();
  Status FindSamplePeriod(const LogFormat& format);
  std::optional<double> TimeOf(std::string_view field) const;

  void PointInto(SampleBlock& block);
  template <bool kBlanks>
  const char* ReadPlainRow(const char* text, std::size_t row);
  template <bool kBlanks>
  const char* ReadPlainField(const char* p, const Column& column, std::size_t row) const;
  const char* ReadShapedRow(const char* text, std::size_t row);
  const char* ReadUnlikeField(const char* p, Column& column, std::size_t row);
  static const char* NextStart(const char* start, const char* next, const char* guess, Column& column);
  template <bool kBlanks>
  const char* SkipRest(const char* p) const;
  std::size_t ReadLines(SampleBlock& block, std::size_t row, std::size_t max_rows);
  bool ReadOddRow(std::string_view line, std::size_t row, SampleBlock& block);
  bool FieldCountFits(std::size_t count) const;
  void ReadOddValue(std::string_view field, std::size_t signal, std::size_t row, SampleBlock& block);
  void Reject(const std::string& column, std::string_view found, const std::string& expected);
  void FillDerived(SampleBlock& block, std::size_t rows);

  std::string origin_;
  std::vector<SignalSpec> signals_;
  LineBuffer lines_;
  LogLayout layout_;
  ColumnPlan plan_;
  std::vector<Column> columns_;  ///< up to the last column used
  bool shaped_ = false;          ///< rows are read by the shapes of their fields
  bool time_is_text_ = false;
  double sample_period_ = 0;  ///< s
  TimeChecker time_check_{0};
  LogCounters counters_;
  std::int64_t line_ = 0;        ///< 1-based, of the line being read
  std::int64_t row_number_ = 0;  ///< rows seen, rejected ones included; the clock of logs without time column
  std::vector<std::string_view> fields_;
};

}  // namespace hydroscope
