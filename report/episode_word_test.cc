#include "report/episode_word.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(EpisodeWord, IsThatOfTheMachineInTheTextAndNotInTags) {
  EXPECT_EQ(WithEpisodesCalled("episode", "<p>Strokes left out: 3 strokes, stroke 12.</p>"),
            "<p>Episodes left out: 3 episodes, episode 12.</p>");
  EXPECT_EQ(WithEpisodesCalled("episode", "<path stroke=\"red\" class=\"stroke\"/><text>stroke</text>"),
            "<path stroke=\"red\" class=\"stroke\"/><text>episode</text>");
  EXPECT_EQ(
      WithEpisodesCalled("episode", "<svg stroke=\"1\" aria-label=\"over strokes\" class=\"stroke\"/>stroke"),
      "<svg stroke=\"1\" aria-label=\"over episodes\" class=\"stroke\"/>episode");
  EXPECT_EQ(WithEpisodesCalled("episode", "max_stroke, keystroke, stroked"),
            "max_stroke, keystroke, stroked");
  EXPECT_EQ(WithEpisodesCalled("stroke", "A stroke."), "A stroke.");
  EXPECT_EQ(WithEpisodesCalled("episode", "a stroke, A stroke, extra stroke"),
            "an episode, An episode, extra episode");
}

}  // namespace
}  // namespace hydroscope
