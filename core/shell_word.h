#pragma once

#include <algorithm>
#include <string>

namespace hydroscope {

/// A path or name as a command that one can copy needs it: in quotes where a shell would cut it into pieces or read more into it.
inline std::string ShellWord(const std::string& word) {
  const auto plain = [](unsigned char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c >= 0x80 ||
           std::string("_-./:,+=@%").find(static_cast<char>(c)) != std::string::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace hydroscope
