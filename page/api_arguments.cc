#include "page/api_arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/result.h"
#include "core/told_error.h"
#include "estimation/frequency_response/frequency_response.h"
#include "models/machine_kind.h"
#include "page/http/json_arguments.h"
#include "page/work/own_effect.h"

namespace hydroscope {
namespace {

/// Puts the number under `key`, if there is one, into `value`. Error: it lies outside.
Status Take(const nlohmann::json& object, const char* key, double low, double high, double& value) {
  const auto number = TRY(NumberOf(object, key));
  if (!number) return {};
  if (*number < low || *number > high)
    return BadInput(Tell("{}: found {:g}, expected {:g} to {:g}", "{}: gefunden {:g}, erwartet {:g} bis {:g}",
                         key, *number, low, high));
  value = *number;
  return {};
}

/// Of {"method": "auto" | "sine" | "welch", "segment", "min_coherence", "from", "to", "settle"}, as the options of `frf`; all may be
/// absent. Errors name the key, what it holds, and what was expected.
Result<FrequencyResponseOptions> ParseResponseOptions(const nlohmann::json& object) {
  constexpr double kMost = 1e5, kLongestSegment = 1 << 24;
  FrequencyResponseOptions options;
  const auto method = TRY(TextOf(object, "method"));
  if (method == "sine")
    options.method = FrequencyResponseMethod::kSine;
  else if (method == "welch")
    options.method = FrequencyResponseMethod::kWelch;
  else if (!method.empty() && method != "auto")
    return BadInput("method: found '{}', expected one of auto, sine, welch", method);
  double segment = 0;
  for (const Status& taken :
       {Take(object, "segment", 0, kLongestSegment, segment),
        Take(object, "min_coherence", 0, 1, options.min_coherence),
        Take(object, "from", 0, kMost, options.lowest), Take(object, "to", 1e-4, kMost, options.highest),
        Take(object, "settle", 0, kMost, options.settle_time)})
    if (!taken) return tl::unexpected(taken.error());
  options.segment_length = static_cast<std::size_t>(std::llround(segment));
  return options;
}

using Kind = WorkRequest::Kind;

constexpr std::pair<Kind, const char*> kWorkNames[] = {
    {Kind::kCheck, "check"},     {Kind::kFit, "fit"}, {Kind::kCompare, "compare"},
    {Kind::kExplain, "explain"}, {Kind::kFrf, "frf"}, {Kind::kPicture, "picture"},
    {Kind::kPreview, "preview"}, {Kind::kAdd, "add"}, {Kind::kRemove, "remove"},
    {Kind::kRestore, "restore"}};

constexpr std::size_t kMostColumns = 2000;  ///< of a log
constexpr std::size_t kLongestFileName = 120;

/// The array under `key`, empty if absent.
Result<nlohmann::json> Array(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) return nlohmann::json::array();
  if (!found->is_array()) return BadInput("{}: found {}, expected a list", key, found->type_name());
  if (found->size() > kMostColumns) return BadInput("{}: more than {} entries", key, kMostColumns);
  for (const nlohmann::json& entry : *found)
    if (!entry.is_object()) return BadInput("{}: found {}, expected objects", key, entry.type_name());
  return *found;
}

Result<ColumnMapping::Entry> ParseEntry(const nlohmann::json& json) {
  auto column = TextOf(json, "column"), signal = TextOf(json, "signal"), unit = TextOf(json, "unit");
  for (const auto* text : {&column, &signal, &unit})
    if (!*text) return tl::unexpected(text->error());
  return ColumnMapping::Entry{*column, *signal, *unit};
}

Result<GateBound> ParseBound(const nlohmann::json& json) {
  const auto signal = TRY(TextOf(json, "signal"));
  const auto rate = FlagOf(json, "rate"), magnitude = FlagOf(json, "magnitude");
  for (const auto* flag : {&rate, &magnitude})
    if (!*flag) return tl::unexpected(flag->error());
  const auto min = NumberOf(json, "min"), max = NumberOf(json, "max");
  for (const auto* number : {&min, &max})
    if (!*number) return tl::unexpected(number->error());
  return GateBound{signal, *rate, *min, *max, *magnitude};
}

Status ParseGeometry(const nlohmann::json& object, std::map<std::string, double>& geometry) {
  const auto found = object.find("geometry");
  if (found == object.end()) return {};
  if (!found->is_object()) return BadInput("geometry: found {}, expected an object", found->type_name());
  for (const auto& [name, value] : found->items()) {
    geometry[name] = TRY(FiniteNumber(value, "geometry." + name));
  }
  return {};
}

constexpr std::size_t kLongestParameterName = 40;  ///< characters

bool IsParameterName(const std::string& text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !text.empty() && text.size() <= kLongestParameterName && letter(text.front()) &&
         std::all_of(text.begin(), text.end(),
                     [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

Result<std::string> ExpressionOf(const nlohmann::json& object, const char* key) {
  auto text = TextOf(object, key);
  if (text && !IsPlain(*text))
    return BadInput(Tell("{}: expected up to {} characters without quotes, such as p*sign(ddt(x))",
                         "{}: erwartet bis zu {} Zeichen ohne Anführungszeichen, zum Beispiel p*sign(ddt(x))",
                         key, kLongestExpression));
  return text;
}

Result<BalanceSpec> ParseBalance(const nlohmann::json& json) {
  if (!json.is_object()) return BadInput("balance: found {}, expected an object", json.type_name());
  auto output = TRY(ExpressionOf(json, "output"));
  const auto terms = TRY(Array(json, "terms"));
  BalanceSpec balance;
  balance.output = std::move(output);
  for (const nlohmann::json& term : terms) {
    auto name = TextOf(term, "name"), expression = ExpressionOf(term, "expression");
    if (!name) return tl::unexpected(name.error());
    if (!expression) return tl::unexpected(expression.error());
    const bool known = std::any_of(balance.terms.begin(), balance.terms.end(),
                                   [&](const TermSpec& before) { return before.parameter == *name; });
    if (!IsParameterName(*name) || known)
      return BadInput(Tell(
          "name: found '{}', expected letters, digits and _, a letter first, once",
          "Name: gefunden '{}', erwartet Buchstaben, Ziffern und _, vorn ein Buchstabe, nur einmal", *name));
    balance.terms.push_back({std::move(*name), std::move(*expression)});
  }
  return balance;
}

Result<std::vector<UserEffectSpec>> ParseEffects(const nlohmann::json& object) {
  const auto written = TRY(Array(object, "effects"));
  std::vector<UserEffectSpec> effects;
  for (const nlohmann::json& json : written) {
    UserEffectSpec effect;
    effect.id = TRY(TextOf(json, "id"));
    TRY(CheckOwnEffectId(effect.id));
    const auto expression = TRY(ExpressionOf(json, "expression"));
    if (TRY(FlagOf(json, "not_negative"))) effect.min = 0;
    effect.terms = {{kOwnEffectSize, expression}};
    effects.push_back(std::move(effect));
  }
  return effects;
}

}  // namespace

const char* WorkName(Kind kind) {
  for (const auto& [known, name] : kWorkNames)
    if (known == kind) return name;
  return "";
}

Result<WorkRequest> ParseWorkRequest(const std::string& body) {
  const auto json = TRY(ParseObject(body));
  const auto kind = TextOf(json, "kind"), effect = TextOf(json, "effect"), log = TextOf(json, "log");
  for (const auto* text : {&kind, &effect, &log})
    if (!*text) return tl::unexpected(text->error());
  const auto named = std::find_if(std::begin(kWorkNames), std::end(kWorkNames),
                                  [&](const auto& k) { return *kind == k.second; });
  if (named == std::end(kWorkNames)) {
    std::vector<std::string> known;
    for (const auto& [value, name] : kWorkNames) known.emplace_back(name);
    return BadInput("kind: found '{}', expected one of {}", *kind, fmt::join(known, ", "));
  }
  WorkRequest request{named->first, *effect, 0, *log};
  if (request.kind == Kind::kFrf) {
    request.response = TRY(ParseResponseOptions(json));
  }
  const bool about_effect =
      request.kind == Kind::kPreview || request.kind == Kind::kAdd || request.kind == Kind::kRemove;
  if (about_effect && effect->empty()) return BadInput("effect: expected the id of an effect");
  const auto version = TRY(NumberOf(json, "version"));
  if (request.kind == Kind::kRestore) {
    const double number = version.value_or(0);
    if (number < 1 || number > 1e8 || number != std::floor(number))
      return BadInput("version: expected a number of a version, 1 or more");
    request.version = static_cast<int>(number);
  }
  return request;
}

Result<ColumnMapping> ParseColumnMapping(const std::string& body) {
  const auto json = ParseObject(body);
  if (!json) return tl::unexpected(json.error());
  ColumnMapping mapping;
  auto model = TRY(TextOf(*json, "model"));
  if (!model.empty() && FindKind(model) == nullptr)
    return BadInput("model: found '{}', expected one of {}", model, fmt::join(KindNames(), ", "));
  mapping.model = std::move(model);
  if (json->contains("balance")) {
    mapping.balance = TRY(ParseBalance((*json)["balance"]));
  }
  if (json->contains("effects")) {
    mapping.effects = TRY(ParseEffects(*json));
  }
  const auto columns = TRY(Array(*json, "columns"));
  for (const nlohmann::json& column : columns) {
    auto entry = TRY(ParseEntry(column));
    mapping.columns.push_back(std::move(entry));
  }
  TRY(ParseGeometry(*json, mapping.geometry));
  if (!json->contains("gate")) return mapping;
  const auto gate = TRY(Array(*json, "gate"));
  mapping.gate.emplace();
  for (const nlohmann::json& bound : gate) {
    auto parsed = TRY(ParseBound(bound));
    mapping.gate->push_back(std::move(parsed));
  }
  return mapping;
}

Result<StrokeStretch> ParseStrokeStretch(const std::string& body) {
  const auto json = TRY(ParseObject(body));
  const auto machine = TRY(TextOf(json, "machine"));
  StrokeStretch stretch{machine, 0, 0};
  for (const auto& [key, stroke] : {std::pair{"first", &stretch.first}, {"last", &stretch.last}}) {
    const auto number = TRY(NumberOf(json, key));
    if (!number || *number < 0 || *number > 9e15 || *number != std::floor(*number))
      return BadInput("{}: expected the number of a stroke", key);
    *stroke = static_cast<std::int64_t>(*number);
  }
  if (stretch.last < stretch.first) return BadInput("last: expected no stroke before {}", stretch.first);
  return stretch;
}

Result<std::string> ParseText(const std::string& body, const std::string& key) {
  const auto json = TRY(ParseObject(body));
  return TextOf(json, key.c_str());
}

std::string PlainFileName(const std::string& name) {
  const std::size_t folder = name.find_last_of("/\\");
  const std::string file = folder == name.npos ? name : name.substr(folder + 1);
  const auto follows = [&](std::size_t at) {  // a further byte of a character
    return at < file.size() && (static_cast<unsigned char>(file[at]) & 0xC0) == 0x80;
  };
  std::vector<std::string> letters;
  for (std::size_t at = 0; at < file.size(); ++at) {
    const char c = file[at];
    const auto byte = static_cast<unsigned char>(c);
    const bool fine = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '-' || c == '_' || c == '.';
    const bool latin = byte >= 0xC3 && byte <= 0xC9 && follows(at + 1) && !follows(at + 2);  // à, Ö, ß, ...
    if (fine || latin)
      letters.push_back(file.substr(at, latin ? 2 : 1));
    else if (letters.empty() || letters.back() != "_")
      letters.emplace_back("_");
    while (follows(at + 1)) ++at;
  }
  std::string plain;
  for (auto letter = letters.rbegin();  // the ending tells
       letter != letters.rend() && plain.size() + letter->size() <= kLongestFileName; ++letter)
    plain.insert(0, *letter);
  plain.erase(0, std::min(plain.find_first_not_of('.'), plain.size()));
  return plain;
}

}  // namespace hydroscope
