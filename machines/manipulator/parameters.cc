#include "machines/manipulator/parameters.h"

#include <fmt/format.h>

namespace hydroscope::manipulator {

std::vector<ParameterSpec> ParameterRanges() {
  std::vector<ParameterSpec> out = {
      {"mx_1", 1100, 10, 1e5, "kg m"}, {"my_1", 0, -1e4, 1e4, "kg m"}, {"J_1", 2000, 10, 1e6, "kg m2"},
      {"mx_2", 1000, 10, 1e5, "kg m"}, {"my_2", 0, -1e4, 1e4, "kg m"}, {"J_2", 2000, 10, 1e6, "kg m2"},
  };
  for (const int i : {1, 2}) {
    out.push_back({fmt::format("b_{}", i), 3e4, 10, 1e6, "N s/m"});
    out.push_back({fmt::format("F_c_{}", i), 500, 0, 5e4, "N"});
    out.push_back({fmt::format("K_{}", i), 1e9, 1e8, 3e9, "Pa"});
    for (const char* edge : kEdges)
      out.push_back({fmt::format("C_{}_{}", edge, i), 6.3e-7, 1e-8, 1e-5, "m3/(s sqrt(Pa))"});
  }
  return out;
}

}  // namespace hydroscope::manipulator
