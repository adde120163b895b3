#pragma once

#include <span>
#include <string_view>

namespace hydroscope {

/// One file of the front end as compiled into the program.
struct Asset {
  std::string_view path;  ///< "/assets/index-3f2a.js"; "/" is the page itself
  std::string_view type;  ///< of its content
  std::string_view bytes;
  bool gzipped = false;
};

/// All of them; empty if the program was built without the front end. web/embed.mjs writes the table.
std::span<const Asset> Assets();

}  // namespace hydroscope
