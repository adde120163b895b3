// What the page says of effects to a plant stands in the effect's file, in German beside the English.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <tuple>
#include <vector>

#include "models/effect.h"
#include "models/machine.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

TEST(German, EveryEffectTellsThePlantInGermanWhatItTellsInEnglish) {
  std::vector<std::string> missing;
  int effects = 0;
  for (const MachineKind* kind : MachineKinds()) {
    if (kind->effects == nullptr) continue;
    for (const auto& effect : kind->effects(Machine{})) {
      ++effects;
      const Effect::German& german = effect->german;
      for (const auto& [key, english, told] :
           {std::tuple("title", effect->title, german.title),
            {"plain", effect->plain, german.plain},
            {"told_apart_by", effect->told_apart_by, german.told_apart_by}})
        if (english.empty() != told.empty())
          missing.push_back(fmt::format("{}/{}.{}", kind->id, effect->id, key));
    }
  }
  EXPECT_GT(effects, 50);
  EXPECT_EQ(missing, std::vector<std::string>());
}

}  // namespace
}  // namespace hydroscope
