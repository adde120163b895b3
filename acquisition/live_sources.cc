#include "acquisition/live_sources.h"

#include "acquisition/list.h"

namespace hydroscope {

std::vector<std::unique_ptr<Source>> MakeSources(const Machine& machine, const Clock& clock,
                                                 std::uint64_t seed) {
  std::vector<std::unique_ptr<Source>> sources;
#define HYDROSCOPE_LIST_MAKER(Name) Make##Name##Sources,
  for (const auto make : {HYDROSCOPE_SOURCES(HYDROSCOPE_LIST_MAKER)})
    for (auto& source : make(machine, clock, seed)) sources.push_back(std::move(source));
#undef HYDROSCOPE_LIST_MAKER
  return sources;
}

}  // namespace hydroscope
