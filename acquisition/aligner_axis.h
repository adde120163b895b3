#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "acquisition/aligner.h"
#include "acquisition/jump_guard.h"

namespace hydroscope {

/// Inside of the aligner: one sender's columns, and the open frames of one axis.

inline std::int64_t Ns(double seconds) { return std::llround(seconds * 1e9); }

/// Raw value to SI.
struct Aligner::Column {
  double scale = 1, offset = 0;
  double operator()(double raw) const { return raw * scale + offset; }
};

struct Reading {
  std::int64_t host = 0;  ///< ns, monotonic
  double value = 0;       ///< SI
  Quality flags = quality::kGood;
};
/// A slow channel: the readings not yet overtaken by the frames.
struct Held {
  std::deque<Reading> readings;
  std::int64_t allowed = 0;  ///< ns, age beyond which a reading is stale
};

/// The columns of a stream that belong to one axis.
struct Aligner::Part {
  struct Place {
    std::size_t place;   ///< column of the batch
    std::size_t signal;  ///< of the axis
    Column convert;
  };
  Axis* axis = nullptr;
  Stream* stream = nullptr;
  std::vector<Place> columns;
  bool anchored = false;
  std::int64_t shift = 0;                              ///< row of the grid = sequence / ratio + shift
  std::optional<std::int64_t> highest_row;             ///< newest row received
  Quality mark = quality::kGood;                       ///< flags of the next row
  std::vector<std::uint8_t> present;                   ///< per pending row
  std::int64_t missing_run = 0;                        ///< rows in a row that it lacked ...
  bool silent = false;                                 ///< ... so many that nobody waits for it
  std::uint64_t stored_session = 0, stored_until = 0;  ///< rows of an earlier life of the service

  bool Has(std::size_t signal) const {
    return std::any_of(columns.begin(), columns.end(), [&](const Place& c) { return c.signal == signal; });
  }
  std::int64_t RowOf(std::uint64_t sequence, std::uint64_t ratio) const {
    return static_cast<std::int64_t>(sequence / ratio) + shift;
  }
  /// The shift at which this sender's rows lie nearest in time to those of the sender that carries the grid.
  std::int64_t IdealShift(const Part& master, std::int64_t period) const;
};

/// All batches of one set of channels of one source.
struct Aligner::Stream {
  int source = 0;
  std::uint64_t key = 0;
  std::size_t channels = 0;
  std::vector<Part> parts;  ///< in order of the axes
  bool begun = false;
  std::uint64_t writer = 0, session = 0;
  std::uint64_t base = 0;   ///< first sequence of the session
  std::int64_t period = 0;  ///< ns between rows; 0: single readings
  std::uint64_t ratio = 0;  ///< rows per row of the grid; 0: a slow channel
  ClockModel clock;         ///< of the sequence: row count times period -> host
  ClockModel wall_clock;    ///< of the time the sender sends
  bool has_clock = false;
  std::int64_t last_source_time = 0, last_received = 0;  ///< ns
  std::uint64_t last_sequence = 0;
  JumpGuard jump;                     ///< of its sequence
  double delay = 0, worst_delay = 0;  ///< ns
  std::int64_t batches = 0;

  /// ns since the first row of the session, by the count.
  std::int64_t SenderTime(std::uint64_t sequence) const {
    return static_cast<std::int64_t>(sequence - base) * period;
  }
};

inline std::int64_t Aligner::Part::IdealShift(const Part& master, std::int64_t period) const {
  const Stream& carrier = *master.stream;
  const std::int64_t own = stream->clock.ToHost(0), grid = carrier.clock.ToHost(0);
  // Row of the grid at the host time of this sender's first row, minus that row's own number.
  return static_cast<std::int64_t>(carrier.base / carrier.ratio) + master.shift +
         std::llround(static_cast<double>(own - grid) / static_cast<double>(period)) -
         static_cast<std::int64_t>(stream->base / stream->ratio);
}

struct Aligner::Axis {
  explicit Axis(std::size_t count) : signals(count), held(count) {
    rows.Resize(count, 0);
    ready.Resize(count, 0);
  }

  std::size_t signals;
  std::vector<Part*> parts;           ///< fast senders
  Part* master = nullptr;             ///< the one that carries the grid
  SampleBlock rows;                   ///< open frames; `time` is not used
  std::vector<std::int64_t> arrival;  ///< ns, newest value of each open frame; 0 = none
  std::int64_t first_row = 0;         ///< number of the first open frame
  SampleBlock ready;
  std::vector<Held> held;
  AlignerCounters counters;
  bool begun = false;             ///< a row was given out
  bool jumped = false;            ///< the next row follows a gap that was not written out
  double time = 0;                ///< s, of the last row given out
  double stored_time = 0;         ///< s, of the last row an earlier life of the service had stored
  std::int64_t hold_until = 0;    ///< ns, no rows before: the clock settles
  std::int64_t last_arrival = 0;  ///< ns, newest row of a fast sender
  std::int64_t missing_run = 0;   ///< rows in a row given out without anything
  std::int64_t host_anchor = 0;   ///< ns, of row 0 where no fast sender carries the grid
  std::optional<std::int64_t> first_held;
  std::map<std::uint64_t, std::pair<std::uint64_t, std::uint64_t>> stored;  ///< stream key -> session, row

  std::size_t pending() const { return arrival.size(); }
  bool IsFast(std::size_t signal) const {
    return std::any_of(parts.begin(), parts.end(), [&](const Part* part) { return part->Has(signal); });
  }
  /// Makes at least `count` frames.
  void Reserve(std::size_t count) {
    for (Part* part : parts)
      if (part->present.size() < std::max(count, pending()))
        part->present.resize(std::max(count, pending()), 0);
    if (count <= pending()) return;
    arrival.resize(count, 0);
    for (auto& column : rows.signal) column.resize(count, std::numeric_limits<double>::quiet_NaN());
    for (auto& column : rows.quality) column.resize(count, quality::kGood);
  }
  /// Frames from the first on that every fast sender reached.
  std::size_t CompleteRows() const {
    std::size_t count = pending();
    for (const Part* part : parts)
      if (!part->silent)
        count = static_cast<std::size_t>(
            std::find(part->present.begin(), part->present.begin() + static_cast<std::ptrdiff_t>(count), 0) -
            part->present.begin());
    return count;
  }
  /// When the first value of the open frames arrived that shows the first one to be lacking; nullopt if
  /// nothing is pending.
  std::optional<std::int64_t> RevealedAt() const {
    for (const std::int64_t at : arrival)
      if (at != 0) return at;
    return std::nullopt;
  }
  void Drop(std::size_t count) {
    const auto n = static_cast<std::ptrdiff_t>(count);
    arrival.erase(arrival.begin(), arrival.begin() + n);
    for (auto& column : rows.signal) column.erase(column.begin(), column.begin() + n);
    for (auto& column : rows.quality) column.erase(column.begin(), column.begin() + n);
    for (Part* part : parts) part->present.erase(part->present.begin(), part->present.begin() + n);
    first_row += n;
  }
};

}  // namespace hydroscope
