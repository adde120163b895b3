#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/aligner.h"

namespace hydroscope {

inline constexpr std::int64_t kMs = 1'000'000;
inline constexpr std::int64_t kStartMono = 1'000'000 * kMs, kStartWall = 1'700'000'000'000 * kMs;

inline Machine TwoAxes() {
  Machine machine;
  machine.name = "press";
  for (const auto& [name, unit] :
       std::vector<std::pair<std::string, std::string>>{{"p_A", "bar"}, {"z", "m"}, {"T_oil", "degC"}}) {
    machine.signals.emplace_back();
    machine.signals.back().name = name;
    machine.signals.back().unit = unit;
  }
  machine.live = LiveSpec{.grid_period = 1e-3, .axes = {"a", "b"}, .sources = {}};
  return machine;
}

/// Sends rows of p_A and z of axis 0: p_A = sequence bar, z = sequence mm / 1000.
struct AlignerBench {
  Machine machine = TwoAxes();
  Aligner aligner{machine, AlignerOptions{}, {kStartMono, kStartWall}};
  std::int64_t now = kStartMono;  ///< ns; row s of the sender is taken at kStartMono + s ms
  std::uint64_t session = 7;
  std::int64_t sender_epoch = 5'000'000 * kMs;  ///< the sender's clock at its row 0
  SampleBlock got;                              ///< everything of axis 0 so far

  AlignerBench() { got.Resize(3, 0); }

  SampleBatch Rows(std::uint64_t first, std::size_t rows) const {
    SampleBatch batch{.session = session,
                      .first_sequence = first,
                      .source_time_ns = sender_epoch + static_cast<std::int64_t>(first) * kMs,
                      .period_ns = kMs,
                      .requested = {},
                      .received = {now, 0},
                      .channels = {0, 1},
                      .rows = rows,
                      .values = {}};
    for (std::size_t r = 0; r < rows; ++r) {
      batch.values.push_back(static_cast<double>(first + r));
      batch.values.push_back(static_cast<double>(first + r) * 1e-3);
    }
    return batch;
  }
  void Collect() {
    SampleBlock block;
    while (aligner.Take(0, block)) {
      got.time.insert(got.time.end(), block.time.begin(), block.time.end());
      for (std::size_t s = 0; s < 3; ++s) {
        got.signal[s].insert(got.signal[s].end(), block.signal[s].begin(), block.signal[s].end());
        got.quality[s].insert(got.quality[s].end(), block.quality[s].begin(), block.quality[s].end());
      }
    }
  }
  void Add(const SampleBatch& batch) {
    aligner.Add(0, batch);
    Collect();
  }
  void Wait(double seconds) {
    for (const std::int64_t end = now + std::llround(seconds * 1e9); now < end; now += 10 * kMs) {
      aligner.Advance(now);
      Collect();
    }
  }
  /// Batches of ten rows from `first` on, each sent when its last row was taken.
  void Stream(std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t s = first; s < last; s += 10) {
      now = std::max(now, kStartMono + static_cast<std::int64_t>(s + 9) * kMs);
      aligner.Advance(now);
      Add(Rows(s, 10));
    }
  }
  void Temperature(double celsius) {
    aligner.Add(1, {.session = 1,
                    .first_sequence = 0,
                    .requested = {now - kMs, 0},
                    .received = {now, 0},
                    .channels = {2},
                    .rows = 1,
                    .values = {celsius}});
  }
  const AlignerCounters& counters() const { return aligner.counters(0); }
  /// Sequence numbers given out, -1 for a missing row.
  std::vector<int> Sequences() const {
    std::vector<int> numbers;
    for (std::size_t k = 0; k < got.rows(); ++k)
      numbers.push_back(
          got.quality[0][k] & quality::kMissing ? -1 : static_cast<int>(std::lround(got.signal[0][k] / 1e5)));
    return numbers;
  }
  void ExpectTimesIncrease() const {
    for (std::size_t k = 1; k < got.rows(); ++k) ASSERT_GT(got.time[k], got.time[k - 1]) << k;
  }
};

inline std::vector<int> Count(int first, int last) {
  std::vector<int> numbers;
  for (int i = first; i < last; ++i) numbers.push_back(i);
  return numbers;
}

}  // namespace hydroscope
