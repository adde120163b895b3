#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/told.h"

namespace hydroscope {

/// How texts call what a machine repeats and is judged by.
struct CountedWords {
  std::string_view one = "stroke", many = "strokes", capital = "Stroke", with_article = "a stroke";
  /// German, which before numbers stands in the singular: "von Hub 3 bis 8".
  std::string_view german = "Hub";
  std::string_view german_several = "Hübe", german_dative = "Hüben";

  std::string_view Of(std::int64_t count) const { return count == 1 ? one : many; }
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
