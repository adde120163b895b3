#include "storage/valve_check_words.h"

#include <gmock/gmock.h>

namespace hydroscope {
namespace {

TEST(ValveCheckWords, WhatIsStoredIsToldInGerman) {
  using namespace valve_check;
  EXPECT_EQ(ToldOf(std::string(kBusy.english)).german, kBusy.german);
  EXPECT_EQ(ToldOf(std::string(kNoAnswer.english) + ": Connection refused").german,
            std::string(kNoAnswer.german) + ": Connection refused");
  for (const double harmonics : {0.0, 0.031}) {
    const Told measured = Measured(16, 16.4, harmonics);
    EXPECT_EQ(ToldOf(measured.english), measured);
  }
  EXPECT_EQ(ToldOf("written by another program"), Told("written by another program"));
}

}  // namespace
}  // namespace hydroscope
