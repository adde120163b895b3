#include "host/wrapped_text.h"

#include <algorithm>

namespace hydroscope {
namespace {

constexpr std::size_t kHang = 4;  // blanks that a continued line stands further in

/// Bytes of the first `count` characters.
std::size_t BytesOf(std::string_view text, std::size_t count) {
  std::size_t at = 0;
  while (at < text.size() && (count > 0 || (text[at] & 0xC0) == 0x80)) {
    if ((text[at] & 0xC0) != 0x80) --count;
    ++at;
  }
  return at;
}

std::string_view WithoutBlanks(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  return line;
}

/// A command, also one behind "next:", is copied as it stands.
bool IsCommand(std::string_view line) {
  constexpr std::string_view kNext = "next:";
  line = WithoutBlanks(line);
  if (line.starts_with(kNext)) line = WithoutBlanks(line.substr(kNext.size()));
  return line.starts_with("hydroscope ");
}

constexpr char kKeptBlank = '\x1f';  ///< no text for people holds it

/// Blanks between backquotes become kKeptBlank.
std::string WithQuotesWhole(std::string_view line) {
  std::string kept(line);
  bool quoted = false;
  for (char& c : kept) {
    if (c == '`') quoted = !quoted;
    if (c == ' ' && quoted) c = kKeptBlank;
  }
  return quoted ? std::string(line) : kept;  // a single one is an accent
}

void AppendWrapped(std::string_view line, std::size_t width, std::string& out) {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  std::size_t indent = 0;  // of what is being broken
  while (BytesOf(line, width - indent) < line.size()) {
    const std::size_t fits = BytesOf(line, width - indent);
    std::size_t blank = line.rfind(' ', fits);
    if (blank == line.npos || line.find_first_not_of(' ') > blank) blank = line.find(' ', fits);
    if (blank == line.npos) break;  // one long word
    std::string_view taken = line.substr(0, blank);
    out.append(indent, ' ').append(taken.substr(0, taken.find_last_not_of(' ') + 1)) += '\n';
    line.remove_prefix(std::min(line.find_first_not_of(' ', blank), line.size()));
    indent = std::min(begin + kHang, width / 2);
    if (line.empty()) return;
  }
  out.append(indent, ' ').append(line) += '\n';
}

}  // namespace

std::string WrappedText(std::string_view text, std::size_t width) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (IsCommand(line))
      out.append(line) += '\n';
    else
      AppendWrapped(WithQuotesWhole(line), width, out);
    if (end == text.size()) out.pop_back();
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  std::ranges::replace(out, kKeptBlank, ' ');
  return out;
}

}  // namespace hydroscope
