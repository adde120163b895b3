#include "acquisition/aligner.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "acquisition/aligner_axis.h"
#include "core/bytes.h"
#include "core/units.h"
#include "models/source_kind.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kFarthest = 1ll << 40;  ///< rows from the beginning of a session
constexpr std::int64_t kRowsOfSlip = 2;        ///< a second sender may be off before it is moved
constexpr std::uint32_t kMarksVersion = 2;
constexpr std::uint32_t kMarksWithoutTime = 1;  ///< version written before the time of the last row was kept
/// Seconds that an earlier life may have been ahead; more is a stepped clock.
constexpr double kLongestOverlap = 10.0;

SampleBatch OnlyColumns(const SampleBatch& batch, const std::vector<std::size_t>& columns) {
  SampleBatch kept = batch;
  kept.channels.clear();
  kept.values.clear();
  for (const std::size_t column : columns) kept.channels.push_back(batch.channels[column]);
  for (std::size_t row = 0; row < batch.rows; ++row)
    for (const std::size_t column : columns)
      kept.values.push_back(batch.values[row * batch.channels.size() + column]);
  return kept;
}

}  // namespace

AlignerOptions AlignerOptions::For(const Machine& machine) {
  AlignerOptions options;
  if (!machine.live) return options;
  options.host_clock = true;
  double slowest = 0;
  for (const SignalSpec& signal : machine.signals) {
    if (!signal.origin) continue;
    const Delivery delivery = DeliveryOf(machine, signal);
    if (delivery.streamed)
      options.host_clock = false;
    else
      slowest = std::max(slowest, delivery.period);
  }
  if (slowest > 0) options.held_period = slowest;
  return options;
}

Aligner::Aligner(const Machine& machine, const AlignerOptions& options, HostTime start)
    : machine_(machine),
      options_(options),
      start_(start),
      period_(Ns(machine.live->grid_period)),
      owners_(static_cast<std::size_t>(AxisCount(machine)) * machine.signals.size(), options.takeover) {
  const std::size_t signals = machine.signals.size();
  for (int a = 0; a < AxisCount(machine); ++a) {
    axes_.push_back(std::make_unique<Axis>(signals));
    for (const SignalSpec& spec : machine.signals) {
      const Unit unit = FindUnit(spec.unit).value_or(Unit{});
      conversion_.push_back({spec.scale * unit.scale, spec.offset * unit.scale + unit.offset});
    }
  }
  channels_.resize(axes_.size() * signals);
}

Aligner::~Aligner() = default;

void Aligner::Add(int source, const SampleBatch& batch) {
  const auto exists = [&](std::uint16_t channel) { return channel < channels_.size(); };
  if (batch.rows == 0 || batch.channels.empty() ||
      batch.values.size() != batch.rows * batch.channels.size() ||
      !std::all_of(batch.channels.begin(), batch.channels.end(), exists)) {
    ++malformed_;
    return;
  }
  const std::vector<std::size_t>& columns = owners_.Admit(source, batch);
  if (columns.size() == batch.channels.size()) return Take(source, batch);
  RefuseRows(batch, columns);
  if (!columns.empty()) Take(source, OnlyColumns(batch, columns));
}

/// Counts the rows at each axis that has a channel among those left out.
void Aligner::RefuseRows(const SampleBatch& batch, const std::vector<std::size_t>& columns) {
  std::set<std::size_t> axes;
  for (std::size_t column = 0; column < batch.channels.size(); ++column)
    if (!std::binary_search(columns.begin(), columns.end(), column))
      axes.insert(batch.channels[column] / machine_.signals.size());
  for (const std::size_t axis : axes)
    axes_[axis]->counters.second_sender_rows += static_cast<std::int64_t>(batch.rows);
}

/// A batch whose channels are all its sender's to send.
void Aligner::Take(int source, const SampleBatch& batch) {
  Stream* stream = FindStream(source, batch);
  ++stream->batches;
  if (!stream->begun || stream->session != batch.session || stream->writer != batch.writer)
    BeginSession(*stream, batch);
  if (std::abs(static_cast<std::int64_t>(batch.first_sequence - stream->base)) > kFarthest) {
    ++malformed_;
    return;
  }
  WatchClock(*stream, batch);
  for (std::size_t c = 0; c < batch.channels.size(); ++c) {
    ChannelState& state = channels_[batch.channels[c]];
    const Column& convert = conversion_[batch.channels[c]];
    state.values += static_cast<std::int64_t>(batch.rows);
    state.last_received = batch.received.monotonic_ns;
    state.last_value = convert(batch.values[(batch.rows - 1) * batch.channels.size() + c]);
  }
  if (stream->ratio == 0) return AddReadings(*stream, batch);
  if (!Believable(*stream, batch)) return;
  const std::int64_t last = stream->SenderTime(batch.first_sequence + batch.rows - 1);
  stream->clock.Observe(last, batch.received.monotonic_ns);
  stream->delay = static_cast<double>(batch.received.monotonic_ns - stream->clock.ToHost(last));
  stream->worst_delay = std::max(stream->worst_delay, stream->delay);
  for (Part& part : stream->parts) AddRows(*stream, part, batch);
  for (Part& part : stream->parts) CloseComplete(*part.axis, batch.received.monotonic_ns);
}

void Aligner::AddRows(Stream& stream, Part& part, const SampleBatch& batch) {
  Axis& axis = *part.axis;
  const std::uint64_t ratio = stream.ratio;
  std::uint64_t first = (batch.first_sequence + ratio - 1) / ratio;  // in rows of the grid
  const std::uint64_t end = (batch.first_sequence + batch.rows - 1) / ratio + 1;
  if (part.stored_session == stream.session && first < part.stored_until) {
    const std::uint64_t fresh = std::min(part.stored_until, end);
    axis.counters.already_stored += static_cast<std::int64_t>(fresh - first);
    first = fresh;
  }
  if (first >= end) return;
  if (!part.anchored) Anchor(part, static_cast<std::int64_t>(first));
  if (&part != axis.master && axis.master->anchored) {
    const std::int64_t off = part.IdealShift(*axis.master, period_) - part.shift;
    if (std::abs(off) > kRowsOfSlip) {
      ++axis.counters.slips;
      part.shift += off;
      part.mark |= quality::kGap;
    }
  }
  const std::int64_t begin_row = static_cast<std::int64_t>(first) + part.shift;
  if (part.highest_row && begin_row <= *part.highest_row) ++axis.counters.reordered_batches;
  for (std::uint64_t s = first; s < end; ++s) {
    const auto row = static_cast<std::int64_t>(s) + part.shift;
    InsertRow(part, row, batch, s * ratio - batch.first_sequence, part.mark);
  }
  part.highest_row =
      std::max(part.highest_row.value_or(begin_row), begin_row + static_cast<std::int64_t>(end - first) - 1);
}

/// Decides which row of the grid the sender's row `first` is: behind everything for the sender that carries
/// the grid, by the clocks for another one.
void Aligner::Anchor(Part& part, std::int64_t first) {
  Axis& axis = *part.axis;
  part.anchored = true;
  part.highest_row.reset();
  if (&part == axis.master || !axis.master->anchored) {
    part.shift = axis.first_row - first;
    axis.jumped = axis.begun;
  } else {
    part.shift = part.IdealShift(*axis.master, period_);
  }
  if (axis.begun) part.mark |= quality::kGap;
}

void Aligner::InsertRow(Part& part, std::int64_t row, const SampleBatch& batch, std::size_t index,
                        Quality flag) {
  Axis& axis = *part.axis;
  if (row < axis.first_row) {
    ++axis.counters.late_rows;
    return;
  }
  // A hole longer than the longest gap is not filled row by row.
  const auto most = static_cast<std::int64_t>(axis.pending()) + Ns(options_.longest_gap) / period_;
  if (row - axis.first_row > most) SkipGap(axis, row);
  const auto at = static_cast<std::size_t>(row - axis.first_row);
  axis.Reserve(at + 1);
  const double* values = batch.values.data() + index * batch.channels.size();
  if (part.present[at]) {
    ++axis.counters.duplicate_rows;
    bool same = true;
    for (const auto& column : part.columns) {
      const double value = column.convert(values[column.place]), there = axis.rows.signal[column.signal][at];
      same = same && (value == there || std::isnan(value));
    }
    if (same) return;
    ++axis.counters.contradicting_rows;
    for (const auto& column : part.columns) axis.rows.quality[column.signal][at] |= quality::kDuplicate;
    return;
  }
  part.present[at] = 1;
  part.missing_run = 0;
  part.silent = false;
  axis.last_arrival = batch.received.monotonic_ns;
  axis.arrival[at] = std::max(axis.arrival[at], axis.last_arrival);
  for (const auto& column : part.columns) {
    const double value = column.convert(values[column.place]);
    axis.rows.signal[column.signal][at] = value;
    axis.rows.quality[column.signal][at] = flag | (std::isfinite(value) ? quality::kGood : quality::kMissing);
  }
  part.mark = quality::kGood;
}

/// Gives out what is pending and goes on at `row`, which carries the flag.
void Aligner::SkipGap(Axis& axis, std::int64_t row) {
  Emit(axis, axis.pending(), true);
  axis.counters.skipped_rows += row - axis.first_row;
  axis.first_row = row;
  axis.jumped = true;
  ++axis.counters.gaps;
  for (Part* part : axis.parts) part->mark |= quality::kGap;
}

std::int64_t Aligner::Due(const Axis& axis, std::int64_t row) const {
  if (axis.master == nullptr) return axis.host_anchor + row * period_;
  const Part& master = *axis.master;
  return master.stream->clock.ToHost(
      master.stream->SenderTime(static_cast<std::uint64_t>(row - master.shift) * master.stream->ratio));
}

void Aligner::Advance(std::int64_t now) {
  for (const auto& axis : axes_) {
    if (axis->master != nullptr)
      CloseComplete(*axis, now);
    else
      AdvanceHostGrid(*axis, now);
  }
}

/// Gives out the rows that every fast sender has reached, and those that are overdue.
void Aligner::CloseComplete(Axis& axis, std::int64_t now) {
  if (now < axis.hold_until || !axis.master->anchored) return;
  const std::int64_t lateness = Ns(options_.lateness);
  const std::int64_t longest = Ns(options_.longest_gap) / period_;
  for (;;) {
    const std::size_t complete = axis.CompleteRows();
    if (complete > 0) {
      axis.missing_run = 0;
      Emit(axis, complete, false);
    }
    // The front row lacks something. How long has that been known?
    const std::optional<std::int64_t> revealed = axis.RevealedAt();
    if (!revealed && axis.missing_run >= longest) return;  // silence: no rows until something comes
    const std::int64_t since = std::max(Due(axis, axis.first_row), revealed.value_or(axis.last_arrival));
    if (now - since <= lateness) return;
    axis.Reserve(1);
    ++axis.missing_run;
    Emit(axis, 1, true);
  }
}

/// An axis without any fast channel: the host's clock makes the rows.
void Aligner::AdvanceHostGrid(Axis& axis, std::int64_t now) {
  if (!options_.host_clock || !axis.first_held) return;
  if (axis.host_anchor == 0) axis.host_anchor = now - axis.first_row * period_;
  const std::int64_t due = (now - axis.host_anchor) / period_ - axis.first_row;
  if (due <= 0) return;
  const std::int64_t longest = Ns(options_.longest_gap) / period_ + 1;
  if (due > longest) {
    axis.first_row += due - 1;
    axis.jumped = true;
    ++axis.counters.gaps;
  }
  const auto rows = static_cast<std::size_t>(std::min(due, due > longest ? std::int64_t{1} : longest));
  axis.Reserve(rows);
  Emit(axis, rows, false);
}

/// Moves the first `rows` pending rows to those that are ready.
void Aligner::Emit(Axis& axis, std::size_t rows, bool late) {
  if (rows == 0) return;
  SampleBlock& ready = axis.ready;
  const std::size_t from = ready.rows();
  ready.Resize(axis.signals, from + rows);
  for (std::size_t s = 0; s < axis.signals; ++s) {
    std::copy_n(axis.rows.signal[s].begin(), rows,
                ready.signal[s].begin() + static_cast<std::ptrdiff_t>(from));
    std::copy_n(axis.rows.quality[s].begin(), rows,
                ready.quality[s].begin() + static_cast<std::ptrdiff_t>(from));
  }
  std::int64_t missing = 0;
  for (std::size_t k = 0; k < rows; ++k) {
    bool lacks = false;
    for (Part* part : axis.parts) {
      if (part->present[k]) continue;
      lacks = true;
      part->silent = ++part->missing_run >= Ns(options_.longest_gap) / period_;
      for (const auto& column : part->columns)
        ready.quality[column.signal][from + k] = quality::kMissing | (late ? quality::kLate : quality::kGood);
    }
    missing += lacks;
    const bool jumped = axis.jumped;
    ready.time[from + k] = NextTime(axis, axis.first_row + static_cast<std::int64_t>(k));
    if (jumped)
      for (auto& flags : ready.quality) flags[from + k] |= quality::kGap;
  }
  FillHeld(axis, from, axis.first_row, rows);
  axis.counters.rows += static_cast<std::int64_t>(rows);
  axis.counters.missing_rows += missing;
  axis.Drop(rows);
}

/// s, host wall time of the row: nominal steps, gently pulled to where the sender's clock says. The first one
/// lies behind the rows of an earlier life of the service, whose sender's clock was known less well.
double Aligner::NextTime(Axis& axis, std::int64_t row) {
  constexpr double kPull = 500e-6, kStep = 0.5;  // s per s; s
  const double period = static_cast<double>(period_) * 1e-9;
  const double due = static_cast<double>(start_.wall_ns + (Due(axis, row) - start_.monotonic_ns)) * 1e-9;
  if (!axis.begun) {
    axis.begun = true;
    axis.jumped = false;
    const double ahead = axis.stored_time + period - due;
    return axis.time = ahead > 0 && ahead < kLongestOverlap ? axis.stored_time + period : due;
  }
  const double nominal = axis.time + period;
  const double error = due - nominal;
  if (axis.jumped || error > kStep) {
    if (!axis.jumped) ++axis.counters.clock_jumps;
    axis.jumped = false;
    return axis.time = std::max(nominal, due);
  }
  return axis.time = nominal + std::clamp(error, -kPull * period, kPull * period);
}

/// Values of the slow channels: the newest reading that is not younger than the row.
void Aligner::FillHeld(Axis& axis, std::size_t from, std::int64_t row, std::size_t rows) {
  for (std::size_t s = 0; s < axis.signals; ++s) {
    if (axis.IsFast(s)) continue;
    Held& held = axis.held[s];
    for (std::size_t k = 0; k < rows; ++k) {
      const std::int64_t at = Due(axis, row + static_cast<std::int64_t>(k)) + period_ / 2;
      while (held.readings.size() > 1 && held.readings[1].host <= at) held.readings.pop_front();
      double& value = axis.ready.signal[s][from + k];
      Quality& flags = axis.ready.quality[s][from + k];
      if (held.readings.empty() || held.readings.front().host > at) {
        value = std::numeric_limits<double>::quiet_NaN();
        flags |= quality::kMissing;
        continue;
      }
      const Reading& reading = held.readings.front();
      value = reading.value;
      flags |= reading.flags | (std::isfinite(value) ? quality::kGood : quality::kMissing);
      held.readings.front().flags = quality::kGood;  // told once
      if (at - reading.host > held.allowed) {
        flags |= quality::kStale;
        ++axis.counters.stale_values;
      }
    }
  }
}

std::int64_t Aligner::NewestSampled(int axis) const {
  const Axis& of = *axes_[static_cast<std::size_t>(axis)];
  return Due(of, of.first_row - 1);
}

bool Aligner::Take(int axis, SampleBlock& block) {
  Axis& from = *axes_[static_cast<std::size_t>(axis)];
  if (from.ready.rows() == 0) return false;
  std::swap(block, from.ready);
  from.ready.Resize(from.signals, 0);
  return true;
}

std::vector<std::uint8_t> Aligner::marks(int axis) const {
  const Axis& from = *axes_[static_cast<std::size_t>(axis)];
  ByteWriter out;
  out.Put(kMarksVersion);
  out.Put(static_cast<std::uint32_t>(from.parts.size()));
  for (const Part* part : from.parts) {
    out.Put(part->stream->key);
    out.Put(part->stream->session);
    const std::int64_t next = from.first_row - part->shift;
    out.Put(part->anchored ? static_cast<std::uint64_t>(std::max<std::int64_t>(0, next))
                           : part->stored_until);
  }
  out.Put(from.begun ? from.time : from.stored_time);
  return out.Take();
}

void Aligner::RestoreMarks(int axis, const std::vector<std::uint8_t>& marks) {
  Axis& to = *axes_[static_cast<std::size_t>(axis)];
  ByteReader in(marks);
  const auto version = in.Get<std::uint32_t>();
  if (version != kMarksVersion && version != kMarksWithoutTime) return;
  const auto count = in.Get<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && in.ok(); ++i) {
    const auto key = in.Get<std::uint64_t>(), session = in.Get<std::uint64_t>();
    const auto until = in.Get<std::uint64_t>();
    if (in.ok()) to.stored[key] = {session, until};
  }
  if (version == kMarksWithoutTime) return;
  if (const auto time = in.Get<double>(); in.ok()) to.stored_time = time;
}

const AlignerCounters& Aligner::counters(int axis) const {
  return axes_[static_cast<std::size_t>(axis)]->counters;
}

std::vector<StreamState> Aligner::streams() const {
  std::vector<StreamState> states;
  for (const auto& [key, stream] : streams_) {
    StreamState state{.source = stream->source, .channels = stream->channels};
    state.period = static_cast<double>(stream->period) * 1e-9;
    state.has_clock = stream->has_clock;
    if (stream->wall_clock.known())
      state.clock_offset =
          static_cast<double>(stream->wall_clock.offset() + start_.wall_ns - start_.monotonic_ns) * 1e-9;
    if (stream->ratio > 0)  // single readings of a clock that ticks coarsely tell no drift
      state.drift = stream->wall_clock.known() ? stream->wall_clock.drift() : stream->clock.drift();
    state.delay = stream->delay * 1e-9;
    state.worst_delay = stream->worst_delay * 1e-9;
    state.batches = stream->batches;
    states.push_back(state);
  }
  return states;
}

}  // namespace hydroscope
