#include "page/watch/trend_cache.h"

#include <algorithm>
#include <cmath>
#include <future>

#include "core/constants.h"

namespace hydroscope {
namespace {

/// Strokes that are collected between two looks whether to stop.
constexpr std::int64_t kStrokesAtATime = 512 * TrendCache::kBaseWidth;
constexpr std::int64_t kReaders = 8;  ///< threads that glance

double WeightedMean(double a, std::int64_t a_weight, double b, std::int64_t b_weight) {
  if (a_weight == 0 || std::isnan(a)) return b;
  if (b_weight == 0 || std::isnan(b)) return a;
  return (a * static_cast<double>(a_weight) + b * static_cast<double>(b_weight)) /
         static_cast<double>(a_weight + b_weight);
}

}  // namespace

TrendBin JoinedBins(const TrendBin& a, const TrendBin& b) {
  TrendBin joined = a;
  joined.last = b.last;
  joined.end = b.end;
  joined.values = a.values + b.values;
  joined.low = std::fmin(a.low, b.low);  // of NaN and a number the number
  joined.high = std::fmax(a.high, b.high);
  joined.mean = WeightedMean(a.mean, a.values, b.mean, b.values);
  joined.std = WeightedMean(a.std, a.values, b.std, b.values);
  joined.oil_temperature =
      WeightedMean(a.oil_temperature, a.last - a.first + 1, b.oil_temperature, b.last - b.first + 1);
  return joined;
}

Result<std::vector<TrendBin>> GlancedBins(const std::string& database, std::int64_t machine,
                                          const std::string& parameter, std::int64_t first, std::int64_t end,
                                          std::int64_t width, std::int64_t most) {
  const std::int64_t part = ((end - first) / (width * kReaders) + 1) * width;
  std::vector<std::future<Result<std::vector<TrendBin>>>> parts;
  for (std::int64_t from = first; from < end; from += part)
    parts.push_back(std::async(std::launch::async, [&, from]() -> Result<std::vector<TrendBin>> {
      const auto opened = TRY(Database::OpenReadOnly(database));
      return opened.TrendBins(machine, parameter, from, std::min(end, from + part), width, most);
    }));
  std::vector<TrendBin> bins;
  for (auto& read : parts) {
    const auto more = TRY(read.get());
    bins.insert(bins.end(), more.begin(), more.end());
  }
  return bins;
}

TrendCache::TrendCache(std::string database, std::function<void()> ready)
    : database_(std::move(database)), ready_(std::move(ready)), thread_([this] { Run(); }) {}

TrendCache::~TrendCache() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

/// Under the lock.
void TrendCache::ForgetIfReplaced() {
  const FileIdentity now = FileIdentity::Of(database_);
  if (now == file_) return;
  file_ = now;
  ++generation_;
  bases_.clear();
  wanted_.clear();
}

Result<TrendPicture> TrendCache::Picture(const Database& database, std::int64_t machine,
                                         const std::string& parameter, std::int64_t first, std::int64_t end,
                                         std::int64_t most_bins) {
  TrendPicture picture;
  picture.width =
      std::max<std::int64_t>(1, (end - first + most_bins - 1) / std::max<std::int64_t>(most_bins, 1));
  std::int64_t from = first;
  if (end - first > kMostRead) {
    const std::lock_guard lock(mutex_);
    ForgetIfReplaced();
    Base& base = bases_[{machine, parameter}];
    base.used = ++used_;
    if (end - base.end <= kMostRead) {
      picture.bins = Merged(base, first, end, picture.width);
      from = std::max(first, picture.bins.empty() ? first : picture.bins.back().last + 1);
    }
  }
  picture.exact = end - from <= kMostRead;
  if (picture.exact) {
    const auto bins = TRY(database.TrendBins(machine, parameter, from, end, picture.width));
    picture.bins.insert(picture.bins.end(), bins.begin(), bins.end());
  } else {
    picture.bins = TRY(GlancedBins(database_, machine, parameter, first, end, picture.width, kGlance));
    Want({machine, parameter});  // now: what is collected would have kept the disk from the glance
  }
  return picture;
}

void TrendCache::Want(const Key& key) {
  const std::lock_guard lock(mutex_);
  if (bases_[key].wanted) return;
  bases_[key].wanted = true;
  wanted_.push_back(key);
  wake_.notify_all();
}

std::vector<TrendBin> TrendCache::Merged(const Base& base, std::int64_t first, std::int64_t end,
                                         std::int64_t width) const {
  std::vector<TrendBin> merged;
  const auto begin =
      std::lower_bound(base.bins.begin(), base.bins.end(), first,
                       [](const TrendBin& bin, std::int64_t stroke) { return bin.first < stroke; });
  for (auto bin = begin; bin != base.bins.end() && bin->last < end; ++bin) {
    const bool joins =
        !merged.empty() && merged.back().run == bin->run && bin->last - merged.back().first < width;
    if (joins)
      merged.back() = JoinedBins(merged.back(), *bin);
    else
      merged.push_back(*bin);
  }
  return merged;
}

void TrendCache::Run() {
  for (;;) {
    Key key;
    std::uint64_t generation = 0;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return stop_ || !wanted_.empty(); });
      if (stop_) return;
      key = wanted_.front();
      wanted_.pop_front();
      generation = generation_;
    }
    while (Collect(key, generation)) {
    }
    ready_();
  }
}

/// The next strokes of a base; false: there are no more, or it is not wanted any more.
bool TrendCache::Collect(const Key& key, std::uint64_t generation) {
  std::int64_t from = 0;
  {
    const std::lock_guard lock(mutex_);
    if (stop_ || generation != generation_) return false;
    from = bases_[key].end;
  }
  const auto database = Database::OpenReadOnly(database_);
  const auto end = database ? database->EndSequence(key.first) : Result<std::int64_t>(0);
  // The last bin grows still.
  const std::int64_t to = std::min(from + kStrokesAtATime, end.value_or(0) - kBaseWidth);
  const auto bins = database && to > from ? database->TrendBins(key.first, key.second, from, to, kBaseWidth)
                                          : Result<std::vector<TrendBin>>(std::vector<TrendBin>());
  const std::lock_guard lock(mutex_);
  if (generation != generation_) return false;
  Base& base = bases_[key];
  if (!bins || bins->empty()) {
    base.wanted = false;
    return false;
  }
  base.bins.insert(base.bins.end(), bins->begin(), bins->end());
  base.end = to;
  if (bases_.size() > kMostKept) {
    const auto oldest = std::min_element(bases_.begin(), bases_.end(), [](const auto& a, const auto& b) {
      return a.second.used < b.second.used;
    });
    if (oldest->first != key && !oldest->second.wanted) bases_.erase(oldest);
  }
  return true;
}

}  // namespace hydroscope
