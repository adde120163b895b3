#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/short_number.h"

namespace hydroscope {

/// What the program tells people, in the languages of its page. Tell() writes both from the same values where the sentence is
/// made: none is translated afterwards, and one without German does not compile.
struct Told {
  Told() = default;
  Told(std::string told_in_english, std::string told_in_german = "")
      : english(std::move(told_in_english)), german(std::move(told_in_german)) {}

  std::string english;  ///< what command line, journal and feeds say
  std::string german;   ///< "": told in English alone (the text of an error, words of users' own)

  bool empty() const { return english.empty(); }
  /// In German as far as it is told so.
  const std::string& InGerman() const { return german.empty() ? english : german; }
  bool operator==(const Told&) const = default;
};

/// What a table of the program calls something, in the same languages.
struct Wording {
  constexpr Wording(const char* in_english = "", const char* in_german = "")
      : english(in_english), german(in_german) {}

  std::string_view english, german;

  constexpr operator std::string_view() const { return english; }
  operator Told() const { return {std::string(english), std::string(german)}; }
};

namespace told {

/// A number in a sentence, and the mark before its decimals.
struct Number {
  double value = 0;
  char point = '.';
};

inline const std::string& English(const Told& part) { return part.english; }
inline const std::string& German(const Told& part) { return part.InGerman(); }
inline std::string_view German(const Wording& part) {
  return part.german.empty() ? part.english : part.german;
}
template <class T>
const T& English(const T& value) {
  return value;
}
template <class T>
const T& German(const T& value) {
  return value;
}
inline Number English(const double& value) { return {value}; }
inline Number German(const double& value) { return {value, ','}; }
template <class It, class End>
std::string English(const fmt::join_view<It, End>& list) {
  return fmt::format("{}", fmt::join_view(list));
}
template <class It, class End>
std::string German(const fmt::join_view<It, End>& list) {
  return English(list);
}

template <class T>
using EnglishOf = decltype(English(std::declval<const T&>()));
template <class T>
using GermanOf = decltype(German(std::declval<const T&>()));

}  // namespace told

/// A sentence with its values: numbers, names, and parts that are told themselves. `german` may name them in another order.
template <class... V>
Told Tell(fmt::format_string<told::EnglishOf<V>...> english, fmt::format_string<told::GermanOf<V>...> german,
          const V&... values);

/// A number that is written already, "1.210 ± 0.012 GPa".
Told TellNumber(std::string number);

/// In English, and in German with "" for what is told in English alone.
std::vector<std::string> InEnglish(const std::vector<Told>& sentences);
std::vector<std::string> InGerman(const std::vector<Told>& sentences);

/// The parts, "a, b, c"; "" without any.
Told Joined(const std::vector<Told>& parts, std::string_view between = ", ");

}  // namespace hydroscope

template <>
struct fmt::formatter<hydroscope::told::Number> : fmt::formatter<double> {
  auto format(const hydroscope::told::Number& number, fmt::format_context& context) const {
    fmt::memory_buffer written;
    fmt::format_context inner(fmt::appender(written), {}, context.locale());
    fmt::formatter<double>::format(number.value, inner);
    std::string read = hydroscope::AsPeopleRead(fmt::to_string(written), number.value);
    std::replace(read.begin(), read.end(), '.', number.point);
    return std::copy(read.begin(), read.end(), context.out());
  }
};

/// As it is called in English.
template <>
struct fmt::formatter<hydroscope::Wording> : fmt::formatter<std::string_view> {
  auto format(const hydroscope::Wording& wording, fmt::format_context& context) const {
    return fmt::formatter<std::string_view>::format(wording.english, context);
  }
};

namespace hydroscope {

template <class... V>
Told Tell(fmt::format_string<told::EnglishOf<V>...> english, fmt::format_string<told::GermanOf<V>...> german,
          const V&... values) {
  const auto written = [](fmt::string_view form, const auto&... shown) {
    return fmt::vformat(form, fmt::make_format_args(shown...));
  };
  return {written(english, told::English(values)...), written(german, told::German(values)...)};
}

}  // namespace hydroscope
