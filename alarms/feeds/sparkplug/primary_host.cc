#include "alarms/feeds/sparkplug/primary_host.h"

#include <nlohmann/json.hpp>

namespace hydroscope::sparkplug {

std::optional<HostState> ParseHostState(const std::string& payload) {
  const auto message = nlohmann::json::parse(payload, nullptr, false);
  if (!message.is_object()) return std::nullopt;
  const auto online = message.find("online"), timestamp = message.find("timestamp");
  if (online == message.end() || !online->is_boolean() || timestamp == message.end() ||
      !timestamp->is_number_integer())
    return std::nullopt;
  return HostState{online->get<bool>(), timestamp->get<std::int64_t>()};
}

bool PrimaryHost::Take(const std::string& payload) {
  const auto state = ParseHostState(payload);
  if (!state || (newest_ && state->timestamp < newest_->timestamp)) return false;
  newest_ = state;
  return true;
}

}  // namespace hydroscope::sparkplug
