#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// A row of the journal as a DDS reader got it.
struct HeardRow {
  std::int64_t sequence = 0;
  std::string alarm, comment;
};

/// A reader of the DDS feed's alarm events on the loopback, in a thread of its own.
class AlarmListener {
 public:
  static constexpr const char* kTopic = "hydroscope";

  static Result<std::unique_ptr<AlarmListener>> Create(int domain);
  virtual ~AlarmListener() = default;
  /// Whether a feed is there.
  virtual bool matched() const = 0;
  /// In the order in which they came.
  virtual std::vector<HeardRow> rows() const = 0;
  /// Health of a machine as its finding told it last, 'F' say; ' ' if it did not.
  virtual char HealthOf(const std::string& machine) const = 0;
};

}  // namespace hydroscope
