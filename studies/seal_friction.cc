#include "studies/seal_friction.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <numeric>
#include <set>

#include "core/constants.h"
#include "host/output.h"
#include "workbench/explain/explain_log.h"

namespace hydroscope {
namespace {

constexpr double kBore = 0.0257, kBoreTolerance = 0.0002;  ///< m
constexpr double kRequiredFall = 0.25;                     ///< error after over error before
const std::set<std::string> kTrue = {"coulomb_friction", "pressure_friction"};

std::vector<std::string> Logs(const SealFrictionOptions& options) {
  const char* set = std::getenv("HYDROSCOPE_DATA");
  const std::string folder = !options.data.empty()
                                 ? options.data
                                 : std::string(set != nullptr ? set : "../shared/data") + "/seal_friction";
  std::vector<std::string> logs;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failure))
    if (entry.path().extension() == ".csv") logs.push_back(entry.path().string());
  std::ranges::sort(logs);
  if (logs.empty()) std::cerr << fmt::format("no runs (*.csv) in {}: give the folder with --data\n", folder);
  return logs;
}

/// Error on each log by a model fitted to the others, N rms over all windows.
double ErrorOnLogsLeftOut(const std::vector<LogStrokes>& logs, const std::vector<int>& columns, int output) {
  std::vector<NormalEquations> fit, judge;
  for (const LogStrokes& log : logs) {
    NormalEquations f, j;
    for (const StrokeRecord& stroke : log.strokes) {
      f += IntegralEquations(stroke.gram, columns, output);
      j += FlowEquations(stroke.gram, columns, output);
    }
    fit.push_back(f);
    judge.push_back(j);
  }
  double error = 0, windows = 0;
  for (std::size_t left_out = 0; left_out < logs.size(); ++left_out) {
    NormalEquations rest;
    for (std::size_t k = 0; k < logs.size(); ++k)
      if (k != left_out) rest += fit[k];
    const Eigen::VectorXd theta = SolveNormalEquations(rest);
    if (theta.size() == 0) return NAN;
    error += MeanSquaredError(judge[left_out], theta) * judge[left_out].equations;
    windows += judge[left_out].equations;
  }
  return std::sqrt(error / windows);
}

}  // namespace

int RunSealFriction(const SealFrictionOptions& options) {
  const std::vector<std::string> logs = Logs(options);
  if (logs.empty()) return 3;
  const auto result = ExplainLogs(logs, options.machine);
  if (!result) return ReportError(result.error());
  const Explanation& x = result->explanation;
  std::vector<LogStrokes> apart;
  for (const std::string& log : logs) {
    auto strokes = ReadStrokes(log, result->log.machine);
    if (!strokes) return ReportError(strokes.error());
    apart.push_back(std::move(*strokes));
  }

  fmt::print("{} strokes of {} logs, {} of {} rows used\n\nF = A p + c, error in N rms\n", result->strokes,
             logs.size(), result->log.totals.used, result->log.totals.samples);
  fmt::print("  {:<26} {:>17} {:>20}\n", "", "strokes left out", "pressures left out");
  std::vector<int> columns(static_cast<std::size_t>(x.model->base_count));
  std::iota(columns.begin(), columns.end(), 0);
  for (std::size_t k = 0; k < x.steps.size(); ++k) {
    if (k > 0) {
      const EffectChoice& choice = x.chosen[k - 1];
      columns.push_back(x.model->effect_shapes[choice.effect][choice.shape].columns.front());
    }
    fmt::print("  {:<26} {:>17.2f} {:>20.2f}\n", k == 0 ? "as it is" : "+ " + x.steps[k].added,
               x.steps[k].rms_holdout, ErrorOnLogsLeftOut(apart, columns, x.model->output_column()));
  }
  fmt::print("  {:<26} {:>17.2f}\n\nverdict {}: {}{}\n", "sensor noise alone", x.final.noise_floor,
             VerdictName(x.verdict), fmt::join(x.set, ", "),
             x.doubt.empty() ? "" : fmt::format(" ({})", x.doubt.english));
  for (const EffectEstimate& e : x.final.effects)
    fmt::print("  {:<18} {} = {:.4g} ± {:.2g} {}\n", result->effect(e.choice.effect).id,
               result->effect(e.choice.effect).parameter, e.size, kNormal95 * e.std,
               result->effect(e.choice.effect).unit);

  double bore = NAN;
  for (const Estimate& e : BaseParameters(*result->log.model, x.final, static_cast<int>(result->strokes))) {
    if (e.parameter != "bore") continue;
    bore = e.value;
    fmt::print("  bore               {:.2f} ± {:.2f} mm (95 % interval); gauge: 25.7 mm\n", 1e3 * e.value,
               1e3 * kNormal95 * e.std);
  }
  const bool named = std::set<std::string>(x.set.begin(), x.set.end()) == kTrue;
  const bool falls = x.final.rms_holdout < kRequiredFall * x.base.rms_holdout;
  const bool fits = std::abs(bore - kBore) <= kBoreTolerance;
  fmt::print(
      "\nrequired: coulomb_friction and pressure_friction named ({}), error down to a quarter ({}), bore "
      "25.7 ± 0.2 mm ({})\n",
      named ? "yes" : "NO", falls ? "yes" : "NO", fits ? "yes" : "NO");
  return named && falls && fits ? 0 : 1;
}

}  // namespace hydroscope
