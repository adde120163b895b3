#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hydroscope {

/// Studies of simulated presses and valves whose truth is known, one file each: `hydroscope benchmark`. Each prints a table, says
/// what was required and returns 0 if it was reached, else 1.

struct CoverageOptions {
  int cases = 200;
  std::uint64_t seed = 1;  ///< of the first machine
  double seconds = 120;    ///< of each log
};

/// Simulates logs of varied machines, identifies each and prints, per parameter, how often the
/// 95 % interval holds the truth, the mean error and the spread, for the batch fit and for the recursive estimator.
/// Returns 0 if every coverage of the batch fit lies within 92 ... 98 %, else 1.
int RunCoverageBenchmark(const CoverageOptions& options);

struct HiddenEffectsOptions {
  int cases = 300;           ///< simulated logs
  std::uint64_t seed = 1;    ///< of the whole campaign
  bool experiments = false;  ///< run the experiment proposed for every ambiguous case and explain again
  std::vector<int> only;     ///< numbers of cases; empty: all
  bool healthy = false;      ///< hide nothing: how often something is claimed
  std::string details;       ///< one line per case to this tab-separated file, "" = none
};

/// Hides effects in simulated logs of varied machines, sizes, speeds and lengths, explains each log as a user
/// would and prints, per kind of case, how often the truth was found, how often a wrong name was given, and
/// how large the sets were, with a confusion matrix. Returns 0 if every goal is reached, else 1.
int RunHiddenEffectsBenchmark(const HiddenEffectsOptions& options);

struct LateSignalsOptions {
  int cases = 96;
  std::uint64_t seed = 1;  ///< of the whole campaign
};

/// Explains logs of varied machines of which one signal is late or filtered by 1 to 13 ms, every second one with quick
/// pressure steps. Prints per signal how often the two are told apart, how often the wrong one is named alone, and by how
/// much of the noise energy the right one leaves more than its twin at most: what Effect::Twin::excess must be well
/// above. Returns 0 unless a wrong one was named alone.
int RunLateSignalsBenchmark(const LateSignalsOptions& options);

struct FrfBenchmarkOptions {
  int cases = 400;         ///< sweeps of each variation
  std::uint64_t seed = 1;  ///< of the first one's noise
};

/// `hydroscope benchmark frf`: simulated valve sweeps (the published valve and variations of sampling rate,
/// dead time, damping, amplitude and noise), `cases` seeds of each from `seed` on. Prints per variation and
/// parameter the truth, the mean estimate, the coverage of the stated 95 % intervals and the worst error, and
/// the time one sweep takes to evaluate. Returns an exit code: 0 if every f0 is within 0.5 % (2 % for the
/// noisy variation) and the coverage of the published valve within 92 ... 98 % (checked from 100 cases on),
/// else 1.
int RunFrfBenchmark(const FrfBenchmarkOptions& options);

struct FilterStudyOptions {
  int draws = 150;
  double seconds = 60;
  std::uint64_t seed = 1;
  int seeds = 1;    ///< logs, with seeds seed, seed + 1, ...
  std::string svg;  ///< file for the plot of the first log, "" = none
};

/// The filter study of the press paper (section 5.1, figures 11-15): one noise-free log of a simulated press
/// is given the rig's sensor noise `draws` times. For every draw the identification as published (moving
/// average and symmetrical derivative of width M, exponential forgetting 0.998 every 10 ms, theta(0) = 1,
/// alpha = 500) runs with M = 0 ... 50 and with the published pair 31/25, and beside it the product's own
/// estimators. Printed are bias and standard deviation of theta1 ... theta3 in percent of the truth; theta of
/// the recursive estimators is its mean over the last third of the log.
///
/// What a log tells depends on the speeds and pressure steps it happens to hold. With `seeds` above 1 the
/// product's estimators are studied on as many logs, and the table per log and its median are printed too.
///
/// Returns 0 if the product's estimators, recursive and batch, stay within |bias| <= 0.5 % and a standard
/// deviation of 0.1, 1.4 and 1.7 % for theta1, theta2 and theta3 (with several logs: their medians), else 1;
/// 3 if the plot cannot be written.
int RunFilterStudy(const FilterStudyOptions& options);

struct EnduranceOptions {
  std::int64_t updates = 10'000'000;
  double standstill_hours = 24;
  std::uint64_t seed = 1;
};

/// Long runs. (1) Recursive least squares, equation by equation and in the information form that is the
/// default, with every form of forgetting at lambda 0.999: half of the updates, a standstill of zero and of
/// constant regressors, the other half; value and covariance must stay finite, symmetric, positive and right.
/// (2) The whole pipeline: a log, a standstill streamed row by row at 2 ms, another log; at the standstill
/// nothing may change, and the second log must find the truth. Returns 0 if all of it holds, else 1.
int RunEndurance(const EnduranceOptions& options);

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
