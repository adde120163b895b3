#pragma once

#include "core/counted_words.h"
#include "models/machine_kind.h"

namespace hydroscope {

inline CountedWords CountedWordsOf(const MachineKind& kind) {
  return InEpisodes(kind) ? kEpisodes : CountedWords{};
}
inline CountedWords CountedWordsOf(const Machine& machine) { return CountedWordsOf(KindOf(machine)); }

}  // namespace hydroscope
