#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/result.h"

namespace eprosima::fastdds::dds {
class DomainParticipant;
class Topic;
class DataReaderQos;
class DataWriterQos;
class TypeSupport;
}  // namespace eprosima::fastdds::dds

namespace hydroscope {

/// How a participant reaches the others.
struct DdsNetwork {
  int domain = 0;
  bool udp = true;
  bool shared_memory = true;  ///< left out by itself where /dev/shm is too small, unless it is the only way
  std::vector<std::string> interfaces;  ///< IPv4 addresses of network cards; empty: all
  std::vector<std::string> peers;       ///< IPv4 addresses asked directly, for networks without multicast
  std::string section = "live.dds";     ///< of the machine file, for messages
};

/// A DDS participant with the settings that proved themselves: it announces itself every 0.25 s and counts as
/// gone 1 s after its last sign of life (the defaults, 3 s and 20 s, block a sender for as long when a reader
/// dies). Announcements always go by UDP (by the loopback if shared memory is all that is wanted); shared
/// memory carries data only, through a port that is new in every life, and what killed processes left there
/// is removed.
class DdsParticipant {
 public:
  /// Errors: no such interface, no address, shared memory alone on a /dev/shm below 8 MB (the library would
  /// die of SIGBUS).
  static Result<std::unique_ptr<DdsParticipant>> Create(const DdsNetwork& network, const std::string& name);
  /// Deletes what was made of it: topics, readers, writers.
  ~DdsParticipant();
  DdsParticipant(const DdsParticipant&) = delete;
  DdsParticipant& operator=(const DdsParticipant&) = delete;

  eprosima::fastdds::dds::DomainParticipant* get() const { return participant_; }
  Result<eprosima::fastdds::dds::Topic*> MakeTopic(const std::string& name,
                                                   const eprosima::fastdds::dds::TypeSupport& type);

 private:
  DdsParticipant(eprosima::fastdds::dds::DomainParticipant* participant, int id)
      : participant_(participant), id_(id) {}
  eprosima::fastdds::dds::DomainParticipant* participant_;
  int id_;
};

/// Both sides of samples: reliable, nothing overwritten (KEEP_ALL, at most `batches` kept), heartbeat every
/// 20 ms, dead 0.5 s after the last sign of life. A writer keeps its latest batches for readers that ask for
/// a backlog and waits 20 ms at most for a slow reader, then drops the batch.
inline constexpr int kBatchesKept = 500;
eprosima::fastdds::dds::DataWriterQos SampleWriterQos();
/// `deadline` in s.
eprosima::fastdds::dds::DataReaderQos SampleReaderQos(double deadline, bool backlog);

/// Both sides of the layout: reliable, the latest one of each sender is kept for late joiners.
eprosima::fastdds::dds::DataWriterQos LayoutWriterQos();
eprosima::fastdds::dds::DataReaderQos LayoutReaderQos();

/// Both sides of alarm events: reliable, in order, nothing overwritten; the newest `kAlarmEventsKept` are
/// kept for late joiners. A writer waits 20 ms at most for a slow reader, then refuses.
inline constexpr int kAlarmEventsKept = 4096;
eprosima::fastdds::dds::DataWriterQos AlarmEventWriterQos();
eprosima::fastdds::dds::DataReaderQos AlarmEventReaderQos();

/// Both sides of findings: reliable, keyed, the latest of each is kept for late joiners.
inline constexpr int kMostFindings = 8192;
eprosima::fastdds::dds::DataWriterQos FindingWriterQos();
eprosima::fastdds::dds::DataReaderQos FindingReaderQos();

/// Offered by a sender, s: a reader may not ask for less.
inline constexpr double kOfferedDeadline = 0.1;

/// Topic of the layout that belongs to a topic of samples.
std::string LayoutTopic(const std::string& samples);

}  // namespace hydroscope
