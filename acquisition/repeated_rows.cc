#include "acquisition/repeated_rows.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "acquisition/held_back.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsRemembered = 1 << 18;
constexpr std::int64_t kRowsToProve = 32;
constexpr int kChangingChannels = 2;
// As in QualityMonitor: white noise turns back at two changes of three, smooth motion at none.
constexpr std::int64_t kChangesToTellNoise = 100;
constexpr double kTurnsOfNoise = 0.3;

/// Of all values, each mixed in by the finaliser of MurmurHash3 (Appleby 2011).
std::uint64_t HashOf(const SampleBlock& block, std::size_t row) {
  std::uint64_t hash = 0;
  for (const std::vector<double>& values : block.signal) {
    hash = 31 * hash + std::bit_cast<std::uint64_t>(values[row]);
    hash = (hash ^ (hash >> 33)) * 0xff51afd7ed558ccdULL;
    hash = (hash ^ (hash >> 33)) * 0xc4ceb9fe1a85ec53ULL;
    hash ^= hash >> 33;
  }
  return hash;
}

}  // namespace

RepeatedRows::RepeatedRows(std::size_t signals) : channels_(signals), latest_(kRowsRemembered) {
  hashes_.reserve(kRowsRemembered);
}

void RepeatedRows::Inspect(SampleBlock& block) {
  const std::size_t held = held_.rows();
  AppendRows(block, held_);
  std::swap(block, held_);
  for (std::size_t row = held; row < block.rows(); ++row, ++row_) {
    const std::uint64_t hash = HashOf(block, row);
    if (Changes(block, row)) Compare(hash);
    latest_[hash % kRowsRemembered] = static_cast<std::uint32_t>(row_);
    if (hashes_.size() < kRowsRemembered)
      hashes_.push_back(hash);
    else
      hashes_[static_cast<std::size_t>(row_) % kRowsRemembered] = hash;
    if (same_ < kRowsToProve) continue;
    const std::size_t flagged = same_ == kRowsToProve ? std::min<std::size_t>(kRowsToProve, row + 1) : 1;
    copies_ += static_cast<std::int64_t>(flagged);
    for (auto& flags : block.quality)
      for (std::size_t back = 0; back < flagged; ++back) flags[row - back] |= quality::kDuplicate;
  }
  held_ = TakeLastRows(block, std::min<std::size_t>(kRowsToProve - 1, block.rows()));
}

void RepeatedRows::Flush(SampleBlock& block) {
  block = std::move(held_);
  held_ = {};
}

/// Whether enough channels with noise differ from the row before.
bool RepeatedRows::Changes(const SampleBlock& block, std::size_t row) {
  int changing = 0;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    Channel& channel = channels_[c];
    const double value = block.signal[c][row], step = value - channel.last;
    channel.last = value;
    if (!(step * step > 0)) continue;
    ++channel.changes;
    channel.reversals += step * channel.step < 0;
    channel.step = step;
    changing +=
        channel.changes >= kChangesToTellNoise &&
        static_cast<double>(channel.reversals) >= kTurnsOfNoise * static_cast<double>(channel.changes);
  }
  return changing >= kChangingChannels;
}

void RepeatedRows::Compare(std::uint64_t hash) {
  if (distance_ > 0 && IsAt(row_ - distance_, hash)) {
    ++same_;
    return;
  }
  const std::uint32_t back = static_cast<std::uint32_t>(row_) - latest_[hash % kRowsRemembered];
  const bool known = IsAt(row_ - back, hash);
  distance_ = known ? back : 0;
  same_ = known ? 1 : 0;
}

/// Whether a row before this one, of those remembered, has the hash.
bool RepeatedRows::IsAt(std::int64_t row, std::uint64_t hash) const {
  return row >= 0 && row < row_ && row_ - row <= static_cast<std::int64_t>(hashes_.size()) &&
         hashes_[static_cast<std::size_t>(row) % kRowsRemembered] == hash;
}

}  // namespace hydroscope
