#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iostream>

#include "core/constants.h"
#include "host/output.h"
#include "studies/benchmarks.h"
#include "workbench/fit_log.h"

namespace hydroscope {
namespace {

struct Row {
  const char* name;
  double truth;
  double limit;  ///< share of the truth, or absolute
  bool absolute;
  double factor;  ///< SI to the unit shown
  const char* unit;
};

bool PrintRow(const Row& row, const Estimate& estimate) {
  const double deviation = (estimate.value - row.truth) / (row.absolute ? 1.0 : row.truth);
  const bool within = std::abs(deviation) <= row.limit;
  const bool held = std::abs(estimate.value - row.truth) <= kNormal95 * estimate.std;
  const std::string error =
      row.absolute ? fmt::format("{:+.5f}", deviation) : fmt::format("{:+.2f} %", 100 * deviation);
  const std::string limit =
      row.absolute ? fmt::format("{:.4f}", row.limit) : fmt::format("{:.1f} %", 100 * row.limit);
  fmt::print(
      "{:<5} {:>10.5g} ± {:<9.3g} {:<6} truth {:>8.5g}  deviation {:>9}  limit {:>7}  {}, interval {} it\n",
      row.name, estimate.value * row.factor, kNormal95 * estimate.std * row.factor, row.unit,
      row.truth * row.factor, error, limit, within ? "within" : "MISSED", held ? "holds" : "misses");
  return within;
}

}  // namespace

int RunExampleLog(const ExampleLogOptions& o) {
  const auto result = FitLogs({o.log}, o.machine_file);
  if (!result) return ReportError(result.error());
  fmt::print("{}: {} strokes, rms of held-out strokes {:.3f} l/min, noise floor {:.3f} l/min\n", o.log,
             result->fit.strokes, result->fit.rms_holdout * 6e4, result->fit.noise_floor * 6e4);
  const std::array<Row, 4> rows = {{{"K'", o.K, 0.02, false, 1e-9, "GPa"},
                                    {"V0", o.V0, 0.03, false, 1e3, "l"},
                                    {"Q_vn", o.Q_vn, 0.003, false, 6e4, "l/min"},
                                    {"y_0", o.y_0, 0.0005, true, 1, ""}}};
  bool reached = true;
  for (std::size_t i = 0; i < rows.size(); ++i)
    reached = PrintRow(rows[i], result->fit.parameters[i]) && reached;
  std::cout << (reached ? "reached" : "NOT reached") << ": every parameter within its limit\n";
  return reached ? 0 : 1;
}

}  // namespace hydroscope
