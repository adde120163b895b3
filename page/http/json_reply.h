#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/told_error.h"
#include "page/http/http_message.h"

namespace hydroscope {

/// An answer of the API; gets `schema` if it has none.
HttpReply JsonReply(nlohmann::json json, unsigned status = 200);

/// {"error", "german": {"error"}}; `german` is null where it is told in English alone.
nlohmann::json ErrorJson(const Told& error);
/// Every refusal and failure of the API has this form.
HttpReply ErrorReply(unsigned status, const Told& error);
inline HttpReply ErrorReply(unsigned status, std::string error) {
  return ErrorReply(status, Told(std::move(error)));
}
/// 500 where the fault is ours, else 400.
HttpReply FailureReply(const Error& error);

}  // namespace hydroscope
