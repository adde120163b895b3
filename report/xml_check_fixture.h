#pragma once

#include <boost/property_tree/detail/rapidxml.hpp>
#include <string>
#include <vector>

namespace hydroscope {

/// For tests: "" if `text` is well-formed XML (tags closed in order, attributes quoted, no bare & or <), else
/// what is wrong.
inline std::string XmlFault(const std::string& text) {
  namespace rx = boost::property_tree::detail::rapidxml;
  for (std::size_t at = text.find('&'); at != text.npos; at = text.find('&', at + 1)) {
    const std::size_t end = text.find(';', at);
    if (end == text.npos || end - at > 8) return "bare & at " + std::to_string(at);
  }
  std::vector<char> buffer(text.begin(), text.end());
  buffer.push_back('\0');
  try {
    rx::xml_document<char> document;
    document.parse<rx::parse_validate_closing_tags | rx::parse_doctype_node>(buffer.data());
    if (document.first_node() == nullptr) return "no element";
  } catch (const rx::parse_error& error) {
    return error.what();
  }
  return "";
}

}  // namespace hydroscope
