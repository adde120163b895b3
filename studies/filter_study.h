#pragma once

#include <cstdint>
#include <string>

namespace hydroscope {

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

}  // namespace hydroscope
