#include "studies/alarms/campaign_broker.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>

namespace hydroscope {
namespace {

constexpr double kBrokerPatience = 10;  // s

std::string FindMosquitto() {
  for (const char* path : {"/usr/sbin/mosquitto", "/usr/bin/mosquitto", "/usr/local/sbin/mosquitto"})
    if (access(path, X_OK) == 0) return path;
  return "";
}

}  // namespace

CampaignBroker::~CampaignBroker() {
  host_.reset();
  mosquitto_.reset();
}

std::string CampaignBroker::address() const { return fmt::format("tcp://127.0.0.1:{}", port_); }

Result<std::unique_ptr<CampaignBroker>> CampaignBroker::Create(const std::string& folder,
                                                               const std::string& more) {
  const std::string program = FindMosquitto();
  if (program.empty())
    return BadInput("the campaign needs the MQTT broker mosquitto; scripts/setup.sh installs it");
  std::unique_ptr<CampaignBroker> broker(new CampaignBroker);
  broker->port_ = 10'000 + static_cast<int>(getpid()) % 10'000;  // below those of LiveRig
  const std::string file = folder + "/mosquitto.conf";
  std::ofstream(file) << "per_listener_settings true\nlistener " << broker->port_
                      << " 127.0.0.1\nallow_anonymous true\npersistence false\nmax_queued_messages 0\n"
                      << "max_inflight_messages 0\nlog_dest none\n"
                      << (getuid() == 0 ? "user root\n" : "") << more;
  broker->mosquitto_ =
      std::make_unique<Child>(std::vector<std::string>{"-c", file}, folder + "/mosquitto.log", -1, program);
  const double end = Now() + kBrokerPatience;
  for (;;) {
    auto host = MqttConnection::Open(
        {.broker = broker->address(),
         .client_id = "host",
         .user = "",
         .password = "",
         .will = {"host", "", 0}},
        {.acknowledged = [](std::int64_t) {},
         .arrived = [raw = broker.get()](const MqttMessage& message) { raw->Take(message); },
         .lost = [](const std::string&) {}});
    if (host && (*host)->Subscribe("spBv1.0/+/DDATA/#") && (*host)->Subscribe("spBv1.0/+/DBIRTH/#")) {
      broker->host_ = std::move(*host);
      return broker;
    }
    if (Now() > end)
      return InternalError("mosquitto on port {} does not answer; is the port taken?", broker->port_);
    Sleep(0.1);
  }
}

void CampaignBroker::Take(const MqttMessage& message) {
  const auto row = sparkplug::RowOf(message.payload);
  const std::string health = sparkplug::HealthOf(message.payload);
  std::lock_guard lock(mutex_);
  if (row) told_.push_back(*row);
  if (!health.empty()) health_[message.topic.substr(message.topic.rfind('/') + 1)] = health;
}

std::vector<sparkplug::ToldRow> CampaignBroker::told() const {
  std::lock_guard lock(mutex_);
  return told_;
}

std::string CampaignBroker::HealthOf(const std::string& device) const {
  std::lock_guard lock(mutex_);
  const auto found = health_.find(device);
  return found == health_.end() ? "" : found->second;
}

}  // namespace hydroscope
