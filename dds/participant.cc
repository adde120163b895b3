#include "dds/participant.h"

#include <arpa/inet.h>
#include <fastdds/rtps/transport/TransportInterface.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/attributes/LibrarySettingsAttributes.h>
#include <fastrtps/utils/IPFinder.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fstream>
#include <map>
#include <mutex>
#include <set>

#include "core/contains.h"
#include "core/secret_file.h"
#include "dds/shared_memory.h"
#include "dds/steady_waits.h"

namespace hydroscope {
namespace {

using namespace eprosima::fastdds::dds;
using eprosima::fastdds::rtps::SharedMemTransportDescriptor;
using eprosima::fastdds::rtps::TransportInterface;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::types::ReturnCode_t;

constexpr std::uint64_t kSharedMemoryNeeded = 8u << 20;
constexpr std::uint32_t kPortsAskedAtPeers = 16;   // participants of a computer that a peer's address reaches
constexpr char kDiscoveryGroup[] = "239.255.0.1";  // of the DDSI-RTPS specification, 9.6.1.4.1
constexpr std::uint32_t kSocketBuffer = 4u << 20;

/// Numbers of this process's participants; a number determines the ports. Left to itself the library never
/// uses one twice, so that a source that is built anew again and again would wander off the ports that peers ask.
class ParticipantIds {
 public:
  int Take() {
    std::lock_guard lock(mutex_);
    int id = 0;
    while (!taken_.insert(id).second) ++id;
    return id;
  }
  void Release(int id) {
    std::lock_guard lock(mutex_);
    taken_.erase(id);
  }

 private:
  std::mutex mutex_;
  std::set<int> taken_;
};
ParticipantIds& Ids() {
  static ParticipantIds ids;
  return ids;
}

Duration_t Seconds(double s) {
  const double whole = std::floor(s);
  return Duration_t(static_cast<std::int32_t>(whole), static_cast<std::uint32_t>((s - whole) * 1e9));
}

std::uint64_t FreeSharedMemory() {
  struct statvfs disk {};
  if (statvfs("/dev/shm", &disk) != 0) return 0;
  return static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
}

std::vector<std::string> OwnAddresses() {
  std::vector<eprosima::fastrtps::rtps::IPFinder::info_IP> found;
  eprosima::fastrtps::rtps::IPFinder::getIPs(&found, true);
  std::vector<std::string> addresses;
  for (const auto& info : found)
    if (info.type == eprosima::fastrtps::rtps::IPFinder::IP4 ||
        info.type == eprosima::fastrtps::rtps::IPFinder::IP4_LOCAL)
      addresses.push_back(info.name);
  return addresses;
}

Status CheckAddresses(const DdsNetwork& network) {
  for (const std::string& peer : network.peers) {
    in_addr address{};
    if (inet_pton(AF_INET, peer.c_str(), &address) != 1)
      return BadInput("[{}] peers: \"{}\" is no IPv4 address; expected e.g. \"192.168.0.20\"",
                      network.section, peer);
  }
  const std::vector<std::string> own = OwnAddresses();
  for (const std::string& wanted : network.interfaces)
    if (!Contains(own, wanted))
      return BadInput("[{}] interfaces: this computer has no address {}; it has {}", network.section, wanted,
                      fmt::format("{}", fmt::join(own, ", ")));
  return {};
}

/// Announcements to all come to a port that participants share. Where another program has it for itself the library goes on
/// without, finds nobody, and tells nobody.
Status CheckDiscoveryPort(const DdsNetwork& network) {
  const int port = DiscoveryPort(network.domain);
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(probe, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool taken =
      bind(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 && errno == EADDRINUSE;
  if (probe >= 0) close(probe);
  if (!taken) return {};
  return InternalError(
      "[{}] UDP port {} of domain {} is taken by another program (`ss -ulpn sport = :{}` names it), so that nobody can "
      "be found; end that program, or use another domain",
      network.section, port, network.domain, port);
}

/// Where this participant listens; `without`: why not by shared memory, though that was asked for. Announcements go by UDP, by the loopback alone where data shall go by
/// shared memory alone: the library's shared port for announcements keeps a place for each killed process
/// until it is full or locked for good. Data have ports of shared memory that no process had before.
Status AddTransports(const DdsNetwork& network, DomainParticipantQos& qos, std::string& without) {
  qos.transport().use_builtin_transports = false;
  const bool room = FreeSharedMemory() >= kSharedMemoryNeeded;
  if (!network.udp && !room)
    return BadInput(
        "/dev/shm has {} kB free, shared memory needs {} kB; enlarge it or use transport = \"udp\"",
        FreeSharedMemory() >> 10, kSharedMemoryNeeded >> 10);
  auto udp = std::make_shared<UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = network.udp ? network.interfaces : std::vector<std::string>{"127.0.0.1"};
  udp->sendBufferSize = udp->receiveBufferSize = kSocketBuffer;
  udp->maxInitialPeersRange = kPortsAskedAtPeers;
  qos.transport().user_transports.push_back(udp);
  if (!network.shared_memory) return {};
  if (!room) {
    without = fmt::format("/dev/shm has only {} kB free", FreeSharedMemory() >> 10);
    return {};
  }
  if (network.udp && !TimedWaitsAreSteady()) {
    without =
        "another library replaces the timed waits of this program, so that a step of the clock could lose rows";
    return {};
  }
  RemoveDeadSharedMemory();
  const SharedMemoryUsers users = UsersOfSharedMemory();
  if (!network.udp && !users.other.empty() && !users.own)
    return BadInput(
        "[{}] transport = \"shm\": the shared memory of DDS on this computer belongs to user {}, and "
        "cannot be shared with another one; run both as the same user, or use transport = \"udp\"",
        network.section, users.other);
  if (network.udp && !users.other.empty()) {
    without =
        fmt::format("shared memory on this computer belongs to user {}, another one than ours", users.other);
    return {};
  }
  auto shared_memory = std::make_shared<SharedMemTransportDescriptor>();
  qos.transport().user_transports.push_back(shared_memory);
  Locator_t any_card, group;
  IPLocator::setIPv4(group, kDiscoveryGroup);
  auto& wire = qos.wire_protocol();
  wire.builtin.metatrafficUnicastLocatorList.push_back(any_card);
  wire.builtin.metatrafficMulticastLocatorList.push_back(group);
  if (network.udp) wire.default_unicast_locator_list.push_back(any_card);
  const std::unique_ptr<TransportInterface> maker(shared_memory->create_transport());
  maker->getDefaultUnicastLocators(wire.default_unicast_locator_list, UnusedSharedMemoryPort());
  return {};
}

/// Files of DDS Security 1.1, 8.4 and 9.4, as scripts/dds_certificates.sh makes them, and the properties of the
/// library that want them.
constexpr std::pair<const char*, const char*> kSecurityFiles[] = {
    {"dds.sec.auth.builtin.PKI-DH.identity_ca", "ca.pem"},
    {"dds.sec.auth.builtin.PKI-DH.identity_certificate", "certificate.pem"},
    {"dds.sec.auth.builtin.PKI-DH.private_key", "key.pem"},
    {"dds.sec.access.builtin.Access-Permissions.permissions_ca", "ca.pem"},
    {"dds.sec.access.builtin.Access-Permissions.governance", "governance.smime"},
    {"dds.sec.access.builtin.Access-Permissions.permissions", "permissions.smime"},
};

/// Who is not signed by the same authority is not spoken to; what is sent is encrypted and signed.
Status AddSecurity(const DdsNetwork& network, DomainParticipantQos& qos) {
  if (network.security.empty()) return {};
  auto& properties = qos.properties().properties();
  properties.emplace_back("dds.sec.auth.plugin", "builtin.PKI-DH");
  properties.emplace_back("dds.sec.access.plugin", "builtin.Access-Permissions");
  properties.emplace_back("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
  for (const auto& [property, name] : kSecurityFiles) {
    const std::string path = network.security + "/" + name;
    if (!std::ifstream(path))
      return BadInput("[{}] security: {} cannot be read; scripts/dds_certificates.sh makes such a folder",
                      network.section, path);
    properties.emplace_back(property, "file://" + path);
  }
  return CheckSecret(network.security + "/key.pem", fmt::format("[{}] security: key.pem", network.section));
}

/// FNV-1a of the part of a GUID that all writers of a participant share.
std::uint64_t PeerId(const eprosima::fastrtps::rtps::GuidPrefix_t& prefix) {
  std::uint64_t id = 0xcbf29ce484222325ull;
  for (const auto byte : prefix.value) id = (id ^ byte) * 0x100000001b3ull;
  return id;
}

template <typename Qos>
void SetCommon(Qos& qos, std::int32_t samples) {
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  qos.history().kind = KEEP_ALL_HISTORY_QOS;
  qos.resource_limits().max_samples = samples;
  qos.resource_limits().max_instances = 1;
  qos.resource_limits().max_samples_per_instance = samples;
  qos.resource_limits().allocated_samples = std::min(samples, 32);
  qos.liveliness().kind = AUTOMATIC_LIVELINESS_QOS;
  qos.liveliness().lease_duration = Seconds(0.5);
  qos.liveliness().announcement_period = Seconds(0.2);
  qos.data_sharing().off();
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
}

void SetHeartbeat(DataWriterQos& qos) {
  qos.reliable_writer_qos().times.heartbeatPeriod = Seconds(0.02);
  qos.reliability().max_blocking_time = Seconds(0.02);
}

template <typename Qos>
void KeepLatestOfEach(Qos& qos) {
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 1;
  qos.resource_limits().max_instances = kMostFindings;
  qos.resource_limits().max_samples_per_instance = 1;
}

}  // namespace

/// The participants that are there, as the library's discovery tells them.
class DdsParticipant::Neighbours : public DomainParticipantListener {
 public:
  void on_participant_discovery(DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& found) override {
    using Info = eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;
    const std::uint64_t id = PeerId(found.info.m_guid.guidPrefix);
    std::lock_guard lock(mutex_);
    if (found.status == Info::REMOVED_PARTICIPANT || found.status == Info::DROPPED_PARTICIPANT) {
      peers_.erase(id);
      return;
    }
    DdsPeer& peer = peers_[id];
    peer.name = found.info.m_participantName.to_string();
    for (const Locator_t& locator : found.info.default_locators.unicast)
      if (locator.kind == LOCATOR_KIND_UDPv4) peer.address = IPLocator::toIPv4string(locator);
  }
  void onParticipantAuthentication(DomainParticipant*,
                                   eprosima::fastrtps::rtps::ParticipantAuthenticationInfo&& info) override {
    using Info = eprosima::fastrtps::rtps::ParticipantAuthenticationInfo;
    std::lock_guard lock(mutex_);
    not_authenticated_ += info.status == Info::UNAUTHORIZED_PARTICIPANT;
  }
  std::optional<DdsPeer> peer(std::uint64_t id) const {
    std::lock_guard lock(mutex_);
    const auto found = peers_.find(id);
    return found == peers_.end() ? std::nullopt : std::optional(found->second);
  }
  std::int64_t not_authenticated() const {
    std::lock_guard lock(mutex_);
    return not_authenticated_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, DdsPeer> peers_;
  std::int64_t not_authenticated_ = 0;
};

DdsParticipant::DdsParticipant(DomainParticipant* participant, std::unique_ptr<Neighbours> neighbours, int id)
    : participant_(participant), neighbours_(std::move(neighbours)), id_(id) {}

std::optional<DdsPeer> DdsParticipant::peer(std::uint64_t id) const { return neighbours_->peer(id); }
std::int64_t DdsParticipant::not_authenticated() const { return neighbours_->not_authenticated(); }

std::uint64_t DdsPeerId(const SampleInfo& sample) {
  return PeerId(sample.sample_identity.writer_guid().guidPrefix);
}

Result<std::unique_ptr<DdsParticipant>> DdsParticipant::Create(const DdsNetwork& network,
                                                               const std::string& name) {
  TRY(CheckAddresses(network));
  TRY(CheckDiscoveryPort(network));
  DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
  qos.name(name.c_str());
  std::string without_shared_memory;
  TRY(AddTransports(network, qos, without_shared_memory));
  TRY(AddSecurity(network, qos));
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration = Seconds(1);
  discovery.leaseDuration_announcementperiod = Seconds(0.25);
  for (const std::string& peer : network.peers) {
    Locator_t locator;
    IPLocator::setIPv4(locator, peer);
    qos.wire_protocol().builtin.initialPeersList.push_back(locator);
  }
  // Short cuts within a process leave a late volatile reader deaf until the writer's history has turned over;
  // and what is tested in one process shall use the transport that was asked for.
  eprosima::fastrtps::LibrarySettingsAttributes library;
  library.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(library);
  const int id = Ids().Take();
  qos.wire_protocol().participant_id = id;
  auto neighbours = std::make_unique<Neighbours>();
  DomainParticipant* participant = DomainParticipantFactory::get_instance()->create_participant(
      static_cast<DomainId_t>(network.domain), qos, neighbours.get(), StatusMask::none());
  if (participant == nullptr) {
    Ids().Release(id);
    if (!network.security.empty())
      return BadInput(
          "[{}] security: DDS takes no part with the certificates in {}; is a file expired, damaged "
          "or of another authority? `openssl verify -CAfile ca.pem certificate.pem` tells",
          network.section, network.security);
    return InternalError("DDS gives no participant in domain {}; are its network ports taken or forbidden?",
                         network.domain);
  }
  std::unique_ptr<DdsParticipant> made(new DdsParticipant(participant, std::move(neighbours), id));
  made->without_shared_memory_ = std::move(without_shared_memory);
  return made;
}

DdsParticipant::~DdsParticipant() {
  participant_->delete_contained_entities();
  DomainParticipantFactory::get_instance()->delete_participant(participant_);
  Ids().Release(id_);
}

Result<Topic*> DdsParticipant::MakeTopic(const std::string& name, const TypeSupport& type) {
  if (type.register_type(participant_) != ReturnCode_t::RETCODE_OK)
    return InternalError("DDS does not take the type {}", type.get_type_name());
  Topic* topic = participant_->create_topic(name, type.get_type_name(), TOPIC_QOS_DEFAULT);
  if (topic == nullptr) return BadInput("DDS does not take \"{}\" as the name of a topic", name);
  return topic;
}

DataWriterQos SampleWriterQos() {
  DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
  SetCommon(qos, kBatchesKept);
  SetHeartbeat(qos);
  qos.deadline().period = Seconds(kOfferedDeadline);
  return qos;
}

DataReaderQos SampleReaderQos(double deadline, bool backlog) {
  DataReaderQos qos = DATAREADER_QOS_DEFAULT;
  SetCommon(qos, kBatchesKept);
  qos.deadline().period = Seconds(std::max(deadline, kOfferedDeadline));
  if (!backlog) qos.durability().kind = VOLATILE_DURABILITY_QOS;
  return qos;
}

DataWriterQos LayoutWriterQos() {
  DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
  SetCommon(qos, 1);
  SetHeartbeat(qos);
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 1;
  return qos;
}

DataReaderQos LayoutReaderQos() {
  DataReaderQos qos = DATAREADER_QOS_DEFAULT;
  SetCommon(qos, 64);
  return qos;
}

DataWriterQos AlarmEventWriterQos() {
  DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
  SetCommon(qos, kAlarmEventsKept);
  SetHeartbeat(qos);
  return qos;
}

DataReaderQos AlarmEventReaderQos() {
  DataReaderQos qos = DATAREADER_QOS_DEFAULT;
  SetCommon(qos, kAlarmEventsKept);
  return qos;
}

DataWriterQos FindingWriterQos() {
  DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
  SetCommon(qos, kMostFindings);
  SetHeartbeat(qos);
  KeepLatestOfEach(qos);
  return qos;
}

DataReaderQos FindingReaderQos() {
  DataReaderQos qos = DATAREADER_QOS_DEFAULT;
  SetCommon(qos, kMostFindings);
  KeepLatestOfEach(qos);
  return qos;
}

int DiscoveryPort(int domain) { return 7400 + 250 * domain; }

std::string LayoutTopic(const std::string& samples) { return samples + "/layout"; }

}  // namespace hydroscope
