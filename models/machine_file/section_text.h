#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "models/machine_file/format.h"
#include "models/machine_file/toml_text.h"

namespace hydroscope {

/// Keys and what stands behind their "=".
using Pairs = std::vector<std::pair<std::string, std::string>>;

inline std::string Plain(double value) { return fmt::format("{}", value); }
inline std::string Plain(bool value) { return value ? "true" : "false"; }
inline std::string Plain(int value) { return fmt::format("{}", value); }
std::string QuotedList(const std::vector<std::string>& texts);

/// A key as TOML writes it, with quotes where it needs some.
std::string TomlKey(const std::string& key);
/// "# text", on one line whatever the text.
std::string Comment(const std::string& text);
/// "{ key = value, ... }".
std::string Inline(const Pairs& pairs);
/// "[name]" with a comment line before, the pairs one a line, the notes of that section, and an empty line.
std::string Section(const std::string& header, const std::string& comment, const Pairs& pairs,
                    const MachineNotes& notes, const std::string& name);

/// [live] and [feeds] of a machine, "" where it has none.
std::string LiveSections(const Machine& machine, const MachineNotes& notes);
std::string FeedsSections(const Machine& machine, const MachineNotes& notes);

}  // namespace hydroscope
