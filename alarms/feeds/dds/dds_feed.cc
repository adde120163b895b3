#include <fmt/format.h>
#include <hydroscope_wire/hydroscope_alarmsPubSubTypes.h>

#include <algorithm>
#include <cmath>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <mutex>

#include "alarms/feeds/dds/messages.h"
#include "alarms/feeds/dds/settings.h"
#include "alarms/feeds/feed_context.h"
#include "alarms/feeds/feed_loop.h"
#include "alarms/feeds/list.h"
#include "dds/participant.h"

namespace hydroscope {
namespace {

using namespace eprosima::fastdds::dds;

constexpr std::int64_t kRowsAtOnce = 500;
constexpr std::int64_t kBacklog = 500;  // rows from before the start that are told again

/// Equal, what is not known included.
bool Same(AlarmState a, AlarmState b) {
  for (double AlarmState::*number : {&AlarmState::value, &AlarmState::std, &AlarmState::limit})
    if (std::isnan(a.*number) && std::isnan(b.*number)) a.*number = b.*number = 0;
  return a == b;
}

/// Participant and writers.
class Publication {
 public:
  static Result<std::unique_ptr<Publication>> Create(const DdsFeedSpec& spec) {
    auto participant = TRY(DdsParticipant::Create({.domain = spec.domain,
                                                   .udp = spec.transport != DdsTransport::kSharedMemory,
                                                   .shared_memory = spec.transport != DdsTransport::kUdp,
                                                   .interfaces = spec.interfaces,
                                                   .peers = spec.peers,
                                                   .security = spec.security,
                                                   .section = "feeds.dds"},
                                                  "hydroscope_alarms"));
    std::unique_ptr<Publication> made(new Publication);
    made->participant_ = std::move(participant);
    const auto events = TRY(made->MakeWriter(spec.topic + "/alarms", AlarmEventWriterQos(),
                                             TypeSupport(new hydroscope_wire::AlarmEventPubSubType())));
    const auto findings = TRY(made->MakeWriter(spec.topic + "/findings", FindingWriterQos(),
                                               TypeSupport(new hydroscope_wire::FindingPubSubType())));
    made->events_ = events;
    made->findings_ = findings;
    return made;
  }

  Status Write(const JournalRow& row) {
    auto wire = ToWire(row);
    return Judge(events_->write(&wire));
  }
  Status Write(const AxisPicture& axis, const AlarmState& alarm) {
    auto wire = ToWire(axis, alarm);
    return Judge(findings_->write(&wire));
  }
  int readers() const {
    PublicationMatchedStatus matched;
    events_->get_publication_matched_status(matched);
    return matched.current_count;
  }

 private:
  Publication() = default;
  static Status Judge(bool taken) {
    if (taken) return {};
    return InternalError("DDS takes no message: a reader does not keep up, or there are more than {} alarms",
                         kMostFindings);
  }
  Result<DataWriter*> MakeWriter(const std::string& name, const DataWriterQos& qos, const TypeSupport& type) {
    const auto topic = TRY(participant_->MakeTopic(name, type));
    Publisher* publisher = participant_->get()->create_publisher(PUBLISHER_QOS_DEFAULT);
    DataWriter* writer = publisher != nullptr ? publisher->create_datawriter(topic, qos) : nullptr;
    if (writer == nullptr) return InternalError("DDS gives no writer for topic {}", name);
    return writer;
  }

  std::unique_ptr<DdsParticipant> participant_;
  DataWriter* events_ = nullptr;
  DataWriter* findings_ = nullptr;
};

/// Journal rows on <topic>/alarms and the present state of every alarm on <topic>/findings,
/// by DDS (docs/live_protocol.md).
class DdsFeed : public Feed {
 public:
  DdsFeed(DdsFeedSpec spec, FeedReader reader, Clock clock)
      : spec_(std::move(spec)),
        reader_(std::move(reader)),
        clock_(std::move(clock)),
        loop_(kLookPeriod, [this] { return Round(); }) {}
  ~DdsFeed() override { loop_.Stop(); }

  FeedStatus status() const override {
    std::lock_guard lock(mutex_);
    FeedStatus status = status_;
    status.name = fmt::format("dds {} domain {}", spec_.topic, spec_.domain);
    status.errors = loop_.errors();
    if (const hydroscope::Told problem = loop_.problem(); !problem.empty()) status.state = problem;
    return status;
  }

 private:
  Status Round() {
    TRY(Open());
    const auto rows = reader_.Rows(cursor_, kRowsAtOnce);
    if (!rows) {
      static_cast<void>(TellFindings(true));  // health is told all the same
      return tl::unexpected(rows.error());
    }
    for (const JournalRow& row : *rows) {
      TRY(publication_->Write(row));
      cursor_ = row.sequence;
    }
    TRY(TellFindings(!rows->empty()));
    const auto last = TRY(reader_.LastSequence());
    if (last > cursor_) loop_.Wake();
    std::lock_guard lock(mutex_);
    status_ = {.name = {},
               .connected = true,
               .state = {"publishing", "sendet"},
               .clients = publication_->readers(),
               .delivered = cursor_,
               .behind = last - cursor_,
               .errors = 0};
    return {};
  }

  Status Open() {
    if (publication_) return {};
    const auto last = TRY(reader_.LastSequence());
    publication_ = TRY(Publication::Create(spec_));
    cursor_ = std::max<std::int64_t>(0, last - kBacklog);
    return {};
  }

  /// Alarms that changed since they were told.
  Status TellFindings(bool news) {
    const std::int64_t now = clock_().monotonic_ns;
    if (!news && now - pictured_ < kPicturePeriod) return {};
    pictured_ = now;
    auto axes = TRY(reader_.Axes());
    for (AxisPicture& axis : axes) {
      axis.alarms.push_back(HealthAsAlarm(axis.health));
      for (const AlarmState& alarm : axis.alarms) {
        Told& told = told_[{axis.machine, alarm.id}];
        if (told.health == axis.health && Same(told.alarm, alarm)) continue;
        TRY(publication_->Write(axis, alarm));
        told = {axis.health, alarm};
      }
    }
    return {};
  }

  struct Told {
    Health health;
    AlarmState alarm;
  };

  DdsFeedSpec spec_;
  FeedReader reader_;
  Clock clock_;
  std::unique_ptr<Publication> publication_;
  std::int64_t cursor_ = 0;
  std::int64_t pictured_ = -kPicturePeriod;  // ns, monotonic
  std::map<std::pair<std::string, std::string>, Told> told_;

  mutable std::mutex mutex_;
  FeedStatus status_;  // guarded
  FeedLoop loop_;
};

}  // namespace

std::unique_ptr<Feed> MakeDdsFeed(const FeedContext& context) {
  const auto* spec = context.machine.feeds->Of<DdsFeedSpec>();
  if (spec == nullptr) return nullptr;
  return std::make_unique<DdsFeed>(*spec, context.Reader(), context.clock);
}

}  // namespace hydroscope
