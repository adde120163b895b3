#pragma once

#include <string_view>

#include "models/machine_kind.h"

namespace hydroscope {

/// How texts call what a machine repeats and is judged by.
struct CountedWords {
  std::string_view one = "stroke", many = "strokes", capital = "Stroke", with_article = "a stroke";
  std::string_view Of(std::int64_t count) const { return count == 1 ? one : many; }
};

inline CountedWords CountedWordsOf(const MachineKind& kind) {
  return kind.has_states ? CountedWords{"episode", "episodes", "Episode", "an episode"} : CountedWords{};
}
inline CountedWords CountedWordsOf(const Machine& machine) { return CountedWordsOf(KindOf(machine)); }

}  // namespace hydroscope
