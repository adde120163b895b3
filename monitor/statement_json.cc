#include "monitor/statement_json.h"

#include <nlohmann/json.hpp>

namespace hydroscope {

nlohmann::json StatementJson(const EstimateStatement& statement) {
  return {{"parameter", statement.parameter}, {"shared", statement.shared},
          {"least_std", statement.least_std}, {"confounded", statement.confounded},
          {"why", statement.why.english},     {"german", {{"why", statement.why.german}}}};
}

EstimateStatement StatementOf(const nlohmann::json& json) {
  const auto german = json.find("german");
  return {.parameter = json.value("parameter", ""),
          .shared = json.value("shared", 0.0),
          .least_std = json.value("least_std", 0.0),
          .confounded = json.value("confounded", false),
          .why = {json.value("why", ""), german == json.end() ? "" : german->value("why", "")}};
}

}  // namespace hydroscope
