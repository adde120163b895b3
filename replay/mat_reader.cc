#include "replay/mat_reader.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/told_error.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kFirstRows = 1000;
constexpr std::int64_t kSliceRows = 16384;

}  // namespace

Result<std::unique_ptr<MatReader>> MatReader::Open(const std::string& path, const Machine& machine) {
  auto columns = TRY(MatColumns::Open(path));
  std::unique_ptr<MatReader> reader(new MatReader);
  reader->columns_ = std::move(columns);
  TRY(reader->Prepare(path, machine));
  return reader;
}

Status MatReader::Prepare(const std::string& path, const Machine& machine) {
  layout_.names = columns_->names();
  plan_ = TRY(PlanColumns(layout_, machine, path, counters_));
  signals_ = machine.signals.size();
  slice_.resize(signals_);
  TRY(CheckLengths(path));
  TRY(FindSamplePeriod(path, machine.log));
  return {};
}

Status MatReader::CheckLengths(const std::string& path) {
  int reference = plan_.time;
  for (const int column : plan_.column) {
    if (column == ColumnPlan::kAbsent) continue;
    if (reference == ColumnPlan::kAbsent) reference = column;
    const std::int64_t rows = columns_->rows(static_cast<std::size_t>(column));
    const std::int64_t expected = columns_->rows(static_cast<std::size_t>(reference));
    if (rows != expected)
      return BadInput(
          Tell("log '{}': '{}' has {} values, '{}' has {}; expected as many in all columns that are used",
               "Log '{}': '{}' hat {} Werte, '{}' hat {}; erwartet gleich viele in allen benutzten Spalten",
               path, layout_.names[column], rows, layout_.names[reference], expected));
  }
  rows_ = reference == ColumnPlan::kAbsent ? 0 : columns_->rows(static_cast<std::size_t>(reference));
  return {};
}

Status MatReader::FindSamplePeriod(const std::string& path, const LogFormat& format) {
  if (format.sample_period) {
    sample_period_ = *format.sample_period;
    time_check_ = TimeChecker(sample_period_);
    return {};
  }
  const auto column = static_cast<std::size_t>(plan_.time);
  std::vector<double> times(static_cast<std::size_t>(std::min(rows_, kFirstRows)));
  TRY(columns_->Read(column, 0, std::ssize(times), times.data()));
  std::erase_if(times, [](double time) { return !std::isfinite(time); });
  for (double& time : times) time *= plan_.time_scale;
  sample_period_ = SamplePeriodOf(times);
  time_check_ = TimeChecker(sample_period_, LongestStep(times, sample_period_));
  if (sample_period_ > 0) return {};
  return NoSamplePeriod(path, layout_.names[column], times, format.time_unit);
}

Status MatReader::LoadSlice() {
  slice_first_ = next_;
  slice_rows_ = std::min(kSliceRows, rows_ - next_);
  const auto size = static_cast<std::size_t>(slice_rows_);
  const auto read = [&](int column, std::vector<double>& out) -> Status {
    out.resize(size);
    return columns_->Read(static_cast<std::size_t>(column), slice_first_, slice_rows_, out.data());
  };
  if (plan_.time != ColumnPlan::kAbsent) TRY(read(plan_.time, time_slice_));
  for (std::size_t s = 0; s < signals_; ++s) {
    if (plan_.column[s] == ColumnPlan::kAbsent) continue;
    TRY(read(plan_.column[s], slice_[s]));
  }
  return {};
}

Result<std::size_t> MatReader::Read(SampleBlock& block, std::size_t max_rows) {
  block.Resize(signals_, max_rows);
  std::size_t row = 0;
  while (row < max_rows && next_ < rows_) {
    if (next_ >= slice_first_ + slice_rows_) {
      if (const Status slice = LoadSlice(); !slice) {
        if (row == 0) return tl::unexpected(slice.error());
        break;  // the next call meets the same error
      }
    }
    const auto from = static_cast<std::size_t>(next_ - slice_first_);
    const bool timed = plan_.time != ColumnPlan::kAbsent;
    const double time =
        timed ? time_slice_[from] * plan_.time_scale : static_cast<double>(next_) * sample_period_;
    ++next_;
    if (!std::isfinite(time)) {
      ++counters_.rejected_rows;
      AddFinding(counters_, {next_, layout_.names[plan_.time], fmt::format("{}", time), "time as a number"});
      continue;
    }
    block.time[row] = time;
    TakeRow(from, row, block);
    ++row;
  }
  block.Resize(signals_, row);
  ConvertToSi(plan_, row, block);
  time_check_.Check(block, counters_);
  counters_.rows += static_cast<std::int64_t>(row);
  return row;
}

void MatReader::TakeRow(std::size_t from, std::size_t row, SampleBlock& block) {
  for (std::size_t s = 0; s < signals_; ++s) {
    const bool absent = plan_.column[s] == ColumnPlan::kAbsent;
    const double value = absent ? kNaN : slice_[s][from];
    const bool finite = std::isfinite(value);
    block.signal[s][row] = finite ? value : kNaN;
    block.quality[s][row] = finite ? quality::kGood : quality::kMissing;
    if (!finite && !absent) ++counters_.flagged[FlagBit(quality::kMissing)];
  }
}

double MatReader::Progress() const {
  return rows_ > 0 ? static_cast<double>(next_) / static_cast<double>(rows_) : 1.0;
}

}  // namespace hydroscope
