#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

/// 32 bytes from the system, as hexadecimal digits.
std::string RandomToken();
/// Takes as long whatever differs. Nothing is the same as "".
bool SameSecret(const std::string& a, const std::string& b);
/// What is stored in place of a token: its BLAKE2b hash, from which nobody finds the token.
std::string HashOfToken(const std::string& token);

inline constexpr std::size_t kShortestPassword = 10, kLongestPassword = 1024;  ///< bytes

/// What is stored in place of a password: Argon2id (RFC 9106) with a salt of its own and the limits libsodium names
/// interactive, 64 MB and two passes. Errors: the password is too short or too long, or there is not that much memory.
Result<std::string> HashOfPassword(const std::string& password);
/// Whether `hash` was made of it. Takes as long for a hash of nobody.
bool IsPassword(const std::string& hash, const std::string& password);

}  // namespace hydroscope
