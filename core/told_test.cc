#include "core/told.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(Told, BothLanguagesAreWrittenFromTheSameValues) {
  const Told told = Tell("K is {:.4g} ± {:.2g} {}, above {}", "K liegt bei {:.4g} ± {:.2g} {}, über {}",
                         12.25, 0.5, "bar", Tell("the limit", "der Grenze"));
  EXPECT_EQ(told.english, "K is 12.25 ± 0.5 bar, above the limit");
  EXPECT_EQ(told.german, "K liegt bei 12,25 ± 0,5 bar, über der Grenze");
}

TEST(Told, NumbersHaveNoExponentWherePeopleReadTheDigits) {
  const Told told = Tell("{:.2g} % of {:.3g} N, {:+.2g}, {:.3g} m3",
                         "{:.2g} % von {:.3g} N, {:+.2g}, {:.3g} m3", 632.0, 23456.0, 1234.0, 2.5e-5);
  EXPECT_EQ(told.english, "632 % of 23456 N, +1234, 2.5e-5 m3");
  EXPECT_EQ(told.german, "632 % von 23456 N, +1234, 2,5e-5 m3");
}

TEST(Told, GermanMayNameValuesInAnotherOrder) {
  const Told told = Tell("{} of {} strokes", "von {1} Hüben {0}", 19, 100);
  EXPECT_EQ(told.english, "19 of 100 strokes");
  EXPECT_EQ(told.german, "von 100 Hüben 19");
}

TEST(Told, WhatATableNamesStandsInTheLanguageOfItsSentence) {
  const Wording area{"piston area", "Kolbenfläche"}, plain{"p_A"};
  const Told told = Tell("no {} of {}", "keine {} von {}", area, plain);
  EXPECT_EQ(told.english, "no piston area of p_A");
  EXPECT_EQ(told.german, "keine Kolbenfläche von p_A");
}

TEST(Told, WhatIsToldInEnglishAloneStandsInGermanSentencesAsItIs) {
  EXPECT_EQ(Tell("refused: {}", "abgelehnt: {}", Told{"no such file", ""}).german, "abgelehnt: no such file");
}

TEST(Told, NumbersThatAreWrittenGetACommaAndPartsAreJoined) {
  EXPECT_EQ(TellNumber("1.21 ± 0.02 GPa").german, "1,21 ± 0,02 GPa");
  EXPECT_EQ(TellNumber("0.0176 l/min per bar").german, "0,0176 l/min je bar");
  EXPECT_EQ(TellNumber("0.803 ± 0.024 % of stroke").german, "0,803 ± 0,024 % des Wegs");
  const Told joined = Joined({Tell("one", "eins"), Tell("two", "zwei")});
  EXPECT_EQ(joined.english, "one, two");
  EXPECT_EQ(joined.german, "eins, zwei");
  EXPECT_TRUE(Joined({}).empty());
}

}  // namespace
}  // namespace hydroscope
