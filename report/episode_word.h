#pragma once

#include <string>
#include <string_view>

namespace hydroscope {

/// A page that speaks of strokes, for a machine whose episodes are none: every "stroke" and "strokes" of its text becomes `word`
/// ("episode", CountedAs), begun as the one it replaces. Tags and their attributes stay as they are.
std::string WithEpisodesCalled(std::string_view word, std::string_view html);

}  // namespace hydroscope
