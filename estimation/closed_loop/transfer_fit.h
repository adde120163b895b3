#pragma once

#include <Eigen/Dense>
#include <complex>
#include <optional>
#include <vector>

#include "core/result.h"
#include "estimation/closed_loop/cross_spectra.h"
#include "estimation/closed_loop/loop_estimate.h"
#include "estimation/recursive/episode_model.h"
#include "models/closed_loop.h"

namespace hydroscope {

/// A transfer function and the conditions it is fitted under.
struct TransferModel {
  const ClosedLoopPlant* plant = nullptr;
  std::vector<double> geometry;  ///< as MachineKind::geometry lists it, SI
  double hold = 0;               ///< s the input is held between rows; 0: it moves evenly

  /// Output over input at a frequency (Hz) at the instants of the rows.
  std::complex<double> Response(double frequency, const std::vector<double>& parameters) const;
};

/// A valley that the search ended in.
struct TransferMinimum {
  std::vector<double> parameters;  ///< SI
  double chi_squared = 0;          ///< over the points of the search
  int starts = 0;                  ///< that ended there
};

struct TransferFit : LoopEstimate {
  double chi_squared = 0;  ///< of real and imaginary part of every point over its variance
  int degrees_of_freedom = 0;
  double inflation = 1;  ///< factor on the standard deviations, because the misfit exceeds the noise
  double blocks = 0;     ///< behind the covariance: degrees of freedom of its variances, and one
  std::vector<TransferMinimum> minima;  ///< of the search, best first
  double lowest = 0, highest = 0;       ///< Hz

  /// By how much 1.96 standard deviations are too narrow an interval: Student's t of so few blocks over the normal one.
  double Widening() const;
};

struct TransferFitOptions {
  bool free_delay = true;
  const TransferFit* near = nullptr;  ///< search from there and not from the starts
};

/// Fits the plant's transfer function to cross spectra with the set point by maximum likelihood: squares of
///
///   e(f) = (P_ry - G(f) P_ru) / sqrt(P_rr P_vv / 2),   v = y - G u
///
/// over the bins of `used`. P_ry - G P_ru has zero mean at the true G whatever circulates in the loop, since the set point comes
/// from outside (Soederstroem and Stoica, System Identification, 1989, ch. 10), also where coherence is low; P_vv is taken
/// from the measured ratio first, then from the model. Levenberg-Marquardt (Ceres) from the best of all combinations of starts.
///
/// Standard deviations come from how much the parts of the record pull at the parameters (sandwich, clustered by blocks of
/// segments; Liang and Zeger 1986): overlapping segments, neighbouring bins and noise of any colour are in it. Those from the
/// Jacobian would be too small.
Result<TransferFit> FitTransfer(const LoopSpectra& spectra, const std::vector<std::size_t>& used,
                                const TransferModel& model, const TransferFitOptions& options = {});

/// The same errors at some parameters for following, with the slopes (by SI units) at others; the parts of the record are the
/// pieces. Noise is that beside the measured ratio: from the model, parameters that lag behind would take weight from the
/// frequencies that say so. A Hann window ties neighbouring bins: their errors count as so many fewer independent ones.
LinearisedEpisode LineariseTransfer(const LoopSpectra& spectra, const std::vector<std::size_t>& used,
                                    const TransferModel& model, const std::vector<double>& parameters,
                                    const std::vector<double>& slopes_of);
/// Rms of what the model leaves of the output over these bins, y - G u, SI of the output.
double RemainderOfTransfer(const LoopSpectra& spectra, const std::vector<std::size_t>& used,
                           const TransferModel& model, const std::vector<double>& parameters);

}  // namespace hydroscope
