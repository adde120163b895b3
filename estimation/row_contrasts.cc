#include "estimation/row_contrasts.h"

#include <algorithm>
#include <cmath>

#include "core/distributions.h"

namespace hydroscope {
namespace {

/// Windows below which nothing can be said.
constexpr std::size_t kLeastContrastWindows = 24;
/// Share of the windows that counts as quiet at least: those in which the signal moves least.
constexpr double kQuietShare = 1.0 / 3;
/// Motion over a window, in noise energies, up to which it counts as quiet whatever the others do: noise alone is
/// beyond it in 0.05 %. Curvature that large adds 1/85 to the energy of pairs of a window of 32 rows.
constexpr double kLittleMotion = 12;

double QuantileOfT(int chunks, double significance) {
  return StudentQuantile(1 - significance, chunks - 1.0);
}

}  // namespace

double EnergyRatio::value() const { return std::exp(log); }

bool EnergyRatio::ClearlyAbove(double factor, double significance) const {
  if (chunks < 3 || !std::isfinite(error)) return false;
  return log - std::log(factor) > QuantileOfT(chunks, significance) * error;
}

bool EnergyRatio::ClearlyBelow(double factor, double significance) const {
  return EnergyRatio{-log, error, chunks}.ClearlyAbove(1 / factor, significance);
}

double EnergyRatio::Band95() const {
  return chunks < 3 ? std::numeric_limits<double>::infinity() : QuantileOfT(chunks, 0.025) * error;
}

/// Contrasts of a run from its running sum.
class RowContrasts::Run {
 public:
  explicit Run(const std::vector<double>& rows) : sum_(rows.size() + 1, 0.0) {
    for (std::size_t k = 0; k < rows.size(); ++k) sum_[k + 1] = sum_[k] + (rows[k] - rows.front());
  }
  /// Energy of + - - + over 4 d rows from `first` on.
  double Energy(std::size_t first, std::size_t d) const {
    const double c = Sum(first, d) - Sum(first + d, 2 * d) + Sum(first + 3 * d, d);
    return c * c / (4.0 * static_cast<double>(d));
  }

 private:
  double Sum(std::size_t first, std::size_t rows) const { return sum_[first + rows] - sum_[first]; }

  std::vector<double> sum_;
};

struct RowContrasts::Sums {
  double numerator = 0, denominator = 0, numerator_count = 0, denominator_count = 0;

  void Add(const Sums& other, double sign) {
    numerator += sign * other.numerator;
    denominator += sign * other.denominator;
    numerator_count += sign * other.numerator_count;
    denominator_count += sign * other.denominator_count;
  }
  double LogRatio() const {
    return std::log(numerator / numerator_count) - std::log(denominator / denominator_count);
  }
};

EnergyRatio RowContrasts::RatioOf(std::vector<Sums> chunks) {
  std::erase_if(chunks, [](const Sums& c) { return c.numerator_count == 0 && c.denominator_count == 0; });
  Sums total;
  for (const Sums& c : chunks) total.Add(c, 1);
  EnergyRatio ratio;
  ratio.chunks = static_cast<int>(chunks.size());
  ratio.log = total.LogRatio();
  if (ratio.chunks < 3 || !std::isfinite(ratio.log)) return ratio;
  double sum = 0, squares = 0;
  for (const Sums& c : chunks) {
    Sums rest = total;
    rest.Add(c, -1);
    const double log = rest.LogRatio();
    sum += log;
    squares += log * log;
  }
  const double n = ratio.chunks;
  ratio.error = std::sqrt(std::max(0.0, (n - 1) / n * (squares - sum * sum / n)));
  if (!std::isfinite(ratio.error)) ratio.error = std::numeric_limits<double>::infinity();
  return ratio;
}

RowContrasts::RowContrasts(std::span<const SignalRuns> strokes, int chunks)
    : chunks_(static_cast<std::size_t>(chunks)) {
  for (reach_ = 8; reach_ >= 2; reach_ /= 2) {
    TakeWindows(strokes);
    if (windows_.size() >= 2 * kLeastContrastWindows || reach_ == 2) break;
  }
  if (windows_.size() < kLeastContrastWindows) windows_.clear();
  if (!windows_.empty() && reach_ > 2) ChooseQuiet();
}

void RowContrasts::TakeWindows(std::span<const SignalRuns> strokes) {
  windows_.clear();
  for (const SignalRuns& stroke : strokes)
    for (const std::vector<double>& rows : stroke) {
      if (rows.empty()) continue;
      const Run run(rows);
      const std::size_t first = windows_.size();
      for (std::size_t k = 0; k + 4 * reach_ <= rows.size(); k += 2 * reach_)
        windows_.push_back(WindowAt(run, k, reach_));
      SpreadMotion(std::span(windows_).subspan(first));
    }
}

RowContrasts::Window RowContrasts::WindowAt(const Run& run, std::size_t first, std::size_t reach) {
  Window w;
  w.motion = run.Energy(first, reach);
  for (std::size_t o = 0, d = 1; o < w.energy.size() && d <= reach; ++o, d *= 2) {
    for (std::size_t k = 0; k < reach / d; ++k) w.energy[o] += run.Energy(first + 4 * d * k, d);
    w.energy[o] /= static_cast<double>(reach / d);
  }
  return w;
}

/// What moves in one window may have moved beside it: each takes the largest motion of three.
void RowContrasts::SpreadMotion(std::span<Window> windows) {
  double before = 0;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const double own = windows[k].motion, after = k + 1 < windows.size() ? windows[k + 1].motion : 0.0;
    windows[k].motion = std::max({before, own, after});
    before = own;
  }
}

void RowContrasts::ChooseQuiet() {
  std::vector<double> motion;
  for (const Window& w : windows_) motion.push_back(w.motion);
  const auto quiet =
      motion.begin() + static_cast<std::ptrdiff_t>(kQuietShare * static_cast<double>(motion.size()));
  std::nth_element(motion.begin(), quiet, motion.end());
  limit_ = *quiet;
  limit_ = std::max(limit_, kLittleMotion * Energy(0, true));
}

double RowContrasts::Energy(int octave, bool quiet_only) const {
  double sum = 0, count = 0;
  for (const Window& w : windows_) {
    if (quiet_only && !Quiet(w)) continue;
    sum += w.energy[octave];
    count += 1;
  }
  return count > 0 ? sum / count : 0.0;
}

EnergyRatio RowContrasts::OverRows(int octave) const {
  std::vector<Sums> chunks(chunks_);
  for (std::size_t k = 0; k < windows_.size(); ++k)
    if (Quiet(windows_[k]))
      chunks[k * chunks_ / windows_.size()].Add({windows_[k].energy[octave], windows_[k].energy[0], 1, 1}, 1);
  return RatioOf(std::move(chunks));
}

EnergyRatio RowContrasts::OverQuiet(int octave) const {
  std::vector<Sums> chunks(chunks_);
  for (std::size_t k = 0; k < windows_.size(); ++k) {
    const double energy = windows_[k].energy[octave];
    const bool quiet = Quiet(windows_[k]);
    chunks[k * chunks_ / windows_.size()].Add({energy, quiet ? energy : 0.0, 1, quiet ? 1.0 : 0.0}, 1);
  }
  return RatioOf(std::move(chunks));
}

}  // namespace hydroscope
