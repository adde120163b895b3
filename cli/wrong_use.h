#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace hydroscope {

/// What is wrong with the words of a command line that `app` refused with `error`: an unknown command or option and the one
/// that comes nearest, a value and what was expected in its place, what is missing; and which help tells more.
std::string WrongUse(const CLI::App& app, int argc, const char* const* argv, const CLI::ParseError& error);

}  // namespace hydroscope
