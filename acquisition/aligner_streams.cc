// The senders' side of the aligner: who sends, whose life it is, what its clock says, what is believed.

#include <algorithm>
#include <cmath>
#include <tuple>

#include "acquisition/aligner.h"
#include "acquisition/aligner_axis.h"
#include "core/contains.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kJump = 100'000'000;  ///< ns, step of a sender's clock that is told
constexpr std::size_t kReadingsKept = 64;

/// Identifies the channels of a stream across restarts (FNV-1a).
std::uint64_t KeyOf(int source, const std::vector<std::uint16_t>& channels) {
  std::uint64_t key = 0xcbf29ce484222325ull ^ static_cast<std::uint64_t>(source);
  for (const std::uint16_t channel : channels) key = (key ^ channel) * 0x100000001b3ull;
  return key;
}

/// Rows of the sender for one row of the grid; 0: a slow channel.
std::uint64_t RatioOf(std::int64_t batch_period, std::int64_t grid) {
  if (batch_period <= 0) return 0;
  const double ratio = static_cast<double>(grid) / static_cast<double>(batch_period);
  const double whole = std::round(ratio);
  return whole >= 1 && std::abs(ratio - whole) < 1e-6 * whole ? static_cast<std::uint64_t>(whole) : 0;
}

}  // namespace

/// The stream of these channels, made if new.
Aligner::Stream* Aligner::FindStream(int source, const SampleBatch& batch) {
  auto& place = streams_[{source, batch.channels}];
  if (place) return place.get();
  const std::size_t signals = machine_.signals.size();
  place = std::make_unique<Stream>();
  place->source = source;
  place->key = KeyOf(source, batch.channels);
  std::map<Axis*, Part> parts;
  for (std::size_t c = 0; c < batch.channels.size(); ++c) {
    Part& part = parts[axes_[batch.channels[c] / signals].get()];
    part.columns.push_back({c, batch.channels[c] % signals, conversion_[batch.channels[c]]});
  }
  for (const auto& axis : axes_)  // in order of the axes, not of their addresses
    if (const auto found = parts.find(axis.get()); found != parts.end()) {
      found->second.axis = axis.get();
      found->second.stream = place.get();
      place->parts.push_back(std::move(found->second));
    }
  place->channels = batch.channels.size();
  for (Part& part : place->parts)
    if (const auto stored = part.axis->stored.find(place->key); stored != part.axis->stored.end())
      std::tie(part.stored_session, part.stored_until) = stored->second;
  return place.get();
}

/// Ends other streams that have channels of this one: these have changed their sender.
void Aligner::LeaveToSuccessor(const Stream& successor) {
  const auto shares_channel = [&](const Stream& other) {
    return std::any_of(successor.parts.begin(), successor.parts.end(), [&](const Part& part) {
      return std::any_of(other.parts.begin(), other.parts.end(), [&](const Part& its) {
        return its.axis == part.axis &&
               std::any_of(part.columns.begin(), part.columns.end(),
                           [&](const Part::Place& column) { return its.Has(column.signal); });
      });
    });
  };
  for (auto it = streams_.begin(); it != streams_.end();) {
    if (it->second.get() == &successor || !shares_channel(*it->second)) {
      ++it;
      continue;
    }
    for (Part& part : it->second->parts) LeaveAxis(part);
    it = streams_.erase(it);
  }
}

/// A fast sender goes. If it carried the grid, the next one does, and all are anchored anew.
void Aligner::LeaveAxis(Part& part) {
  Axis& axis = *part.axis;
  if (!Contains(axis.parts, &part)) return;
  Emit(axis, axis.pending(), true);
  std::erase(axis.parts, &part);
  if (axis.master != &part) return;
  axis.master = axis.parts.empty() ? nullptr : axis.parts.front();
  for (Part* other : axis.parts) other->anchored = false;
}

/// Another life of the sender, or the first one: its count begins anew.
void Aligner::BeginSession(Stream& stream, const SampleBatch& batch) {
  if (!stream.begun) LeaveToSuccessor(stream);
  stream.ratio = RatioOf(batch.period_ns, period_);
  for (Part& part : stream.parts)
    if (stream.ratio != 0)
      JoinAxis(part, batch.received.monotonic_ns);
    else
      LeaveAxis(part);
  stream.begun = true;
  stream.writer = batch.writer;
  stream.session = batch.session;
  stream.base = batch.first_sequence;
  stream.period = batch.period_ns;
  stream.clock.Reset();
  stream.wall_clock.Reset();
  stream.last_source_time = 0;
  stream.jump.Forget();
}

/// A fast sender begins. If it carries the grid, the others are anchored to it anew.
void Aligner::JoinAxis(Part& part, std::int64_t now) {
  Axis& axis = *part.axis;
  ++axis.counters.sessions;
  part.anchored = false;
  if (axis.master == nullptr || axis.master == &part) {
    Emit(axis, axis.pending(), true);
    axis.master = &part;
    axis.hold_until = now + Ns(options_.settle);
    for (Part* other : axis.parts) other->anchored = false;
  }
  std::erase(axis.parts, &part);
  part.present.assign(axis.pending(), 0);
  axis.parts.push_back(&part);
}

/// Follows the sender's own clock; a step of it is told, and changes no order.
void Aligner::WatchClock(Stream& stream, const SampleBatch& batch) {
  stream.has_clock = batch.source_time_ns != 0;
  if (!stream.has_clock) return;
  const std::int64_t newest = batch.source_time_ns + static_cast<std::int64_t>(batch.rows - 1) *
                                                         std::max<std::int64_t>(batch.period_ns, 0);
  if (stream.last_source_time != 0) {
    const std::int64_t passed =
        stream.ratio > 0
            ? static_cast<std::int64_t>(batch.first_sequence - stream.last_sequence) * stream.period
            : batch.received.monotonic_ns - stream.last_received;
    const std::int64_t step = batch.source_time_ns - stream.last_source_time - passed;
    const std::int64_t tolerance = stream.ratio > 0 ? kJump : 10 * kJump;
    if (std::abs(step) > tolerance) {
      stream.wall_clock.Reset();
      for (Part& part : stream.parts) {
        ++part.axis->counters.clock_jumps;
        part.mark = quality::kClockJump;
      }
    }
  }
  stream.last_source_time = batch.source_time_ns;
  stream.last_sequence = batch.first_sequence;
  stream.last_received = batch.received.monotonic_ns;
  stream.wall_clock.Observe(newest, batch.received.monotonic_ns);
}

/// A batch far ahead of the sender's clock, or behind all frames, is believed only when the sender goes on there.
bool Aligner::Believable(Stream& stream, const SampleBatch& batch) {
  const auto last = batch.first_sequence + batch.rows - 1;
  const bool ahead = stream.clock.known() && stream.clock.ToHost(stream.SenderTime(last)) >
                                                 batch.received.monotonic_ns + Ns(options_.future);
  bool behind = false;
  for (const Part& part : stream.parts)
    behind = behind || (part.anchored && part.RowOf(last, stream.ratio) <
                                             part.axis->first_row - Ns(2 * options_.lateness) / period_);
  if (!ahead && !behind) {
    stream.jump.Forget();
    return true;
  }
  for (Part& part : stream.parts) {
    auto& count = ahead ? part.axis->counters.future_rows : part.axis->counters.late_rows;
    count += static_cast<std::int64_t>(batch.rows / stream.ratio);
  }
  if (!stream.jump.GoesOn(batch.first_sequence, batch.rows, batch.received.monotonic_ns)) return false;
  for (Part& part : stream.parts) {
    ++part.axis->counters.sequence_jumps;
    --part.axis->counters.sessions;  // BeginSession counts it
  }
  BeginSession(stream, batch);
  for (Part& part : stream.parts) part.mark |= ahead ? quality::kFuture : quality::kTimeBackwards;
  return true;
}

void Aligner::AddReadings(Stream& stream, const SampleBatch& batch) {
  const bool periodic = batch.period_ns > 0;
  if (periodic)
    stream.clock.Observe(stream.SenderTime(batch.first_sequence + batch.rows - 1),
                         batch.received.monotonic_ns);
  const std::int64_t middle =
      batch.requested.monotonic_ns + (batch.received.monotonic_ns - batch.requested.monotonic_ns) / 2;
  const std::int64_t allowed = std::llround(
      options_.held_periods * (periodic ? static_cast<double>(batch.period_ns) : options_.held_period * 1e9));
  for (Part& part : stream.parts) {
    Axis& axis = *part.axis;
    for (const auto& column : part.columns) {
      Held& held = axis.held[column.signal];
      held.allowed = allowed;
      for (std::size_t row = 0; row < batch.rows; ++row) {
        const std::int64_t at =
            periodic ? stream.clock.ToHost(stream.SenderTime(batch.first_sequence + row)) : middle;
        if (!held.readings.empty() && at <= held.readings.back().host) {
          ++axis.counters.duplicate_rows;
          continue;
        }
        held.readings.push_back(
            {at, column.convert(batch.values[row * batch.channels.size() + column.place]), part.mark});
        if (held.readings.size() > kReadingsKept) held.readings.pop_front();
      }
    }
    part.mark = quality::kGood;
    if (!axis.first_held) axis.first_held = batch.received.monotonic_ns;
  }
}

}  // namespace hydroscope
