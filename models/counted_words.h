#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/told.h"
#include "models/machine_kind.h"

namespace hydroscope {

/// How texts call what a machine repeats and is judged by.
struct CountedWords {
  std::string_view one = "stroke", many = "strokes", capital = "Stroke", with_article = "a stroke";
  /// German, which before numbers stands in the singular: "von Hub 3 bis 8".
  std::string_view german = "Hub";

  std::string_view Of(std::int64_t count) const { return count == 1 ? one : many; }
  /// Before a number, and before numbers.
  Told One() const { return {std::string(one), std::string(german)}; }
  Told Many() const { return {std::string(many), std::string(german)}; }
};

inline CountedWords CountedWordsOf(const MachineKind& kind) {
  return InEpisodes(kind) ? CountedWords{"episode", "episodes", "Episode", "an episode", "Episode"}
                          : CountedWords{};
}
inline CountedWords CountedWordsOf(const Machine& machine) { return CountedWordsOf(KindOf(machine)); }

}  // namespace hydroscope
