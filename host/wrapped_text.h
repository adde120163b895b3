#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hydroscope {

/// The text with lines of more than `width` characters (UTF-8) broken at blanks; what continues a line stands four
/// blanks further in than it began. Commands to be copied, "hydroscope fit ..." and what stands between backquotes, stay whole.
std::string WrappedText(std::string_view text, std::size_t width);

}  // namespace hydroscope
