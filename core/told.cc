#include "core/told.h"

#include <algorithm>

#include "core/unit_told.h"

namespace hydroscope {

Told TellNumber(std::string number) {
  Told told = UnitTold(number);
  std::ranges::replace(told.german, '.', ',');
  return told;
}

std::vector<std::string> InEnglish(const std::vector<Told>& sentences) {
  std::vector<std::string> english;
  for (const Told& sentence : sentences) english.push_back(sentence.english);
  return english;
}

std::vector<std::string> InGerman(const std::vector<Told>& sentences) {
  std::vector<std::string> german;
  for (const Told& sentence : sentences) german.push_back(sentence.german);
  return german;
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
