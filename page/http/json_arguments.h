#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/result.h"

namespace hydroscope {

inline constexpr std::size_t kLongestText = 400;        ///< characters of a text in a request
inline constexpr std::size_t kLongestComment = 2000;    ///< and of what a person says
inline constexpr std::size_t kLongestExpression = 300;  ///< and of what is computed

/// The object a body is. Error: it is none.
Result<nlohmann::json> ParseObject(const std::string& body);
/// Text under `key`; "" if the key is absent. Errors: no text, or longer than `longest`.
Result<std::string> TextOf(const nlohmann::json& object, const char* key, std::size_t longest = kLongestText);
/// `value` as a number; `key` stands in messages. Errors: no number, or no finite one.
Result<double> FiniteNumber(const nlohmann::json& value, const std::string& key);
/// Number under `key`; nothing if absent or null. Errors as of FiniteNumber.
Result<std::optional<double>> NumberOf(const nlohmann::json& object, const char* key);

/// Short enough for an expression, and nothing in it that would end a text between quotes in a machine file.
bool IsPlain(const std::string& text);
/// Whether `key` is true; false if absent. Error: neither true nor false.
Result<bool> FlagOf(const nlohmann::json& object, const char* key);

}  // namespace hydroscope
