#include "cli/plain_numbers.h"

#include <charconv>
#include <cstdint>
#include <optional>

#include "core/finite_number.h"

namespace hydroscope {
namespace {

/// The number in the form that the parser reads as meant.
template <typename Integer>
std::optional<std::string> WholeNumber(const std::string& text) {
  Integer number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stop == end ? std::optional(std::to_string(number)) : std::nullopt;
}

/// What makes numbers of an option of this type plain; nullptr if it takes none.
std::optional<std::string> (*PlainFormOf(const std::string& type))(const std::string&) {
  if (type.starts_with("UINT")) return WholeNumber<std::uint64_t>;
  if (type.starts_with("INT")) return WholeNumber<std::int64_t>;
  if (type.starts_with("FLOAT"))
    return [](const std::string& text) { return FiniteNumber(text) ? std::optional(text) : std::nullopt; };
  return nullptr;
}

}  // namespace

void TakePlainNumbersOnly(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    TakePlainNumbersOnly(*command);
  for (CLI::Option* option : app.get_options()) {
    const auto plain_form = PlainFormOf(option->get_type_name());
    if (plain_form == nullptr) continue;
    option->transform(CLI::Validator(
        [plain_form](std::string& text) {
          const auto plain = plain_form(text);
          if (plain) text = *plain;
          return plain ? "" : "no number";
        },
        ""));
  }
}

}  // namespace hydroscope
