#include "acquisition/batch_assembler.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace hydroscope {
namespace {

constexpr std::size_t kMostChannels = 4096;
constexpr std::size_t kMostLayouts = 16;  // of one session
constexpr std::int64_t kMostPeriod = 1'000'000'000'000;
constexpr std::int64_t kMostTime = std::numeric_limits<std::int64_t>::max() / 2;

void AddSequence(const SequenceMonitor& sequence, SourceStatus& status) {
  status.lost_rows += sequence.lost();
  status.duplicate_rows += sequence.duplicates();
  status.reordered_batches += sequence.reordered();
}

std::string FaultOf(const BatchMessage& m) {
  if (m.version != kLiveProtocolVersion)
    return fmt::format("the sender speaks version {} of the protocol, expected {}", m.version,
                       kLiveProtocolVersion);
  if (m.rows == 0) return "a batch without rows";
  if (m.first_sequence > std::numeric_limits<std::uint64_t>::max() - m.rows)
    return "a sequence number that overflows";
  if (m.period_ns < 0 || m.period_ns > kMostPeriod || (m.period_ns == 0 && m.rows > 1))
    return fmt::format("a period of {} ns", m.period_ns);
  if (m.source_time_ns < 0 || m.source_time_ns > kMostTime)
    return fmt::format("a time of {} ns", m.source_time_ns);
  return "";
}

}  // namespace

BatchAssembler::BatchAssembler(std::vector<std::string> wanted) : wanted_(std::move(wanted)) {}

void BatchAssembler::Malformed(std::string complaint) {
  ++counters_.malformed;
  complaint_ = std::move(complaint);
}

BatchAssembler::Session& BatchAssembler::SessionOf(std::uint64_t id) {
  if (!sessions_.contains(id) && sessions_.size() == kSessionsKept) {
    const auto oldest =
        std::min_element(sessions_.begin(), sessions_.end(),
                         [](const auto& a, const auto& b) { return a.second.used < b.second.used; });
    AddSequence(oldest->second.sequence, forgotten_);
    sessions_.erase(oldest);
  }
  Session& session = sessions_[id];
  session.used = ++messages_;
  return session;
}

void BatchAssembler::Receive(const LayoutMessage& message, const Emit& emit) {
  if (message.version != kLiveProtocolVersion)
    return Malformed(fmt::format("the sender speaks version {} of the protocol, expected {}", message.version,
                                 kLiveProtocolVersion));
  if (message.channels.empty() || message.channels.size() > kMostChannels)
    return Malformed(fmt::format("a layout of {} channels", message.channels.size()));
  Session& session = SessionOf(message.session);
  if (session.layouts.size() == kMostLayouts) session.layouts.erase(session.layouts.begin());
  Layout& layout = session.layouts[message.layout_id];
  layout = {.columns = message.channels.size(), .channels = {}, .from_columns = {}};
  std::string missing;
  bool any = false;
  for (std::size_t channel = 0; channel < wanted_.size(); ++channel) {
    if (wanted_[channel].empty()) continue;
    const auto found = std::find(message.channels.begin(), message.channels.end(), wanted_[channel]);
    if (found == message.channels.end()) {
      if (missing.empty()) missing = wanted_[channel];
      continue;
    }
    any = true;
    layout.channels.push_back(static_cast<std::uint16_t>(channel));
    layout.from_columns.push_back(static_cast<std::size_t>(found - message.channels.begin()));
  }
  complaint_ = missing.empty()
                   ? ""
                   : fmt::format("the sender announces {} channels but not {}{}; it announces e.g. {}",
                                 message.channels.size(), missing, any ? "" : " nor any other wanted one",
                                 message.channels.front().substr(0, 255));
  std::vector<Waiting> waiting;
  std::swap(waiting, waiting_);
  for (Waiting& w : waiting) Receive(std::move(w.message), w.received, emit);
}

void BatchAssembler::Receive(BatchMessage&& message, HostTime received, const Emit& emit) {
  if (std::string fault = FaultOf(message); !fault.empty()) return Malformed("the sender sent " + fault);
  if (message.rows > kMostRows)
    return Malformed(fmt::format("the sender sent a batch of {} rows", message.rows));
  Session& session = SessionOf(message.session);
  const auto layout = session.layouts.find(message.layout_id);
  if (layout == session.layouts.end()) {
    if (waiting_.size() == kWaitingKept) {
      waiting_.erase(waiting_.begin());
      Malformed("batches come without the layout that names their channels");
    }
    waiting_.push_back({std::move(message), received});
    return;
  }
  if (message.values.size() != message.rows * layout->second.columns)
    return Malformed(fmt::format("the sender sent {} values in {} rows of {} channels", message.values.size(),
                                 message.rows, layout->second.columns));
  Deliver(session, layout->second, message, received, emit);
}

void BatchAssembler::Deliver(Session& session, const Layout& layout, BatchMessage& message, HostTime received,
                             const Emit& emit) {
  const SequenceMonitor::Verdict verdict = session.sequence.Receive(message.first_sequence, message.rows);
  const std::size_t rows = message.rows - verdict.skip;
  if (rows == 0 || layout.channels.empty()) return;
  SampleBatch batch;
  batch.session = message.session;
  batch.first_sequence = message.first_sequence + verdict.skip;
  batch.source_time_ns = message.source_time_ns + static_cast<std::int64_t>(verdict.skip) * message.period_ns;
  batch.period_ns = message.period_ns;
  batch.requested = batch.received = received;
  batch.channels = layout.channels;
  batch.rows = rows;
  batch.values.reserve(rows * layout.channels.size());
  for (std::size_t row = verdict.skip; row < message.rows; ++row)
    for (const std::size_t column : layout.from_columns)
      batch.values.push_back(message.values[row * layout.columns + column]);
  ++counters_.batches;
  counters_.rows += static_cast<std::int64_t>(rows);
  counters_.last_received = received;
  emit(std::move(batch));
}

SourceStatus BatchAssembler::counters() const {
  SourceStatus status = counters_;
  status.lost_rows = forgotten_.lost_rows;
  status.duplicate_rows = forgotten_.duplicate_rows;
  status.reordered_batches = forgotten_.reordered_batches;
  for (const auto& [id, session] : sessions_) AddSequence(session.sequence, status);
  return status;
}

}  // namespace hydroscope
