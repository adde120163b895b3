#include "diagnosis/noise_of_halves.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

namespace hydroscope {
namespace {

/// Of which fewer leave a half with too few to be fitted.
constexpr int kFewestToHalve = 8;

/// Rms that the model leaves on that half on which it leaves less; infinite if neither can be fitted.
double LeftOnBetterHalf(const StrokeSet& strokes, std::span<const EffectChoice> choices) {
  std::vector<std::size_t> all(static_cast<std::size_t>(strokes.strokes()));
  std::iota(all.begin(), all.end(), std::size_t{0});
  const std::span<const std::size_t> each(all);
  double least = std::numeric_limits<double>::infinity();
  for (const auto half : {each.first(all.size() / 2), each.subspan(all.size() / 2)}) {
    const ExtendedFit fit = strokes.Only(half).Fit(choices);
    if (fit.solved) least = std::min(least, fit.rms_residual);
  }
  return least;
}

}  // namespace

Told WhyNoiseIsNotBelievable(const StrokeSet& strokes, std::span<const EffectChoice> start,
                             const ExtendedFit& fit, double most) {
  if (!fit.solved || strokes.strokes() < kFewestToHalve) return {};
  const double times = fit.noise_floor / LeftOnBetterHalf(strokes, start);
  if (!(times > most)) return {};
  return Tell(
      "noise alone is said to leave {:.2g} times what the model as it is leaves on one half of the strokes fitted by itself: they "
      "are not of one machine in one state (another axis, a part exchanged, a setting changed); explain the parts one by one",
      "Rauschen allein ließe angeblich {:.2g}-mal so viel übrig wie das Modell, so wie es ist, auf einer Hälfte der Hübe für sich: "
      "sie sind nicht von einer Maschine in einem Zustand (andere Achse, getauschtes Teil, geänderte Einstellung); die Teile "
      "einzeln erklären",
      times);
}

}  // namespace hydroscope
