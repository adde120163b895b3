#include "core/told.h"

#include <algorithm>

namespace hydroscope {

Told TellNumber(std::string number) {
  Told told{number, std::move(number)};
  std::replace(told.german.begin(), told.german.end(), '.', ',');
  return told;
}

Told Joined(const std::vector<Told>& parts, std::string_view between) {
  Told joined;
  for (const Told& part : parts) {
    if (&part != &parts.front()) joined = {joined.english.append(between), joined.german.append(between)};
    joined.english += part.english;
    joined.german += part.InGerman();
  }
  return joined;
}

}  // namespace hydroscope
