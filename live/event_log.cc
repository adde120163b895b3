#include "live/event_log.h"

#include <fmt/format.h>

#include "core/printable.h"
#include "live/log.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kRowsAtOnce = 1000;
constexpr std::int64_t kBetweenCounts = 60'000'000'000;  ///< ns

void TellRow(const JournalRow& row) {
  const AlarmEvent& e = row.event;
  LogFields fields = {{"machine", row.machine}, {"what", e.event}, {"row", std::to_string(row.sequence)}};
  if (!e.alarm.empty()) fields.push_back({"alarm", e.alarm});
  fields.push_back({"severity", SeverityName(e.severity)});
  if (e.stroke >= 0) fields.push_back({"stroke", std::to_string(e.stroke)});
  for (const auto& [key, text] : {std::pair("user", e.user), {"comment", e.comment}, {"text", e.text}})
    if (!text.empty()) fields.push_back({key, Printable(text)});
  (e.event == "raised" || e.event == "escalated" ? LogWarning : LogInfo)("alarm", fields);
}

std::string NameOf(const SenderStatus& sender) { return sender.name.empty() ? "unnamed" : sender.name; }

}  // namespace

EventLog::EventLog(std::string journal) : journal_path_(std::move(journal)) {
  if (auto opened = AlarmJournal::OpenExisting(journal_path_)) journal_ = std::move(*opened);
  if (!journal_) return;
  if (const auto last = journal_->LastSequence()) told_ = *last;
}

void EventLog::Look(const LiveStatus& status) {
  for (const SourceStatus& source : status.sources) {
    const Link now{source.connected, source.state.english};
    if (Link& before = sources_[source.name]; std::exchange(before, now) != now)
      (now.connected ? LogInfo : LogWarning)(
          now.connected ? "source_connected" : "source_not_connected",
          {{"source", Printable(source.name)}, {"state", Printable(source.state.english)}});
  }
  for (const FeedStatus& feed : status.feeds) {
    // While it is connected its state counts clients and rows: no event.
    const Link now{feed.connected, feed.connected ? "" : feed.state.english};
    if (Link& before = feeds_[feed.name]; std::exchange(before, now) != now) {
      if (now.connected)
        LogInfo("feed_connected", {{"feed", Printable(feed.name)}});
      else
        LogWarning("feed_not_connected",
                   {{"feed", Printable(feed.name)}, {"why", Printable(feed.state.english)}});
    }
  }
  LookAtRefusals(status);
  LookAtSenders(status);
  LookAtEstimates(status);
  LookAtJournal();
}

/// Once as they begin: values in the sentences change with every stroke.
void EventLog::LookAtEstimates(const LiveStatus& status) {
  for (const AxisStatus& axis : status.axes) {
    if (axis.warnings.empty()) {
      doubtful_.erase(axis.name);
    } else if (doubtful_.insert(axis.name).second) {
      for (const Told& warning : axis.warnings)
        LogWarning("doubtful_estimates", {{"axis", axis.name}, {"why", Printable(warning.english)}});
    }
  }
}

void EventLog::TellCount(const char* event, const LogFields::value_type& who, std::int64_t count,
                         const std::string& why, std::int64_t now) {
  Count& before = counts_[fmt::format("{} {}", event, who.second)];
  if (count <= before.told || (before.told > 0 && now - before.at < kBetweenCounts)) return;
  LogFields fields = {who, {"count", std::to_string(count - before.told)}};
  if (!why.empty()) fields.push_back({"why", Printable(why)});
  LogWarning(event, fields);
  before = {count, now};
}

void EventLog::LookAtRefusals(const LiveStatus& status) {
  for (const FeedStatus& feed : status.feeds)
    TellCount("client_refused", {"feed", Printable(feed.name)}, feed.refused, feed.refusal, status.taken);
  for (const SourceStatus& source : status.sources) {
    const LogFields::value_type who{"source", Printable(source.name)};
    TellCount("sender_refused", who, source.refused, "", status.taken);
    TellCount("malformed_messages", who, source.malformed, source.state.english, status.taken);
  }
  TellCount("malformed_batches", {"machine", Printable(status.machine)}, status.malformed, "", status.taken);
}

void EventLog::LookAtSenders(const LiveStatus& status) {
  std::map<SenderId, std::string> now;
  for (const SenderStatus& sender : status.senders) {
    now[sender.id] = NameOf(sender);
    if (!senders_.contains(sender.id))
      LogInfo("sender_found", {{"sender", Printable(NameOf(sender))},
                               {"session", std::to_string(sender.id.session)},
                               {"channels", std::to_string(sender.channels)},
                               {"refused_channels", std::to_string(sender.refused.size())}});
  }
  for (const auto& [id, name] : senders_)
    if (!now.contains(id))
      LogWarning("sender_silent", {{"sender", Printable(name)}, {"session", std::to_string(id.session)}});
  senders_ = std::move(now);
}

void EventLog::LookAtJournal() {
  if (!journal_) {
    auto opened = AlarmJournal::OpenExisting(journal_path_);
    if (!opened) return;  // there is none yet
    journal_ = std::move(*opened);
  }
  const auto rows = journal_->Rows("", told_.value_or(0), kRowsAtOnce);
  if (!rows) return journal_.reset();  // what keeps it from being read is told by those who write it
  for (const JournalRow& row : *rows) {
    TellRow(row);
    told_ = row.sequence;
  }
}

}  // namespace hydroscope
