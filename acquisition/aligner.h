#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/channel_owners.h"
#include "acquisition/clock_model.h"
#include "acquisition/source.h"
#include "core/records/sample_block.h"
#include "models/machine.h"

namespace hydroscope {

struct AlignerOptions {
  double lateness = 0.3;      ///< s a frame stays open for a row that others of its time have reached
  double settle = 0.2;        ///< s of a new sender's messages before its clock is trusted
  double longest_gap = 1.0;   ///< s written out as missing rows; a longer one is a jump of time
  double held_period = 0.1;   ///< s between single readings of a slow channel
  double held_periods = 2.0;  ///< periods after which a held reading is stale
  double future = 0.5;        ///< s ahead of its sender's clock beyond which a row is not believed
  double takeover = 0.5;      ///< s of silence after which another sender may go on in a sender's place
  bool host_clock = false;    ///< there are no fast channels: the host's clock makes the rows

  /// Settings that follow from the machine file.
  static AlignerOptions For(const Machine& machine);
};

/// What happened to the rows of one axis; nothing is dropped without a count.
struct AlignerCounters {
  std::int64_t rows = 0;                ///< given out
  std::int64_t missing_rows = 0;        ///< given out without a value that a fast channel should have had
  std::int64_t late_rows = 0;           ///< came after their frame was closed
  std::int64_t duplicate_rows = 0;      ///< came again
  std::int64_t contradicting_rows = 0;  ///< came again with another value
  std::int64_t reordered_batches = 0;
  std::int64_t future_rows = 0;         ///< not believed
  std::int64_t gaps = 0;                ///< jumps over more than the longest gap
  std::int64_t skipped_rows = 0;        ///< numbered rows within these jumps
  std::int64_t sessions = 0;            ///< lives of fast senders seen
  std::int64_t sequence_jumps = 0;      ///< the count of a sender went on elsewhere
  std::int64_t clock_jumps = 0;         ///< a sender's clock, or the time of the grid, was stepped
  std::int64_t slips = 0;               ///< a second fast sender was moved against the first by whole rows
  std::int64_t stale_values = 0;        ///< values of slow channels that were too old
  std::int64_t already_stored = 0;      ///< rows that an earlier life of the service had stored
  std::int64_t second_sender_rows = 0;  ///< rows of another sender than the one that is believed
};

/// What is known of one channel.
struct ChannelState {
  std::int64_t values = 0;                                       ///< received
  std::int64_t last_received = 0;                                ///< ns, monotonic; 0 = never
  double last_value = std::numeric_limits<double>::quiet_NaN();  ///< SI
};

/// What is known of one sender: a source's batches of one set of channels.
struct StreamState {
  int source = 0;
  std::size_t channels = 0;
  double period = 0;        ///< s; 0: single readings
  bool has_clock = false;   ///< the sender sends its time
  double clock_offset = 0;  ///< s, host's wall clock minus the sender's clock
  double drift = 0;         ///< host seconds per sender second, minus 1
  double delay = 0;         ///< s, newest message against the fastest one
  double worst_delay = 0;   ///< s, largest of these
  std::int64_t batches = 0;
};

/// Puts batches of different rates and clocks onto the uniform grid of each axis. Pure: the time is the
/// `received` of each batch and the argument of Advance; the same calls give the same rows.
///
///   Fast channels (batch period = grid period, or a whole fraction of it) go in by sequence number: row k of
///   the sender is row k of the grid, nothing is interpolated. The first sender of an axis carries its grid;
///   another one is anchored to it by the estimated clocks.
///   Slow channels hold their last reading; older than `held_periods` periods it is flagged stale.
///   A channel has one sender (ChannelOwners): what a second one sends is counted and left out until the first
///   has been silent for `takeover`.
///   A frame closes as soon as all fast senders reached it, or `lateness` after it was due: what is not there
///   then is missing and late. Silence beyond `longest_gap` gives no rows; the next row is flagged gap.
///
/// Times given out are host wall time by the clock pair of the start, moved at most 0.5 ms per s to follow
/// the sender's clock; they increase strictly, whatever clock is stepped.
class Aligner {
 public:
  /// `machine` must have a live section and outlive the aligner.
  Aligner(const Machine& machine, const AlignerOptions& options, HostTime start);
  ~Aligner();

  /// Rows that marks() of an earlier life name are not taken again, and times go on behind its last row
  /// unless a clock was stepped by more than 10 s.
  void RestoreMarks(int axis, const std::vector<std::uint8_t>& marks);
  /// A batch of source number `source`.
  void Add(int source, const SampleBatch& batch);
  /// Closes what is due by `now` (ns, monotonic). Call it every few ms, also when nothing comes.
  void Advance(std::int64_t now);
  /// Moves the rows that are ready into `block`; false if there are none.
  bool Take(int axis, SampleBlock& block);
  /// ns, monotonic: when the newest row given out was sampled, by its sender's clock as it is known now.
  std::int64_t NewestSampled(int axis) const;

  /// Which rows of which sender are among those taken, and the time of the last row.
  std::vector<std::uint8_t> marks(int axis) const;
  const AlignerCounters& counters(int axis) const;
  /// One per channel of LiveChannels(machine).
  const std::vector<ChannelState>& channels() const { return channels_; }
  std::vector<StreamState> streams() const;
  /// Who was heard lately, and whose channels are taken.
  std::vector<LiveSender> senders(std::int64_t now) const { return owners_.senders(now); }
  /// Senders of a channel at the same time.
  int senders_of(std::size_t channel, std::int64_t now) const { return owners_.count(channel, now); }
  /// Batches that cannot be right: unknown channel, wrong number of values.
  std::int64_t malformed() const { return malformed_; }

 private:
  struct Axis;
  struct Part;
  struct Stream;
  struct Column;

  void Take(int source, const SampleBatch& batch);
  void RefuseRows(const SampleBatch& batch, const std::vector<std::size_t>& columns);
  Stream* FindStream(int source, const SampleBatch& batch);
  void LeaveToSuccessor(const Stream& successor);
  void LeaveAxis(Part& part);
  void BeginSession(Stream& stream, const SampleBatch& batch);
  void WatchClock(Stream& stream, const SampleBatch& batch);
  bool Believable(Stream& stream, const SampleBatch& batch);
  void AddReadings(Stream& stream, const SampleBatch& batch);
  void AddRows(Stream& stream, Part& part, const SampleBatch& batch);
  void JoinAxis(Part& part, std::int64_t now);
  void Anchor(Part& part, std::int64_t first);
  void InsertRow(Part& part, std::int64_t row, const SampleBatch& batch, std::size_t index, Quality flag);
  void CloseComplete(Axis& axis, std::int64_t now);
  void SkipGap(Axis& axis, std::int64_t row);
  void AdvanceHostGrid(Axis& axis, std::int64_t now);
  std::int64_t Due(const Axis& axis, std::int64_t row) const;
  void Emit(Axis& axis, std::size_t rows, bool late);
  double NextTime(Axis& axis, std::int64_t row);
  void FillHeld(Axis& axis, std::size_t from, std::int64_t row, std::size_t rows);

  const Machine& machine_;
  AlignerOptions options_;
  HostTime start_;
  std::int64_t period_;  ///< ns, of the grid
  std::vector<std::unique_ptr<Axis>> axes_;
  std::map<std::pair<int, std::vector<std::uint16_t>>, std::unique_ptr<Stream>> streams_;
  ChannelOwners owners_;
  std::vector<ChannelState> channels_;
  std::vector<Column> conversion_;  ///< per channel
  std::int64_t malformed_ = 0;
};

}  // namespace hydroscope
