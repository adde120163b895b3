#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/told.h"

namespace hydroscope {

/// "1 log", "3 logs"; the noun is regular.
template <std::integral Count>
std::string Counted(Count count, std::string_view noun) {
  return std::to_string(count).append(" ").append(noun).append(count == 1 ? "" : "s");
}

/// How texts call what a machine repeats and is judged by.
struct CountedWords {
  std::string_view one = "stroke", many = "strokes", capital = "Stroke", with_article = "a stroke";
  /// German, which before numbers stands in the singular: "von Hub 3 bis 8".
  std::string_view german = "Hub";
  std::string_view german_several = "Hübe", german_dative = "Hüben";

  std::string_view Of(std::int64_t count) const { return count == 1 ? one : many; }
  /// "1 stroke", "3 strokes".
  template <std::integral Count>
  std::string Counted(Count count) const {
    return hydroscope::Counted(count, one);
  }
  /// "1 episode", "3 strokes", "3 Hübe".
  Told CountedTold(std::size_t count) const {
    return {Counted(count), fmt::format("{} {}", count, count == 1 ? german : german_several)};
  }
  /// Before a number, and before numbers.
  Told One() const { return {std::string(one), std::string(german)}; }
  Told Many() const { return {std::string(many), std::string(german)}; }
  /// Behind a number: "five strokes", "fünf Hübe", "von fünf Hüben".
  Told Several() const { return {std::string(many), std::string(german_several)}; }
  Told SeveralDative() const { return {std::string(many), std::string(german_dative)}; }
};

inline constexpr CountedWords kEpisodes = {"episode", "episodes", "Episode", "an episode",
                                           "Episode", "Episoden", "Episoden"};

}  // namespace hydroscope
