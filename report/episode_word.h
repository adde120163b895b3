#pragma once

#include <string>
#include <string_view>

namespace hydroscope {

/// A page that speaks of strokes, for a machine whose episodes are none: every "stroke" and "strokes" of its text becomes `word`
/// ("episode", CountedAs), begun as the one it replaces. Tags stay as they are, but for
/// labels that are read aloud.
std::string WithEpisodesCalled(std::string_view word, std::string_view html);

}  // namespace hydroscope
