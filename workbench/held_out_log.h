#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/units.h"
#include "workbench/model/machine_model.h"

namespace hydroscope {

/// Logs that a model is fitted to, and one that it is judged on only.
struct LogChoice {
  std::vector<std::string> fitted;
  std::string held_out;  ///< path; "" = none
};

/// Takes `hold_out` out of `logs` by its path or file name, or adds it beside them; "" = none. Error: no log
/// is left to fit to, or the name fits several.
Result<LogChoice> ChooseLogs(const std::vector<std::string>& logs, const std::string& hold_out);

/// Error of a fitted model on strokes it has not seen.
struct HeldOutError {
  std::string log;
  int strokes = 0;
  double rms = 0;  ///< flow form, output unit (SI)
};

/// Error of `model` on all strokes of `held_out`, read with their samples. Error: it has none.
Result<HeldOutError> ErrorOnLog(const MachineModel& model, const LogStrokes& held_out,
                                const std::string& log);

/// The same of the model that `fitted` names, fitted to its strokes.
Result<HeldOutError> ErrorHeldOut(const LogStrokes& fitted, const LogStrokes& held_out,
                                  const std::string& log);
/// ... on a log that is read first.
Result<HeldOutError> ErrorHeldOut(const LogStrokes& fitted, const std::string& log);

/// "error on x.csv, held out: 0.35 l/min, 12 strokes".
std::string HeldOutText(const HeldOutError& error, const DisplayUnit& unit);
/// `log`, `strokes`, `rms`, `unit`.
nlohmann::json HeldOutJson(const HeldOutError& error, const DisplayUnit& unit);

}  // namespace hydroscope
