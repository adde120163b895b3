#include "report/episode_word.h"

#include <cctype>

namespace hydroscope {
namespace {

constexpr std::string_view kStroke = "stroke";
constexpr std::string_view kLabel = "aria-label=\"";

bool IsLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// Whether the word "stroke" or "strokes", with a small or a capital letter first, stands at `at`.
bool StandsAt(std::string_view text, std::size_t at) {
  if (text[at] != 's' && text[at] != 'S') return false;
  if (text.substr(at + 1, kStroke.size() - 1) != kStroke.substr(1)) return false;
  if (at > 0 && (IsLetter(text[at - 1]) || text[at - 1] == '_')) return false;
  const std::size_t end = at + kStroke.size();
  const std::size_t after = end < text.size() && text[end] == 's' ? end + 1 : end;
  return after >= text.size() || (!IsLetter(text[after]) && text[after] != '_');
}

/// "a " at the end of the text before a word that begins with a vowel becomes "an ".
void MendArticle(std::string_view word, std::string& text) {
  const auto is_article = [](char c) { return c == 'a' || c == 'A'; };
  const std::size_t end = text.size();
  if (std::string_view("aeiou").find(word.front()) == std::string_view::npos) return;
  if (end < 2 || text[end - 1] != ' ' || !is_article(text[end - 2])) return;
  if (end == 2 || !IsLetter(text[end - 3])) text.insert(end - 1, "n");
}

}  // namespace

std::string WithEpisodesCalled(std::string_view word, std::string_view html) {
  std::string out;
  out.reserve(html.size());
  bool in_tag = false;
  std::size_t label_end = 0;  // what is read aloud is text, too
  for (std::size_t at = 0; at < html.size(); ++at) {
    const char c = html[at];
    if (c == '<' || c == '>') in_tag = c == '<';
    if (in_tag && html.substr(at).starts_with(kLabel)) label_end = html.find('"', at + kLabel.size());
    if ((in_tag && at >= label_end) || !StandsAt(html, at)) {
      out += c;
      continue;
    }
    MendArticle(word, out);
    out +=
        c == 'S' ? static_cast<char>(std::toupper(static_cast<unsigned char>(word.front()))) : word.front();
    out += word.substr(1);
    at += kStroke.size() - 1;
  }
  return out;
}

}  // namespace hydroscope
