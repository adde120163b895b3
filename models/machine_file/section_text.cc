#include "models/machine_file/section_text.h"

#include <algorithm>
#include <cctype>

namespace hydroscope {

std::string TomlKey(const std::string& key) {
  const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return c < 0x80 && (std::isalnum(c) || c == '_' || c == '-');
  });
  return bare ? key : Quoted(key);
}

std::string Comment(const std::string& text) {
  std::string line = text;
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return line.empty() ? "#" : "# " + line;
}

std::string Inline(const Pairs& pairs) {
  std::string text = "{ ";
  for (std::size_t i = 0; i < pairs.size(); ++i)
    text += fmt::format("{}{} = {}", i == 0 ? "" : ", ", TomlKey(pairs[i].first), pairs[i].second);
  return pairs.empty() ? "{}" : text + " }";
}

std::string QuotedList(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "" : ", ") + Quoted(text);
  return "[" + list + "]";
}

std::string Section(const std::string& header, const std::string& comment, const Pairs& pairs,
                    const MachineNotes& notes, const std::string& name) {
  std::string text = Comment(comment) + "\n" + header + "\n";
  for (const auto& [key, value] : pairs) text += fmt::format("{} = {}\n", TomlKey(key), value);
  if (const auto found = notes.section.find(name); found != notes.section.end())
    for (const std::string& line : found->second) text += Comment(line) + "\n";
  return text + "\n";
}

}  // namespace hydroscope
