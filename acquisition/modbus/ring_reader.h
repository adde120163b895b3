#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/modbus/read_plan.h"
#include "acquisition/modbus/settings.h"
#include "acquisition/sequence_monitor.h"
#include "acquisition/source.h"

namespace hydroscope {

/// Follows a ring of samples in the registers of a controller: which records are new, whether what was read
/// is what was expected, which were overwritten before they were read. Knows no connection: the caller reads
/// what it asks for.
class RingReader {
 public:
  RingReader(const ModbusRingSpec& spec, std::vector<PlannedValue> values);

  /// Registers that tell session, newest sequence and time; nullopt if they do not fit one request.
  struct Range {
    int first = 0, count = 0;
  };
  static std::optional<Range> Head(const ModbusRingSpec& spec);

  /// Consecutive records to be read in one request.
  struct Request {
    Range registers;
    std::uint64_t sequence = 0;  ///< of the first record
    std::size_t records = 0;
  };
  /// What is new according to the head, oldest first. At the first contact, and with a new session, only the
  /// newest record.
  std::vector<Request> Begin(std::span<const std::uint16_t> head);

  using Emit = std::function<void(SampleBatch&&)>;
  /// What was read for `request`, at those times. False if the records are not those expected: the controller
  /// overwrote them (counted as lost) or wrote nonsense (counted as malformed).
  bool Receive(const Request& request, std::span<const std::uint16_t> registers, HostTime requested,
               HostTime received, const Emit& emit);

  /// Counters only, as BatchAssembler::counters.
  SourceStatus counters() const;
  std::uint64_t newest() const { return newest_; }

 private:
  void BeginSession(std::uint32_t session, std::uint32_t newest);
  SampleBatch Decode(std::uint64_t first, std::span<const std::uint16_t> records) const;

  ModbusRingSpec spec_;
  std::vector<PlannedValue> values_;
  std::vector<std::uint16_t> channels_;
  std::int64_t period_ns_;
  std::optional<std::uint32_t> session_;
  std::uint64_t life_ = 0;    ///< sessions seen, for a controller whose session number stays the same
  std::uint64_t newest_ = 0;  ///< sequence without wrap-around
  std::uint64_t next_ = 0;    ///< first sequence not yet asked for
  std::int64_t newest_time_ns_ = 0;
  SequenceMonitor sequence_;
  SourceStatus counters_;
};

}  // namespace hydroscope
