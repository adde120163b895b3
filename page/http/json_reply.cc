#include "page/http/json_reply.h"

#include <nlohmann/json.hpp>

#include "core/json_text.h"
#include "core/told_error.h"
#include "host/output.h"

namespace hydroscope {

HttpReply JsonReply(nlohmann::json json, unsigned status) {
  if (!json.contains("schema")) json["schema"] = kJsonSchema;
  return {status, "application/json", JsonText(json)};
}

nlohmann::json ErrorJson(const Told& error) {
  nlohmann::json german;
  if (!error.german.empty()) german = {{"error", error.german}};
  return {{"error", error.english}, {"german", std::move(german)}};
}

HttpReply ErrorReply(unsigned status, const Told& error) { return JsonReply(ErrorJson(error), status); }

HttpReply FailureReply(const Error& error) {
  return ErrorReply(error.kind == ErrorKind::kInternal ? 500 : 400, ToldOf(error));
}

}  // namespace hydroscope
