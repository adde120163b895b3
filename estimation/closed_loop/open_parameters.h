#pragma once

#include <vector>

#include "estimation/closed_loop/transfer_fit.h"

namespace hydroscope {

/// Why the frequencies of the bins `used` do not determine the parameters of `fit`, and what helps: a stronger excitation, faster
/// rows, larger movements, a wider range.
Told WhyParametersStayOpen(const LoopSpectra& spectra, const std::vector<std::size_t>& used,
                           const TransferFit& fit);

}  // namespace hydroscope
