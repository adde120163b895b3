#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "estimation/states/simulation.h"

namespace hydroscope {

/// Standard deviation of the white noise of each signal, from its sixth differences: what moves evenly over seven rows leaves
/// nothing in them. 0 where nothing is read.
Eigen::VectorXd WhiteNoiseOfSignals(std::span<const Episode> episodes);

/// Copies of the record with noise of these standard deviations added to its signals: one draw added, and the same draw taken
/// away, `pairs` times. What is linear in the noise cancels between the two; what it does to products and bends remains.
std::vector<std::vector<Episode>> NoisierCopies(std::span<const Episode> episodes,
                                                const Eigen::VectorXd& noise, int pairs, std::uint32_t seed);

}  // namespace hydroscope
