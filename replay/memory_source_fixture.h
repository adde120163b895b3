#pragma once

#include <memory>
#include <string>
#include <utility>

#include "replay/byte_source.h"

namespace hydroscope {

/// A log that lies in memory.
class MemorySource : public ByteSource {
 public:
  explicit MemorySource(std::string bytes) : bytes_(std::move(bytes)) {}
  Result<std::size_t> Read(char* data, std::size_t size) override {
    const std::size_t got = bytes_.copy(data, size, at_);
    at_ += got;
    return got;
  }
  double Progress() const override {
    return bytes_.empty() ? 1.0 : static_cast<double>(at_) / static_cast<double>(bytes_.size());
  }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

}  // namespace hydroscope
