// libFuzzer target: whatever the text, ParseRules gives rules that can be asked, or an error with words.
#include <cmath>
#include <cstdlib>

#include "diagnosis/drift/rules.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hydroscope::drift;
  const auto book = ParseRules(std::string(reinterpret_cast<const char*>(data), size), "fuzz");
  if (!book) return book.error().text.empty() ? std::abort(), 0 : 0;
  std::map<std::string, int> moved;
  for (const WatchSpec& watch : book->watches) {
    if (book->Find(watch.quantity) == nullptr) std::abort();
    const DriftSize sizes = watch.Sizes(1.0);
    if (std::isnan(sizes.smallest) || std::isnan(sizes.alarm)) std::abort();
    moved[watch.quantity] = moved.size() % 2 == 0 ? 1 : -1;
  }
  book->Match(moved);
  for (const Rule& rule : book->rules) {
    std::map<std::string, int> wanted;
    for (const auto& [quantity, movement] : rule.when)
      wanted[quantity] = movement == Movement::kDown ? -1 : 1;
    if (!rule.Matches(wanted)) std::abort();
    if (book->Match(wanted, rule.axes) == nullptr) std::abort();
  }
  return 0;
}
