#pragma once

#include <string>

namespace hydroscope {

struct ExampleLogOptions {
  std::string log, machine_file;
  double K = 1.21e9;          ///< Pa, truth
  double V0 = 1.65e-3;        ///< m^3
  double Q_vn = 102.0 / 6e4;  ///< m^3/s
  double y_0 = 0.008;         ///< 1
};

/// Fits an example log without hidden effect and compares with its truth. Returns 0 if K' is within 2 %, V0
/// within 3 %, Q_vn within 0.3 % and y_0 within 0.0005, else 1; the exit code of the error if the log cannot
/// be fitted.
int RunExampleLog(const ExampleLogOptions& options);

}  // namespace hydroscope
