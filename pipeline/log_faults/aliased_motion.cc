#include "pipeline/log_faults/aliased_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/units.h"

namespace hydroscope {
namespace {

/// Sums over rows of a signal and of what may be its rate.
class Pair {
 public:
  Pair(int rate, int level, double period) : rate_(rate), level_(level), period_(period) {}

  void Add(const Stretch& stretch) {
    const double *v = stretch[rate_], *x = stretch[level_];
    const auto mean = [&](const double* s) {
      double sum = 0;
      for (int k = 0; k < stretch.samples; ++k) sum += s[k];
      return sum / stretch.samples;
    };
    const double mean_v = mean(v), mean_x = mean(x);
    for (int k = 0; k < stretch.samples; ++k) {
      vv_ += (v[k] - mean_v) * (v[k] - mean_v);
      xx_ += (x[k] - mean_x) * (x[k] - mean_x);
      if (k == 0) continue;
      const double moved = x[k] - x[k - 1], told = period_ * ((v[k] + v[k - 1]) / 2 - mean_v);
      moved_moved_ += moved * moved;
      moved_told_ += moved * told;
      told_told_ += told * told;
      ++steps_;
    }
  }

  double Frequency() const { return std::sqrt(vv_ / xx_) / (2 * std::numbers::pi); }

  /// What either moves by for the other is more than noise leaves, or goes the other way.
  bool DoNotBelongTogether(const AliasedMotionOptions& options) const {
    if (!(moved_moved_ > 0 && told_told_ > 0) || steps_ < 3) return false;
    const double r2 = moved_told_ * moved_told_ / (moved_moved_ * told_told_);
    const double t = std::sqrt(r2 * (steps_ - 2) / std::max(1e-12, 1 - r2));
    if (t < options.least_t) return false;
    return moved_told_ < 0 ||
           std::max(moved_told_ / told_told_, moved_told_ / moved_moved_) > options.least_gain;
  }

 private:
  int rate_, level_;
  double period_;
  double vv_ = 0, xx_ = 0, moved_moved_ = 0, moved_told_ = 0, told_told_ = 0;
  int steps_ = 0;
};

bool Reads(const Machine& machine, const std::string& signal) {
  return std::ranges::any_of(machine.balance.terms, [&](const TermSpec& term) {
    return term.expression == signal || term.expression == "ddt(" + signal + ")";
  });
}

std::string SiUnitOf(const Machine& machine, const ModelStructure& model, int channel) {
  const int source = model.channel_source[static_cast<std::size_t>(channel)];
  if (source < 0) return "";
  const auto unit = FindUnit(machine.signals[static_cast<std::size_t>(source)].unit);
  return unit ? std::string(unit->si) : "";
}

}  // namespace

std::optional<AliasedMotion> FindAliasedMotion(const Machine& machine, const ModelStructure& model,
                                               std::span<const std::vector<Stretch>> strokes, double period,
                                               const AliasedMotionOptions& options) {
  const auto channels = static_cast<int>(std::min(model.channel_names.size(), model.channel_source.size()));
  for (int rate = 0; rate < channels; ++rate)
    for (int level = 0; level < channels; ++level) {
      const std::string &v = model.channel_names[static_cast<std::size_t>(rate)],
                        &x = model.channel_names[static_cast<std::size_t>(level)];
      if (!Reads(machine, v) || !Reads(machine, x)) continue;
      const std::string of_level = SiUnitOf(machine, model, level);
      if (of_level.empty() || SiUnitOf(machine, model, rate) != of_level + "/s") continue;
      Pair pair(rate, level, period);
      for (const auto& stroke : strokes)
        for (const Stretch& stretch : stroke) pair.Add(stretch);
      if (pair.Frequency() > 0.5 / period && pair.DoNotBelongTogether(options))
        return AliasedMotion{v, x, pair.Frequency()};
    }
  return std::nullopt;
}

}  // namespace hydroscope
