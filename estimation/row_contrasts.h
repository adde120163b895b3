#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace hydroscope {

/// Readings of one signal in one stroke: runs of rows without a gap.
using SignalRuns = std::vector<std::vector<double>>;

/// A ratio of two mean energies, with the standard error of its logarithm by chunks of time (jackknife).
struct EnergyRatio {
  double log = 0, error = std::numeric_limits<double>::infinity();
  int chunks = 0;

  double value() const;
  /// Clearly above `factor`: by Student's t of the chunks, `significance` on one side.
  bool ClearlyAbove(double factor, double significance) const;
  bool ClearlyBelow(double factor, double significance) const;
  /// Half width of the 95 % band of `log`.
  double Band95() const;
};

/// Energies of contrasts of one signal's readings: four means of d rows each with the signs + - - +, over
/// 4 d rows, scaled so that white noise has its variance at every d. Level and slope do not enter; motion
/// x(t) does with its curvature, sqrt(d) x'' (d T)^2, so that its energy grows 32-fold per octave of d
/// (8-fold at a corner), that of first-order filtered noise at most fourfold. Contrasts of different d over
/// the same rows are orthogonal (Walsh 1923), so rows chosen because little moves over many of them tell the
/// noise over few without bias.
class RowContrasts {
 public:
  /// `chunks` of time are the independent units of ratios.
  RowContrasts(std::span<const SignalRuns> strokes, int chunks);

  /// Too few rows for any statement.
  bool empty() const { return windows_.empty(); }
  /// Rows of the mean whose contrasts tell quiet windows: 8, or fewer where runs are short.
  std::size_t reach() const { return reach_; }
  /// Mean energy over 2^octave rows (octave 0, 1, 2), of all windows or of the quiet ones.
  double Energy(int octave, bool quiet_only) const;
  /// Energy over 2^octave rows against single rows, of the quiet windows.
  EnergyRatio OverRows(int octave) const;
  /// Energy over 2^octave rows of all windows against that of the quiet ones.
  EnergyRatio OverQuiet(int octave) const;

 private:
  /// What one window of 4 reach rows shows.
  struct Window {
    double motion = 0;  ///< energy of the contrast over the whole window or its neighbours, the largest
    std::array<double, 3> energy{};  ///< mean energy of contrasts over 1, 2, 4 rows
  };
  class Run;
  struct Sums;

  static Window WindowAt(const Run& run, std::size_t first, std::size_t reach);
  static void SpreadMotion(std::span<Window> windows);
  static EnergyRatio RatioOf(std::vector<Sums> chunks);
  void TakeWindows(std::span<const SignalRuns> strokes);
  void ChooseQuiet();
  bool Quiet(const Window& window) const { return window.motion <= limit_; }

  std::vector<Window> windows_;
  std::size_t reach_ = 8;
  std::size_t chunks_;
  double limit_ = std::numeric_limits<double>::infinity();  ///< largest motion of a quiet window
};

}  // namespace hydroscope
