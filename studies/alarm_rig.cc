#include "studies/alarm_rig.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
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

std::string AlarmAxis(int axis) { return fmt::format("press/cushion_{}", axis + 1); }

AlarmRig::AlarmRig()
    : folder_(
          (std::filesystem::temp_directory_path() / fmt::format("hydroscope-alarms-{}", getpid())).string()) {
  std::filesystem::remove_all(folder_);
  std::filesystem::create_directories(folder_);
}

AlarmRig::~AlarmRig() {
  host_.reset();
  mosquitto_.reset();
  std::filesystem::remove_all(folder_);
}

Result<std::unique_ptr<AlarmRig>> AlarmRig::Create() {
  const std::string program = FindMosquitto();
  if (program.empty())
    return BadInput("the campaign needs the MQTT broker mosquitto; scripts/setup.sh installs it");
  std::unique_ptr<AlarmRig> rig(new AlarmRig);
  rig->domain_ = 1 + static_cast<int>(getpid()) % 200;
  auto dds = AlarmListener::Create(rig->domain_);
  if (!dds) return tl::unexpected(dds.error());
  rig->dds_ = std::move(*dds);
  const int port = 20'000 + static_cast<int>(getpid()) % 20'000;
  rig->broker_ = fmt::format("tcp://127.0.0.1:{}", port);
  std::ofstream(rig->File("mosquitto.conf"))
      << "listener " << port << " 127.0.0.1\nallow_anonymous true\npersistence false\nmax_queued_messages 0\n"
      << "max_inflight_messages 0\nlog_dest none\n"
      << (getuid() == 0 ? "user root\n" : "");
  rig->mosquitto_ = std::make_unique<Child>(std::vector<std::string>{"-c", rig->File("mosquitto.conf")},
                                            rig->File("mosquitto.log"), -1, program);
  const auto take = [raw = rig.get()](const MqttMessage& message) {
    const auto row = sparkplug::RowOf(message.payload);
    if (!row) return;
    std::lock_guard lock(raw->mutex_);
    raw->told_.push_back(*row);
  };
  const double end = Now() + kBrokerPatience;
  for (;;) {
    auto host = MqttConnection::Open(
        {.broker = rig->broker_, .client_id = "host", .user = "", .password = "", .will = {"host", "", 0}},
        {.acknowledged = [](std::int64_t) {}, .arrived = take, .lost = [] {}});
    if (host && (*host)->Subscribe("spBv1.0/+/DDATA/#")) {
      rig->host_ = std::move(*host);
      return rig;
    }
    if (Now() > end) return InternalError("mosquitto on port {} does not answer; is the port taken?", port);
    Sleep(0.1);
  }
}

std::vector<std::string> AlarmRig::Load(const std::string& mode) const {
  return {"benchmark", "alarm-load", "--db", database(), "--broker",
          broker_,     "--mode",     mode,   "--domain", std::to_string(domain_)};
}

std::vector<sparkplug::ToldRow> AlarmRig::told() const {
  std::lock_guard lock(mutex_);
  return told_;
}

}  // namespace hydroscope
