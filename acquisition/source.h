#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/clock.h"
#include "core/result.h"
#include "core/told.h"

namespace hydroscope {

/// Consecutive samples of some channels, as one message or one request of a source delivered them.
struct SampleBatch {
  std::uint64_t writer = 0;          ///< who sent it, as the source can tell; 0 where there is only one
  std::uint64_t session = 0;         ///< the sender's life: another session begins another count
  std::uint64_t first_sequence = 0;  ///< of row 0; rows count up by one
  std::int64_t source_time_ns = 0;   ///< the sender's clock at row 0; 0 = the sender has none
  std::int64_t period_ns = 0;        ///< between rows; 0 = a single reading
  HostTime requested;                ///< before the request; equal to `received` for a source that pushes
  HostTime received;
  std::vector<std::uint16_t> channels;  ///< indices into the list of channels the source was made with
  std::size_t rows = 0;
  std::vector<double> values;  ///< [row * channels.size() + column], as sent: before scale, offset and unit
};

/// What a source has to say of itself.
struct SourceStatus {
  std::string name;        ///< "dds hydroscope/press/samples", "modbus 127.0.0.1:1502"
  bool connected = false;  ///< a sender is there
  Told state;              ///< one sentence for people: what it does now, or what is wrong and what to do
  HostTime last_received;  ///< zero if never
  std::int64_t batches = 0, rows = 0;
  std::int64_t lost_rows = 0;  ///< known from sequence numbers
  std::int64_t duplicate_rows = 0, reordered_batches = 0;
  std::int64_t reconnects = 0, malformed = 0, timeouts = 0, exceptions = 0;
  std::int64_t refused = 0;                           ///< messages of senders that are not allowed
  std::map<std::uint64_t, std::string> senders = {};  ///< who is there, by SampleBatch::writer, in words
};

/// Where live samples come from. Start begins delivery on a thread of the source's own; `sink` may be called
/// from that thread at any time until Stop returns, and must not block. A source that loses its sender keeps
/// trying until Stop; that is a status, not an error.
class Source {
 public:
  using Sink = std::function<void(SampleBatch&&)>;

  virtual ~Source() = default;
  /// Errors: settings that can never work (no such interface, register beyond the map).
  virtual Status Start(Sink sink) = 0;
  virtual SourceStatus status() const = 0;
  virtual void Stop() = 0;
};

}  // namespace hydroscope
