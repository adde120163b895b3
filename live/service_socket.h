#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

/// The socket of the service that writes `database`; only its owner may open it.
std::string SocketOf(const std::string& database);

/// Asks the service on that socket. Errors: nobody answers there, or the answer is no success (its text).
Result<std::string> AskService(const std::string& socket, const std::string& method, const std::string& path);

}  // namespace hydroscope
