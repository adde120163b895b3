#include "acquisition/batch_assembler.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace hydroscope {
namespace {

constexpr std::size_t kMostChannels = 4096;
constexpr std::size_t kMostLayouts = 16;  // of one session
constexpr std::int64_t kMostPeriod = 1'000'000'000'000;
constexpr std::int64_t kLeeway = 1'000'000'000;    // ns a count may be beside what the time that passed says
constexpr std::uint64_t kReadingsOfLeeway = 1000;  // the same of single readings, which tell no period
constexpr std::int64_t kStillSends = 2'000'000'000;    // ns since its newest batch
constexpr std::int64_t kFaultStands = 60'000'000'000;  // ns of sound batches
constexpr std::int64_t kMostTime = std::numeric_limits<std::int64_t>::max() / 2;

void AddSequence(const SequenceMonitor& sequence, SourceStatus& status) {
  status.lost_rows += sequence.lost();
  status.duplicate_rows += sequence.duplicates();
  status.reordered_batches += sequence.reordered();
}

std::string FaultOf(const BatchMessage& m) {
  if (m.version != kLiveProtocolVersion)
    return fmt::format("version {} of the protocol, expected {}", m.version, kLiveProtocolVersion);
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
  if (fault_.empty()) fault_ = std::move(complaint);
  faulty_ = counters_.last_received.monotonic_ns;
}

/// What none of those who send announces. Somebody else's layout does not make a channel missing that its sender announced.
std::string BatchAssembler::Missing() const {
  std::int64_t newest = 0;
  for (const auto& [key, session] : sessions_) newest = std::max(newest, session.received);
  const Session* latest = nullptr;
  std::vector<bool> announced(wanted_.size(), false);
  for (const auto& [key, session] : sessions_) {
    if (newest - session.received > kStillSends || session.layouts.empty()) continue;
    for (const auto& [id, layout] : session.layouts)
      for (const std::uint16_t channel : layout.channels) announced[channel] = true;
    if (latest == nullptr || session.used > latest->used) latest = &session;
  }
  if (latest == nullptr) return "";
  const Layout& layout = latest->layouts.rbegin()->second;
  for (std::size_t channel = 0; channel < wanted_.size(); ++channel)
    if (!wanted_[channel].empty() && !announced[channel])
      return fmt::format("the sender announces {} channels but not {}{}; it announces e.g. {}",
                         layout.columns, wanted_[channel],
                         layout.channels.empty() ? " nor any other wanted one" : "", layout.example);
  return "";
}

/// Of the writer with the most sessions the one used longest ago, so that nobody who invents sessions makes us
/// forget those of another one.
BatchAssembler::SessionKey BatchAssembler::OldestOfTheBusiest() const {
  std::map<std::uint64_t, std::size_t> of_writer;
  for (const auto& [key, session] : sessions_) ++of_writer[key.first];
  return std::max_element(sessions_.begin(), sessions_.end(),
                          [&](const auto& a, const auto& b) {
                            return std::pair(of_writer[a.first.first], b.second.used) <
                                   std::pair(of_writer[b.first.first], a.second.used);
                          })
      ->first;
}

BatchAssembler::Session& BatchAssembler::SessionOf(SessionKey key) {
  if (!sessions_.contains(key) && sessions_.size() == kSessionsKept) {
    const auto oldest = sessions_.find(OldestOfTheBusiest());
    AddSequence(oldest->second.sequence, forgotten_);
    sessions_.erase(oldest);
  }
  Session& session = sessions_[key];
  session.used = ++messages_;
  return session;
}

void BatchAssembler::Receive(const LayoutMessage& message, const Emit& emit) {
  if (message.version != kLiveProtocolVersion)
    return Malformed(fmt::format("the sender speaks version {} of the protocol, expected {}", message.version,
                                 kLiveProtocolVersion));
  if (message.channels.empty() || message.channels.size() > kMostChannels)
    return Malformed(fmt::format("a layout of {} channels", message.channels.size()));
  Session& session = SessionOf({message.writer, message.session});
  if (session.layouts.size() == kMostLayouts) session.layouts.erase(session.layouts.begin());
  Layout& layout = session.layouts[message.layout_id];
  layout = {.columns = message.channels.size(),
            .example = message.channels.front().substr(0, 255),
            .channels = {},
            .from_columns = {}};
  for (std::size_t channel = 0; channel < wanted_.size(); ++channel) {
    if (wanted_[channel].empty()) continue;
    const auto found = std::find(message.channels.begin(), message.channels.end(), wanted_[channel]);
    if (found == message.channels.end()) continue;
    layout.channels.push_back(static_cast<std::uint16_t>(channel));
    layout.from_columns.push_back(static_cast<std::size_t>(found - message.channels.begin()));
  }
  fault_.clear();
  std::vector<Waiting> waiting;
  std::swap(waiting, waiting_);
  for (Waiting& w : waiting) Receive(std::move(w.message), w.received, emit);
}

void BatchAssembler::Receive(BatchMessage&& message, HostTime received, const Emit& emit) {
  if (std::string fault = FaultOf(message); !fault.empty()) return Malformed("the sender sent " + fault);
  if (message.rows > kMostRows)
    return Malformed(fmt::format("the sender sent a batch of {} rows", message.rows));
  Session& session = SessionOf({message.writer, message.session});
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

/// More than kLeeway beside where the count can be by now. Rows of a hole that come late are where they were expected.
bool BatchAssembler::IsElsewhere(const Session& session, const BatchMessage& message, std::int64_t now) {
  const auto next = session.sequence.next();
  if (!next) return false;
  const auto rows = [&](std::int64_t ns) {
    return message.period_ns > 0 ? static_cast<std::uint64_t>(ns / message.period_ns) : kReadingsOfLeeway;
  };
  if (message.first_sequence > *next)
    return message.first_sequence - *next > rows(now - session.received + kLeeway) + message.rows;
  return *next - message.first_sequence > rows(kLeeway) + message.rows &&
         !session.sequence.Lacks(message.first_sequence);
}

void BatchAssembler::Deliver(Session& session, const Layout& layout, BatchMessage& message, HostTime received,
                             const Emit& emit) {
  SequenceMonitor::Verdict verdict;
  const std::int64_t now = received.monotonic_ns;
  const bool elsewhere = IsElsewhere(session, message, now);
  if (!elsewhere) session.jump.Forget();
  if (const bool goes_on = elsewhere && session.jump.GoesOn(message.first_sequence, message.rows, now);
      !elsewhere || goes_on) {
    if (goes_on) session.sequence.GoOnAt(message.first_sequence);
    verdict = session.sequence.Receive(message.first_sequence, message.rows);
    session.received = now;
  }
  const std::size_t rows = message.rows - verdict.skip;
  if (rows == 0 || layout.channels.empty()) return;
  SampleBatch batch;
  batch.writer = message.writer;
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
  if (now - faulty_ > kFaultStands) fault_.clear();
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
