#include "page/access/secrets.h"

#include <sodium.h>

#include <array>

#include "core/told_error.h"

namespace hydroscope {
namespace {

template <std::size_t n>
std::string Hexadecimal(const std::array<unsigned char, n>& bytes) {
  std::array<char, 2 * n + 1> digits{};
  sodium_bin2hex(digits.data(), digits.size(), bytes.data(), bytes.size());
  return digits.data();
}

/// Has to be called before anything else of the library; a second time does nothing.
bool LibraryIsReady() { return sodium_init() >= 0; }

/// Looked at where there is no such user, so that names cannot be found out by the time an answer takes.
const std::string& HashOfNobody() {
  static const std::string kHash = HashOfPassword(RandomToken()).value_or("");
  return kHash;
}

}  // namespace

std::string RandomToken() {
  std::array<unsigned char, 32> bytes{};
  if (LibraryIsReady()) randombytes_buf(bytes.data(), bytes.size());
  return Hexadecimal(bytes);
}

bool SameSecret(const std::string& a, const std::string& b) {
  return !a.empty() && a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string HashOfToken(const std::string& token) {
  std::array<unsigned char, crypto_generichash_BYTES> hash{};
  crypto_generichash(hash.data(), hash.size(), reinterpret_cast<const unsigned char*>(token.data()),
                     token.size(), nullptr, 0);
  return Hexadecimal(hash);
}

Result<std::string> HashOfPassword(const std::string& password) {
  if (password.size() < kShortestPassword || password.size() > kLongestPassword)
    return BadInput(Tell("the password has {} characters, expected {} to {}",
                         "das Passwort hat {} Zeichen, erwartet {} bis {}", password.size(),
                         kShortestPassword, kLongestPassword));
  std::array<char, crypto_pwhash_STRBYTES> hash{};
  if (!LibraryIsReady() ||
      crypto_pwhash_str_alg(hash.data(), password.data(), password.size(), crypto_pwhash_OPSLIMIT_INTERACTIVE,
                            crypto_pwhash_MEMLIMIT_INTERACTIVE, crypto_pwhash_ALG_ARGON2ID13) != 0)
    return InternalError("the password cannot be hashed: {} MB of memory are needed",
                         crypto_pwhash_MEMLIMIT_INTERACTIVE >> 20);
  return std::string(hash.data());
}

bool IsPassword(const std::string& hash, const std::string& password) {
  const std::string& known = hash.empty() ? HashOfNobody() : hash;
  const bool same = LibraryIsReady() && password.size() <= kLongestPassword &&
                    crypto_pwhash_str_verify(known.c_str(), password.data(), password.size()) == 0;
  return same && !hash.empty();
}

}  // namespace hydroscope
