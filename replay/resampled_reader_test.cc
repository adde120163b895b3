#include "replay/resampled_reader.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

/// A ramp of 3 units a second in rows `period` s apart, with a gap of a second after `gap` rows.
class Ramp : public LogReader {
 public:
  Ramp(double period, int rows, int gap = -1) : period_(period), rows_(rows), gap_(gap) {}
  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) override {
    block.Resize(1, max_rows);
    std::size_t row = 0;
    for (; row < max_rows && next_ < rows_; ++row, ++next_) {
      const bool after_gap = next_ == gap_;
      if (after_gap) late_ = 1;
      block.time[row] = next_ * period_ + late_;
      block.signal[0][row] = 3 * block.time[row];
      block.quality[0][row] = after_gap ? quality::kGap : next_ == 20 ? quality::kSpike : quality::kGood;
    }
    block.Resize(1, row);
    return row;
  }
  double Progress() const override { return 0; }
  double SamplePeriod() const override { return period_; }
  const LogCounters& counters() const override { return counters_; }

 private:
  double period_;
  int rows_, gap_, next_ = 0;
  double late_ = 0;
  LogCounters counters_;
};

SampleBlock ReadAll(LogReader& reader, std::size_t at_once) {
  SampleBlock all, part;
  all.Resize(1, 0);
  while (const std::size_t rows = reader.Read(part, at_once).value())
    for (std::size_t k = 0; k < rows; ++k) {
      all.time.push_back(part.time[k]);
      all.signal[0].push_back(part.signal[0][k]);
      all.quality[0].push_back(part.quality[0][k]);
    }
  return all;
}

TEST(ResampledReader, PutsRowsOnTheGridOfTheLogsBefore) {
  std::string note;
  const auto reader = AtPeriod(std::make_unique<Ramp>(0.0118, 2000), 0.0102, note);
  EXPECT_EQ(reader->SamplePeriod(), 0.0102);
  EXPECT_NE(note.find("11.8 ms"), std::string::npos) << note;
  const SampleBlock all = ReadAll(*reader, 700);
  ASSERT_EQ(all.rows(), static_cast<std::size_t>(1999 * 0.0118 / 0.0102) + 1);
  for (std::size_t k = 0; k < all.rows(); ++k) {
    ASSERT_NEAR(all.time[k], static_cast<double>(k) * 0.0102, 1e-9);
    ASSERT_NEAR(all.signal[0][k], 3 * all.time[k], 1e-9);
  }
}

TEST(ResampledReader, ABadValueSpoilsTheRowsBesideItAndAGapBeginsTheGridAnew) {
  std::string note;
  const SampleBlock all = ReadAll(*AtPeriod(std::make_unique<Ramp>(0.0118, 100, 50), 0.0102, note), 7);
  int spikes = 0, gaps = 0;
  for (std::size_t k = 0; k < all.rows(); ++k) {
    spikes += (all.quality[0][k] & quality::kSpike) != 0;
    gaps += (all.quality[0][k] & quality::kGap) != 0;
    if (all.quality[0][k] & quality::kGap) {
      EXPECT_NEAR(all.time[k], 50 * 0.0118 + 1, 1e-12);
    }
    EXPECT_FALSE(all.time[k] > 49 * 0.0118 + 1e-9 && all.time[k] < 50 * 0.0118 + 1 - 1e-9)
        << "inside the gap";
  }
  EXPECT_GE(spikes, 2);
  EXPECT_LE(spikes, 3);
  EXPECT_EQ(gaps, 1);
}

TEST(ResampledReader, LeavesLogsAloneThatNeedItNotOrDifferTooMuch) {
  for (const double period : {0.0102, 0.0104, 0.02, 0.0}) {
    std::string note;
    EXPECT_EQ(AtPeriod(std::make_unique<Ramp>(0.0102, 10), period, note)->SamplePeriod(), 0.0102) << period;
    EXPECT_EQ(note, "");
  }
}

}  // namespace
}  // namespace hydroscope
