#include "acquisition/modbus/ring_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hydroscope {
namespace {

constexpr std::uint64_t kLatestTime = std::numeric_limits<std::int64_t>::max() / 2;
constexpr std::uint64_t kFirst = 1ull
                                 << 32;  // sequences begin one wrap-around up, so that they may also fall

std::span<const std::uint16_t> At(std::span<const std::uint16_t> head, int place, int first, int count) {
  return head.subspan(static_cast<std::size_t>(place - first), static_cast<std::size_t>(count));
}

}  // namespace

RingReader::RingReader(const ModbusRingSpec& spec, std::vector<PlannedValue> values)
    : spec_(spec), values_(std::move(values)), period_ns_(std::llround(spec.period * 1e9)) {
  for (const PlannedValue& value : values_) channels_.push_back(value.channel);
}

std::optional<RingReader::Range> RingReader::Head(const ModbusRingSpec& spec) {
  int first = std::min(spec.session, spec.newest), end = std::max(spec.session, spec.newest) + 2;
  if (spec.time) first = std::min(first, *spec.time), end = std::max(end, *spec.time + 4);
  if (end - first > kMostRegisters) return std::nullopt;
  return Range{first, end - first};
}

void RingReader::BeginSession(std::uint32_t session, std::uint32_t newest) {
  session_ = session;
  ++life_;
  counters_.lost_rows += sequence_.lost();
  sequence_ = {};
  newest_ = next_ = kFirst + newest;
}

std::vector<RingReader::Request> RingReader::Begin(std::span<const std::uint16_t> head) {
  const Range range = *Head(spec_);
  if (head.size() < static_cast<std::size_t>(range.count)) {
    ++counters_.malformed;
    return {};
  }
  const auto session = static_cast<std::uint32_t>(DecodeUnsigned(At(head, spec_.session, range.first, 2)));
  const auto newest = static_cast<std::uint32_t>(DecodeUnsigned(At(head, spec_.newest, range.first, 2)));
  newest_time_ns_ = 0;
  if (spec_.time) {
    const std::uint64_t time = DecodeUnsigned(At(head, *spec_.time, range.first, 4));
    if (time <= kLatestTime)
      newest_time_ns_ = static_cast<std::int64_t>(time);
    else
      ++counters_.malformed;
  }
  const auto records = static_cast<std::uint64_t>(spec_.records);
  const auto step = static_cast<std::int32_t>(newest - static_cast<std::uint32_t>(newest_));
  if (session != session_ || step < 0)
    BeginSession(session, newest);
  else
    newest_ += static_cast<std::uint64_t>(step);
  // The oldest eighth may be overwritten while the rest is being read.
  const std::uint64_t held = records - records / 8;
  if (newest_ + 1 - next_ > held) next_ = newest_ + 1 - held;

  std::vector<Request> requests;
  const auto per_request = static_cast<std::uint64_t>(kMostRegisters / spec_.width);
  while (next_ <= newest_) {
    const std::uint64_t place = next_ % (std::uint64_t{1} << 32) % records;
    const std::uint64_t count = std::min({newest_ - next_ + 1, records - place, per_request});
    requests.push_back(
        {{spec_.first + static_cast<int>(place) * spec_.width, static_cast<int>(count) * spec_.width},
         next_,
         static_cast<std::size_t>(count)});
    next_ += count;
  }
  return requests;
}

SampleBatch RingReader::Decode(std::uint64_t first, std::span<const std::uint16_t> records) const {
  SampleBatch batch;
  batch.session = life_ << 32 | *session_;
  batch.first_sequence = first;
  batch.period_ns = period_ns_;
  if (spec_.time)
    batch.source_time_ns = newest_time_ns_ - static_cast<std::int64_t>(newest_ - first) * period_ns_;
  batch.channels = channels_;
  const auto width = static_cast<std::size_t>(spec_.width);
  batch.rows = records.size() / width;
  batch.values.reserve(batch.rows * values_.size());
  for (std::size_t row = 0; row < batch.rows; ++row)
    for (const PlannedValue& value : values_)
      batch.values.push_back(
          DecodeRegisters(records.subspan(row * width, width).subspan(static_cast<std::size_t>(value.offset)),
                          value.type, value.order));
  return batch;
}

bool RingReader::Receive(const Request& request, std::span<const std::uint16_t> registers, HostTime requested,
                         HostTime received, const Emit& emit) {
  const auto width = static_cast<std::size_t>(spec_.width);
  if (registers.size() != request.records * width) {
    ++counters_.malformed;
    return false;
  }
  std::size_t good = 0;  // a record that was overwritten already is newer by whole rounds of the ring
  std::uint32_t newer = 0;
  for (; good < request.records; ++good) {
    const auto found = static_cast<std::uint32_t>(DecodeUnsigned(registers.subspan(good * width, 2)));
    newer = found - static_cast<std::uint32_t>(request.sequence + good);
    if (newer != 0) break;
  }
  if (good < request.records && newer % static_cast<std::uint32_t>(spec_.records) != 0) ++counters_.malformed;
  if (good == 0) return false;
  SampleBatch batch = Decode(request.sequence, registers.first(good * width));
  batch.requested = requested;
  batch.received = received;
  sequence_.Receive(request.sequence, good);
  ++counters_.batches;
  counters_.rows += static_cast<std::int64_t>(good);
  counters_.last_received = received;
  emit(std::move(batch));
  return good == request.records;
}

SourceStatus RingReader::counters() const {
  SourceStatus status = counters_;
  status.lost_rows += sequence_.lost();
  return status;
}

}  // namespace hydroscope
