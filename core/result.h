#pragma once

#include <fmt/format.h>

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace hydroscope {

/// Who has to act on an error. The command line turns the kind into its exit code.
enum class ErrorKind {
  kUsage,     ///< the command was called wrongly (exit code 2)
  kBadInput,  ///< a file or value from outside is wrong (exit code 3)
  kInternal,  ///< our own fault, or the system's: out of disk, out of memory (exit code 1)
};

/// An error as a value. `text` says what was found, where, and what was expected or what to do next.
struct Error {
  ErrorKind kind = ErrorKind::kInternal;
  std::string text;
  std::string german = {};  ///< the same on the page (core/told_error.h); "": told in English alone
};

template <typename T>
using Result = tl::expected<T, Error>;
using Status = tl::expected<void, Error>;

template <typename... Args>
tl::unexpected<Error> BadInput(fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected(Error{ErrorKind::kBadInput, fmt::format(format, std::forward<Args>(args)...)});
}
template <typename... Args>
tl::unexpected<Error> UsageError(fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected(Error{ErrorKind::kUsage, fmt::format(format, std::forward<Args>(args)...)});
}
template <typename... Args>
tl::unexpected<Error> InternalError(fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected(Error{ErrorKind::kInternal, fmt::format(format, std::forward<Args>(args)...)});
}

}  // namespace hydroscope
