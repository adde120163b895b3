#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "core/result.h"

namespace hydroscope {

/// Path of a file in a folder of its own; both are removed with the last that holds it.
using KeptFile = std::shared_ptr<const std::string>;

/// Files that came to the page, below a folder.
class Uploads {
 public:
  static constexpr std::int64_t kMostTogether = std::int64_t{6} << 30;  ///< bytes

  /// Makes the folder. It has to outlive what is kept. `most`: bytes of all files together.
  explicit Uploads(std::string folder, std::int64_t most = kMostTogether);

  /// Whether there is room for one of this size beside what is kept and what is on its way. Errors: too much together, a full disk.
  Status MayTake(std::int64_t bytes) const;

  /// Where the next one is to be written to. It belongs to who writes it until it is kept.
  std::string NewFile();
  /// Keeps it under the plain part of a name (PlainFileName). Errors: nothing is left of the name, or it cannot be kept.
  Result<KeptFile> Keep(const std::string& file, const std::string& name);

 private:
  const std::string folder_;
  const std::int64_t most_;
  std::atomic<int> made_ = 0, kept_ = 0;
};

}  // namespace hydroscope
