#pragma once

#include <fmt/format.h>

#include <string>
#include <tl/expected.hpp>
#include <type_traits>
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

/// What an expected holds, if anything.
template <typename T, typename E>
T ValueHeld(const tl::expected<T, E>& expected) {
  if constexpr (!std::is_void_v<T>) return *expected;
}
template <typename T, typename E>
T ValueHeld(tl::expected<T, E>&& expected) {
  if constexpr (!std::is_void_v<T>) return *std::move(expected);
}

/// The value of a Result; if it is an error, the function returns it. Stands alone, as an initialiser or on the right of `=`:
///   TRY(CheckPort(port));
///   const Machine machine = TRY(LoadMachine(path));
/// A statement expression, which GCC and clang know: not inside another expression, whose temporaries it may leave behind.
#define TRY(...)                                                                                    \
  ({                                                                                                \
    auto&& tried_here = (__VA_ARGS__);                                                              \
    if (!tried_here) return tl::unexpected(std::forward<decltype(tried_here)>(tried_here).error()); \
    hydroscope::ValueHeld(std::forward<decltype(tried_here)>(tried_here));                          \
  })

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
