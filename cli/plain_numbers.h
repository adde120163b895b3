#pragma once

#include <CLI/CLI.hpp>

namespace hydroscope {

/// The value of every option of `app` and its commands that is a number has to be one, plain and finite, and nothing else. The
/// parser alone would take nothing for 0, 010 for 8, 0x10 for 16, -3 for 2^64 - 3, and nan and inf for what they are.
void TakePlainNumbersOnly(CLI::App& app);

}  // namespace hydroscope
