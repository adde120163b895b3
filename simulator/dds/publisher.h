#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/result.h"
#include "dds/participant.h"

namespace hydroscope {

/// Publishes samples and their layout (docs/live_protocol.md).
class SamplePublisher {
 public:
  static constexpr std::size_t kMostValues = 8192;  ///< of one message, hydroscope_live.idl

  struct Options {
    DdsNetwork network;
    std::string topic = "hydroscope/samples";
    std::uint64_t session = 0;
    std::vector<std::string> channels, units;  ///< of equal length
    std::string name = "simulated press";      ///< of the participant, for who looks at the network
  };
  static Result<std::unique_ptr<SamplePublisher>> Create(const Options& options);
  virtual ~SamplePublisher() = default;

  /// Rows of all channels, row after row. False: not sent, a reader is too slow or the batch too large.
  virtual bool Write(std::uint64_t first_sequence, std::int64_t source_time_ns, std::int64_t period_ns,
                     std::uint32_t rows, const std::vector<double>& values) = 0;
  /// Readers of the samples at present.
  virtual int readers() const = 0;
  /// Waits until all readers have what was sent. False: not within `seconds`.
  virtual bool Drain(double seconds) = 0;
};

}  // namespace hydroscope
