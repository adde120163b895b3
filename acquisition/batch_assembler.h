#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/jump_guard.h"
#include "acquisition/sequence_monitor.h"
#include "acquisition/source.h"

namespace hydroscope {

inline constexpr std::uint16_t kLiveProtocolVersion = 1;

/// A layout as announced, docs/live_protocol.md.
struct LayoutMessage {
  std::uint16_t version = kLiveProtocolVersion;
  std::uint64_t session = 0;
  std::uint32_t layout_id = 0;
  std::vector<std::string> channels;
  std::uint64_t writer = 0;  ///< who sent it: not of the message, the library knows it
};

/// A batch as sent.
struct BatchMessage {
  std::uint16_t version = kLiveProtocolVersion;
  std::uint64_t session = 0;
  std::uint32_t layout_id = 0;
  std::uint64_t first_sequence = 0;
  std::int64_t source_time_ns = 0;
  std::int64_t period_ns = 0;
  std::uint32_t rows = 0;
  std::vector<double> values;
  std::uint64_t writer = 0;  ///< as above
};

/// Turns messages of any number of senders into batches of the wanted channels. Every field is checked; what
/// cannot be right is counted as malformed and left out. A session belongs to the writer it came from: the same
/// number from another one is another session. A batch that comes before its layout waits for it, bounded. One
/// whose rows are elsewhere than the sender's count is passed on, for the aligner to doubt, but counts nothing
/// here until the sender goes on there.
class BatchAssembler {
 public:
  /// `wanted`: name on the wire of each channel of the source, "" = not from here. One name may feed several channels.
  explicit BatchAssembler(std::vector<std::string> wanted);

  using Emit = std::function<void(SampleBatch&&)>;
  void Receive(const LayoutMessage& message, const Emit& emit);
  void Receive(BatchMessage&& message, HostTime received, const Emit& emit);

  /// Counters only: batches, rows, lost_rows, duplicate_rows, reordered_batches, malformed.
  SourceStatus counters() const;
  /// "" while all is well, else what is wrong with the messages, for people. A fault stands until sound batches have come for a
  /// minute, a missing channel until somebody who sends announces it.
  std::string complaint() const { return fault_.empty() ? Missing() : fault_; }

 private:
  static constexpr std::size_t kSessionsKept = 64;
  static constexpr std::size_t kWaitingKept = 256;
  static constexpr std::uint32_t kMostRows = 8192;

  struct Layout {
    std::size_t columns = 0;
    std::string example;                    ///< name of one of them
    std::vector<std::uint16_t> channels;    ///< channels that are delivered ...
    std::vector<std::size_t> from_columns;  ///< ... and the column of each
  };
  struct Session {
    std::map<std::uint32_t, Layout> layouts;
    SequenceMonitor sequence;
    JumpGuard jump;
    std::int64_t received = 0;  ///< ns, monotonic, newest batch that was where it was expected
    std::uint64_t used = 0;     ///< when, in messages
  };
  struct Waiting {
    BatchMessage message;
    HostTime received;
  };

  using SessionKey = std::pair<std::uint64_t, std::uint64_t>;  ///< writer, session

  Session& SessionOf(SessionKey key);
  SessionKey OldestOfTheBusiest() const;
  static bool IsElsewhere(const Session& session, const BatchMessage& message, std::int64_t now);
  void Malformed(std::string complaint);
  std::string Missing() const;
  void Deliver(Session& session, const Layout& layout, BatchMessage& message, HostTime received,
               const Emit& emit);

  std::vector<std::string> wanted_;
  std::map<SessionKey, Session> sessions_;
  std::vector<Waiting> waiting_;
  SourceStatus counters_;
  SourceStatus forgotten_;   ///< sequence counters of sessions no longer kept
  std::string fault_;        ///< of a message that could not be right; "" if none, or long ago
  std::int64_t faulty_ = 0;  ///< ns, monotonic: sound batches had come until the latest of these
  std::uint64_t messages_ = 0;
};

}  // namespace hydroscope
