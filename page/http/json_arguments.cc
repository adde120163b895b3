#include "page/http/json_arguments.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {

Result<nlohmann::json> ParseObject(const std::string& body) {
  nlohmann::json json = nlohmann::json::parse(body, nullptr, false);
  if (!json.is_object()) return BadInput("the body is no JSON object");
  return json;
}

Result<std::string> TextOf(const nlohmann::json& object, const char* key, std::size_t longest) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return std::string();
  if (!found->is_string()) return BadInput("{}: found {}, expected text", key, found->type_name());
  std::string text = found->get<std::string>();
  if (text.size() > longest) return BadInput("{}: longer than {} characters", key, longest);
  return text;
}

Result<double> FiniteNumber(const nlohmann::json& value, const std::string& key) {
  if (!value.is_number()) return BadInput("{}: found {}, expected a number", key, value.type_name());
  const double number = value.get<double>();
  if (!std::isfinite(number)) return BadInput("{}: the number is too large", key);
  return number;
}

Result<std::optional<double>> NumberOf(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return std::optional<double>();
  const auto number = TRY(FiniteNumber(*found, key));
  return std::optional<double>(number);
}

bool IsPlain(const std::string& text) {
  return text.size() <= kLongestExpression && std::all_of(text.begin(), text.end(), [](char c) {
           return c >= ' ' && c <= '~' && c != '"' && c != '\\';
         });
}

Result<bool> FlagOf(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) return false;
  if (!found->is_boolean()) return BadInput("{}: found {}, expected true or false", key, found->type_name());
  return found->get<bool>();
}

}  // namespace hydroscope
