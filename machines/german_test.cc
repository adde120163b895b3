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
            {"told_apart_by", effect->told_apart_by, german.told_apart_by},
            {"shown_by", effect->shown_by.english, effect->shown_by.german},
            {"measured_by", effect->measured_by.english, effect->measured_by.german},
            {"family", effect->family.english, effect->family.german},
            {"drifting", effect->drifting.english, effect->drifting.german}})
        if (english.empty() != told.empty())
          missing.push_back(fmt::format("{}/{}.{}", kind->id, effect->id, key));
    }
  }
  EXPECT_GT(effects, 50);
  EXPECT_EQ(missing, std::vector<std::string>());
}

TEST(German, EverySignalKnownValueAndParameterIsCalledSomethingInGerman) {
  std::vector<std::string> missing;
  for (const MachineKind* kind : MachineKinds()) {
    const auto ask = [&](std::string_view name, const Wording& wording) {
      if (wording.english.empty() != wording.german.empty())
        missing.push_back(fmt::format("{}/{}", kind->id, name));
    };
    ask("title", kind->title);
    for (const MachineInput& input : kind->signals) ask(input.name, input.meaning);
    for (const MachineInput& input : kind->geometry) ask(input.name, input.meaning);
    for (const MachineParameter& parameter : kind->parameters) {
      ask(parameter.name, parameter.meaning);
      ask(parameter.name, parameter.sentence);
    }
    for (const Condition& condition : kind->conditions)
      for (const Told& told : {condition.title, condition.vary, condition.hides})
        if (told.english.empty() != told.german.empty()) missing.push_back(told.english);
  }
  EXPECT_EQ(missing, std::vector<std::string>());
}

}  // namespace
}  // namespace hydroscope
