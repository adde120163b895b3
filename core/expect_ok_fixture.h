#pragma once

#include <gtest/gtest.h>

/// A Result or Status must hold a value; if not, its error's text is printed.
#define HYDROSCOPE_CHECK_OK(check, expression)                                   \
  do {                                                                           \
    const auto& outcome = (expression);                                          \
    check(outcome.has_value()) << (outcome ? "" : outcome.error().text.c_str()); \
  } while (false)

#define EXPECT_OK(expression) HYDROSCOPE_CHECK_OK(EXPECT_TRUE, expression)
#define ASSERT_OK(expression) HYDROSCOPE_CHECK_OK(ASSERT_TRUE, expression)
