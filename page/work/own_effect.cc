#include "page/work/own_effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/told_error.h"
#include "models/machine_kind.h"
#include "page/api_arguments.h"
#include "page/http/json_arguments.h"

namespace hydroscope {
namespace {

bool IsName(const std::string& text) {
  const auto fine = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  return !text.empty() && text.front() >= 'a' && text.front() <= 'z' &&
         std::all_of(text.begin(), text.end(), fine);
}

/// Messages of the machine file's parser, each on lines of its own, without their places in the file, which nobody sees here.
std::string WithoutEffectsPlace(std::string messages) {
  const std::string key = fmt::format("{}: ", kOwnEffectSize);
  for (std::size_t at = 0; (at = messages.find("[effect", at)) != messages.npos;) {
    const std::size_t after = messages.find(key, at), line = messages.rfind('\n', at);
    if (after == messages.npos) break;
    at = line == messages.npos ? 0 : line + 1;
    messages.erase(at, after + key.size() - at);
  }
  return messages;
}
Error WithoutEffectsPlace(const Error& error) {
  return {error.kind, WithoutEffectsPlace(error.text), WithoutEffectsPlace(error.german)};
}

}  // namespace

Status CheckOwnEffectId(const std::string& id) {
  if (IsName(id)) return {};
  return BadInput(
      Tell("id: found '{}', expected small letters, digits and _, a letter first",
           "Name: gefunden '{}', erwartet: kleine Buchstaben, Ziffern und _, zuerst ein Buchstabe", id));
}

Result<OwnEffect> ParseOwnEffect(const std::string& body) {
  OwnEffect effect;
  for (const auto& [key, text] : {std::pair("id", &effect.id),
                                  {"expression", &effect.expression},
                                  {"unit", &effect.unit},
                                  {"output", &effect.output}}) {
    *text = TRY(ParseText(body, key));
  }
  const nlohmann::json json = nlohmann::json::parse(body, nullptr, false);
  for (const auto& [key, flag] : {std::pair("not_negative", &effect.not_negative), {"keep", &effect.keep}}) {
    if (!json.contains(key)) continue;
    if (!json[key].is_boolean()) return BadInput("{}: expected true or false", key);
    *flag = json[key].get<bool>();
  }
  TRY(CheckOwnEffectId(effect.id));
  if (!IsPlain(effect.expression) || effect.expression.find_first_not_of(' ') == std::string::npos)
    return BadInput(Tell("expression: expected up to {} characters without quotes, such as p*sign(ddt(x))",
                         "Ausdruck: erwartet: bis zu {} Zeichen ohne Anführungszeichen, etwa p*sign(ddt(x))",
                         kLongestExpression));
  if (!IsPlain(effect.unit))
    return BadInput(Told("unit: expected an SI unit, such as m3/(s Pa)",
                         "Einheit: erwartet eine SI-Einheit wie m3/(s Pa)"));
  return effect;
}

Result<std::string> WithOwnEffect(const std::string& machine_text, const OwnEffect& effect) {
  std::string text = machine_text;
  if (!text.ends_with('\n')) text += '\n';
  text += fmt::format("\n[[effect]]\nid = \"{}\"\ndescription = \"{}\"\nterms = {{ {} = \"{}\" }}\n",
                      effect.id, effect.id, kOwnEffectSize, effect.expression);
  if (!effect.unit.empty()) text += fmt::format("unit = \"{}\"\n", effect.unit);
  if (effect.not_negative) text += "min = 0\n";
  const auto machine = ParseMachine(text, "machine file");
  if (!machine) return tl::unexpected(WithoutEffectsPlace(machine.error()));
  const MachineKind& kind = KindOf(*machine);
  if (kind.build == nullptr)
    return BadInput(Told("this kind of machine takes effects in its machine file only",
                         "diese Art Maschine nimmt Effekte nur in ihrer Maschinendatei"));
  if (const auto built = kind.build(*machine); !built)
    return tl::unexpected(WithoutEffectsPlace(built.error()));
  return text;
}

}  // namespace hydroscope
