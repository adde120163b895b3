#include "core/unit_told.h"

#include <boost/algorithm/string/replace.hpp>

namespace hydroscope {

Told UnitTold(std::string_view name) {
  Told told{std::string(name), std::string(name)};
  boost::algorithm::replace_all(told.german, " per ", " je ");
  boost::algorithm::replace_all(told.german, " of stroke", " des Wegs");
  return told;
}

}  // namespace hydroscope
