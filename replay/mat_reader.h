#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "replay/column_plan.h"
#include "replay/log_layout.h"
#include "replay/log_reader.h"
#include "replay/time_check.h"

struct _mat_t;
struct matvar_t;

namespace hydroscope {

/// True if a file begins like a MAT file of version 5...7 or 7.3.
bool IsMatFile(const std::string& path);

/// The numeric columns of a MAT file (v5 to v7.3, through matio): vectors under their names, fields of
/// structs under the field's name, columns of a matrix M as "M(1)", "M(2)", ... (rows, if it is wider than
/// long); each also by its 1-based number in the file. Scalars, texts, complex numbers and matrices of more
/// than 10 000 columns are left out. Variables are read in slices; only structs and variables compressed in
/// the old format (v5...7) have to be read as a whole, as far as that is not many times the file.
class MatColumns {
 public:
  static Result<std::unique_ptr<MatColumns>> Open(const std::string& path);
  ~MatColumns();
  MatColumns(const MatColumns&) = delete;
  MatColumns& operator=(const MatColumns&) = delete;

  const std::vector<std::string>& names() const { return names_; }
  std::int64_t rows(std::size_t column) const { return columns_[column].rows; }
  /// Reads `count` numbers of a column from row `first` on. Integers become doubles.
  Status Read(std::size_t column, std::int64_t first, std::int64_t count, double* out);

 private:
  struct Column {
    matvar_t* variable = nullptr;  ///< owned by variables_
    bool held = false;             ///< the data are in memory
    std::int64_t start = 0;        ///< element of row 0
    std::int64_t stride = 1;       ///< elements from row to row
    std::int64_t rows = 0;
  };
  explicit MatColumns(std::string path) : path_(std::move(path)) {}
  void AddVariable(matvar_t* variable, const std::string& name, bool held);
  /// Takes the room that it needs in memory off what may be held. Error: there is not so much.
  Status Reserve(const matvar_t& variable);
  Status Hold(Column& column);

  std::string path_;
  _mat_t* file_ = nullptr;
  std::vector<matvar_t*> variables_;
  std::vector<Column> columns_;
  std::vector<std::string> names_;
  std::vector<unsigned char> slice_;
  double may_hold_ = 0;  ///< bytes in memory, beside those that are
};

/// Replays the columns of a MAT file.
class MatReader : public LogReader {
 public:
  static Result<std::unique_ptr<MatReader>> Open(const std::string& path, const Machine& machine);

  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) override;
  double Progress() const override;
  double SamplePeriod() const override { return sample_period_; }
  const LogCounters& counters() const override { return counters_; }

 private:
  MatReader() = default;
  Status Prepare(const std::string& path, const Machine& machine);
  Status CheckLengths(const std::string& path);
  Status FindSamplePeriod(const std::string& path, const LogFormat& format);
  Status LoadSlice();
  void TakeRow(std::size_t from, std::size_t row, SampleBlock& block);

  std::unique_ptr<MatColumns> columns_;
  LogLayout layout_;
  ColumnPlan plan_;
  std::size_t signals_ = 0;
  std::int64_t rows_ = 0;         ///< of the log
  std::int64_t slice_first_ = 0;  ///< row of the log at which the slice begins
  std::int64_t slice_rows_ = 0;
  std::int64_t next_ = 0;  ///< row of the log to be delivered next
  std::vector<double> time_slice_;
  std::vector<std::vector<double>> slice_;  ///< per signal
  double sample_period_ = 0;                ///< s
  TimeChecker time_check_{0};
  LogCounters counters_;
};

}  // namespace hydroscope
