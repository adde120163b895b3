#include "simulator/die_cushion/log_format.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace hydroscope {

void AppendPressLine(const PressRow& row, std::string& text) {
  const auto end = std::back_inserter(text);
  const auto field = [&](const auto& format, double value) {
    text += ',';
    if (std::isfinite(value)) fmt::format_to(end, format, value);
  };
  fmt::format_to(end, FMT_COMPILE("{:.6f}"), row.t);
  field(FMT_COMPILE("{:.1f}"), row.p_A);
  field(FMT_COMPILE("{:.1f}"), row.p_B);
  field(FMT_COMPILE("{:.1f}"), row.p_0);
  field(FMT_COMPILE("{:.8f}"), row.z);
  field(FMT_COMPILE("{:.8f}"), row.y_v);
  field(FMT_COMPILE("{:.6f}"), row.U_v);
  field(FMT_COMPILE("{:.4f}"), row.T_oil - 273.15);
  text += '\n';
}

}  // namespace hydroscope
