#pragma once

#include <fmt/format.h>

#include <string>

#include "host/output.h"
#include "live/service_socket.h"

namespace hydroscope {

/// What the service that fills the database could not store is not in what is read there: said on stderr, since "adequate" or
/// "no alarm" would be taken for an all-clear. "" if it stores, or none runs.
inline std::string SayIfOld(const std::string& database) {
  const std::string why = WhyNothingIsStored(database);
  if (!why.empty())
    SayBeside(fmt::format("THIS IS OLD: the service stores nothing now, alarms neither: {}\n", why));
  return why;
}

}  // namespace hydroscope
