#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"

namespace eprosima::fastdds::dds {
class DomainParticipant;
class Topic;
class DataReaderQos;
class DataWriterQos;
class TypeSupport;
struct SampleInfo;
}  // namespace eprosima::fastdds::dds

namespace hydroscope {

/// How a participant reaches the others.
struct DdsNetwork {
  int domain = 0;
  bool udp = true;
  /// Left out by itself where it cannot work: /dev/shm is too small, or another user has memory there.
  bool shared_memory = true;
  std::vector<std::string> interfaces;  ///< IPv4 addresses of network cards; empty: all
  std::vector<std::string> peers;       ///< IPv4 addresses asked directly, for networks without multicast
  std::string security = "";  ///< folder of the certificates of DDS Security; "": anybody may take part
  std::string section = "live.dds";  ///< of the machine file, for messages
};

/// A participant somewhere else, as it announced itself.
struct DdsPeer {
  std::string name, address;  ///< IPv4; "" if it announced none
};
/// Number of the participant that sent a sample: the same for all its writers, another one in each of its lives.
std::uint64_t DdsPeerId(const eprosima::fastdds::dds::SampleInfo& sample);

/// A DDS participant with the settings that proved themselves: it announces itself every 0.25 s and counts as
/// gone 1 s after its last sign of life (the defaults, 3 s and 20 s, block a sender for as long when a reader
/// dies). Announcements always go by UDP (by the loopback if shared memory is all that is wanted); shared
/// memory carries data only, through a port that is new in every life, and what killed processes left there
/// is removed. With DDS Security only participants whose certificate the same authority signed are heard, and
/// what they send is encrypted (`scripts/dds_certificates.sh`).
class DdsParticipant {
 public:
  /// Errors: no such interface, no address, another program on the domain's port, a file of DDS Security that cannot be read or used, shared memory alone on a /dev/shm below 8 MB (the library would
  /// die of SIGBUS).
  static Result<std::unique_ptr<DdsParticipant>> Create(const DdsNetwork& network, const std::string& name);
  /// Deletes what was made of it: topics, readers, writers.
  ~DdsParticipant();
  DdsParticipant(const DdsParticipant&) = delete;
  DdsParticipant& operator=(const DdsParticipant&) = delete;

  eprosima::fastdds::dds::DomainParticipant* get() const { return participant_; }
  Result<eprosima::fastdds::dds::Topic*> MakeTopic(const std::string& name,
                                                   const eprosima::fastdds::dds::TypeSupport& type);
  /// nullopt if it has gone.
  std::optional<DdsPeer> peer(std::uint64_t id) const;
  /// Why data do not go by shared memory though that was asked for; "" if they do.
  const std::string& without_shared_memory() const { return without_shared_memory_; }
  /// Participants whose certificate was not accepted.
  std::int64_t not_authenticated() const;

 private:
  class Neighbours;
  DdsParticipant(eprosima::fastdds::dds::DomainParticipant* participant,
                 std::unique_ptr<Neighbours> neighbours, int id);
  eprosima::fastdds::dds::DomainParticipant* participant_;
  std::unique_ptr<Neighbours> neighbours_;  ///< is told by the participant as long as that lives
  int id_;
  std::string without_shared_memory_;
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

/// UDP port that the participants of a domain share for announcements to all (DDSI-RTPS, 9.6.1.1).
int DiscoveryPort(int domain);

/// Topic of the layout that belongs to a topic of samples.
std::string LayoutTopic(const std::string& samples);

}  // namespace hydroscope
