#pragma once

#include <string>

namespace hydroscope {

/// Something that a SCADA system can read of a feed, as engineers enter it: where it stands, what it is, and what it is now.
struct Tag {
  std::string feed;     ///< "modbus", "sparkplug"
  std::string axis;     ///< "press/cushion_1", as it is called everywhere; "" = the machine as a whole
  std::string address;  ///< register from 0; topic
  std::string name;     ///< "Parameters/K", "parameter K"
  std::string type;     ///< "u16", "u32", "float32", "text", "Double", ...
  std::string unit;     ///< as told by the feed; "" = none
  std::string meaning;  ///< one sentence; "" = the name says it
  std::string value;    ///< now; "" = not known
};

}  // namespace hydroscope
