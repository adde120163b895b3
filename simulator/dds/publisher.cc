#include "simulator/dds/publisher.h"

#include <hydroscope_wire/hydroscope_livePubSubTypes.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

namespace hydroscope {
namespace {

using namespace eprosima::fastdds::dds;

class Publication : public SamplePublisher {
 public:
  Publication(std::unique_ptr<DdsParticipant> participant, DataWriter* samples, std::uint64_t session)
      : participant_(std::move(participant)), samples_(samples) {
    batch_.version(hydroscope_wire::kVersion);
    batch_.session(session);
  }

  bool Write(std::uint64_t first_sequence, std::int64_t source_time_ns, std::int64_t period_ns,
             std::uint32_t rows, const std::vector<double>& values) override {
    batch_.first_sequence(first_sequence);
    batch_.source_time_ns(source_time_ns);
    batch_.period_ns(period_ns);
    batch_.rows(rows);
    batch_.values(values);
    return samples_->write(&batch_);
  }

  int readers() const override {
    PublicationMatchedStatus status;
    samples_->get_publication_matched_status(status);
    return status.current_count;
  }

  bool Drain(double seconds) override {
    return samples_->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(seconds)) ==
           ReturnCode_t::RETCODE_OK;
  }

 private:
  std::unique_ptr<DdsParticipant> participant_;
  DataWriter* samples_;
  hydroscope_wire::Batch batch_;
};

hydroscope_wire::Layout LayoutOf(const SamplePublisher::Options& options) {
  hydroscope_wire::Layout layout;
  layout.version(hydroscope_wire::kVersion);
  layout.session(options.session);
  for (const std::string& name : options.channels) layout.channels().emplace_back(name);
  for (const std::string& unit : options.units) layout.units().emplace_back(unit);
  return layout;
}

}  // namespace

Result<std::unique_ptr<SamplePublisher>> SamplePublisher::Create(const Options& options) {
  auto participant = TRY(DdsParticipant::Create(options.network, options.name));
  const auto layouts =
      TRY((participant)
              ->MakeTopic(LayoutTopic(options.topic), TypeSupport(new hydroscope_wire::LayoutPubSubType())));
  const auto samples =
      TRY(participant->MakeTopic(options.topic, TypeSupport(new hydroscope_wire::BatchPubSubType())));
  Publisher* publisher = participant->get()->create_publisher(PUBLISHER_QOS_DEFAULT);
  DataWriter* layout_writer = publisher ? publisher->create_datawriter(layouts, LayoutWriterQos()) : nullptr;
  DataWriter* sample_writer = publisher ? publisher->create_datawriter(samples, SampleWriterQos()) : nullptr;
  if (layout_writer == nullptr || sample_writer == nullptr)
    return InternalError("DDS gives no writer for topic {}", options.topic);
  hydroscope_wire::Layout layout = LayoutOf(options);
  if (!layout_writer->write(&layout))
    return InternalError("DDS does not take the layout of {} channels", options.channels.size());
  return std::make_unique<Publication>(std::move(participant), sample_writer, options.session);
}

}  // namespace hydroscope
