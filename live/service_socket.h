#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

/// The socket of the service that writes `database`; only its owner may open it.
std::string SocketOf(const std::string& database);

/// Asks the service on that socket. Errors: nobody answers there, or the answer is no success (its text).
Result<std::string> AskService(const std::string& socket, const std::string& method, const std::string& path);

/// Why the service that fills `database` can store nothing now, alarms neither, so that what is read there is no all-clear; "" if
/// it can, or none runs.
std::string WhyNothingIsStored(const std::string& database);

}  // namespace hydroscope
