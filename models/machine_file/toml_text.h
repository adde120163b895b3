#pragma once

#include <string>

namespace hydroscope {

/// A text as TOML reads it back, with its quotes.
std::string Quoted(const std::string& text);

/// A number that TOML reads back to the same double as a floating point number.
std::string FloatText(double value);

}  // namespace hydroscope
