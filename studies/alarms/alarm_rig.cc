#include "studies/alarms/alarm_rig.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "dds/domains.h"

namespace hydroscope {
std::string AlarmAxis(int axis) { return fmt::format("press/cushion_{}", axis + 1); }

AlarmRig::AlarmRig()
    : folder_(
          (std::filesystem::temp_directory_path() / fmt::format("hydroscope-alarms-{}", getpid())).string()) {
  std::filesystem::remove_all(folder_);
  std::filesystem::create_directories(folder_);
}

AlarmRig::~AlarmRig() {
  broker_.reset();
  std::filesystem::remove_all(folder_);
}

Result<std::unique_ptr<AlarmRig>> AlarmRig::Create() {
  std::unique_ptr<AlarmRig> rig(new AlarmRig);
  rig->domain_ = FreeDomain();
  rig->dds_ = TRY(AlarmListener::Create(rig->domain_));
  rig->broker_ = TRY(CampaignBroker::Create(rig->folder_));
  return rig;
}

std::vector<std::string> AlarmRig::Load(const std::string& mode) const {
  return {"benchmark",        "alarm-load", "--db", database(), "--broker",
          broker_->address(), "--mode",     mode,   "--domain", std::to_string(domain_)};
}

}  // namespace hydroscope
