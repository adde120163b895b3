#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "storage/database.h"
#include "storage/file_identity.h"

namespace hydroscope {

/// A trend as a picture of a given width shows it.
struct TrendPicture {
  std::vector<TrendBin> bins;
  std::int64_t width = 1;  ///< strokes of a bin
  bool exact = true;       ///< false: only some strokes of each bin were looked at so far
};

/// Lowest and highest values for trends of any length. Up to kMostRead strokes SQLite finds them at once. For more, those of
/// every kBaseWidth strokes are collected once, in a thread, and kept (7 MB for ten million strokes): until they are there, a
/// picture rests on a few strokes of each bin, and `ready` is called when it is worth asking again. Safe from every thread.
class TrendCache {
 public:
  static constexpr std::int64_t kMostRead = 50'000, kBaseWidth = 128;
  static constexpr std::size_t kMostKept = 24;  ///< parameters of machines
  static constexpr std::int64_t kGlance = 3;    ///< strokes of a bin that is only glanced at

  TrendCache(std::string database, std::function<void()> ready);
  ~TrendCache();

  /// Strokes first <= number < end in at most some `most_bins` bins. `database` is a handle of the caller's.
  Result<TrendPicture> Picture(const Database& database, std::int64_t machine, const std::string& parameter,
                               std::int64_t first, std::int64_t end, std::int64_t most_bins);

 private:
  using Key = std::pair<std::int64_t, std::string>;  ///< machine, parameter
  struct Base {
    std::vector<TrendBin> bins;  ///< full ones, in order, from stroke 0 on
    std::int64_t end = 0;        ///< stroke behind them
    bool wanted = false;         ///< waits to be collected
    std::uint64_t used = 0;
  };
  void Want(const Key& key);
  void Run();
  void ForgetIfReplaced();
  bool Collect(const Key& key, std::uint64_t generation);
  std::vector<TrendBin> Merged(const Base& base, std::int64_t first, std::int64_t end,
                               std::int64_t width) const;

  const std::string database_;
  const std::function<void()> ready_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::map<Key, Base> bases_;
  std::deque<Key> wanted_;
  FileIdentity file_;  ///< what was collected is of this file
  std::uint64_t used_ = 0, generation_ = 0;
  bool stop_ = false;
  std::thread thread_;
};

/// Bins of some `width` strokes of a database, of each the first `most`, asked for by several threads: a disk that has to look for
/// each piece answers them in the time of one.
Result<std::vector<TrendBin>> GlancedBins(const std::string& database, std::int64_t machine,
                                          const std::string& parameter, std::int64_t first, std::int64_t end,
                                          std::int64_t width, std::int64_t most);

/// Neighbouring bins of one run as one.
TrendBin JoinedBins(const TrendBin& a, const TrendBin& b);

}  // namespace hydroscope
