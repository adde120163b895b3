#pragma once

#include <span>
#include <string_view>

#include "models/machine_file/section_text.h"
#include "models/machine_file/table.h"
#include "models/part_settings.h"

namespace hydroscope {

/// The section of one feed, [feeds.<name>], which the feed's own folder reads and writes.
struct FeedSection {
  std::string_view name;
  std::string_view comment;  ///< above the section in files that the program writes
  std::vector<std::string> keys;
  PartSettings (*read)(TableReader& section) = nullptr;
  Pairs (*write)(const PartSettings& settings) = nullptr;
};

/// All of them, in the order of files (alarms/feeds/sections.cc).
std::span<const FeedSection* const> FeedSections();

}  // namespace hydroscope
