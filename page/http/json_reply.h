#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/result.h"
#include "page/http/http_message.h"
#include "page/http/request_guard.h"

namespace hydroscope {

/// An answer of the API; gets `schema` if it has none.
HttpReply JsonReply(nlohmann::json json, unsigned status = 200);
/// 500 where the fault is ours, else 400.
HttpReply FailureReply(const Error& error);

}  // namespace hydroscope
