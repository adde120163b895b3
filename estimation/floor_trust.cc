#include "estimation/floor_trust.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "core/units.h"

namespace hydroscope {
namespace {

constexpr double kUnstated = std::numeric_limits<double>::quiet_NaN();
/// Stretches whose equations tell the shares: a few per cent are enough.
constexpr std::size_t kStretchesTried = 12;

/// Independent numbers of mean 0 and variance 1, the same every time: what a share is, no seed should decide.
class Signs {
 public:
  double Next() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return (state_ >> 63) != 0 ? 1.0 : -1.0;
  }

 private:
  std::uint64_t state_ = 20;
};

std::shared_ptr<const ModelStructure> BaseAlone(const ModelStructure& model) {
  auto base = std::make_shared<ModelStructure>(model);
  base->columns.resize(static_cast<std::size_t>(model.base_count) + 1);
  base->effects.clear();
  base->effect_shapes.clear();
  return base;
}

std::vector<const Stretch*> SomeStretches(std::span<const std::vector<Stretch>> strokes, int least) {
  std::vector<const Stretch*> all;
  for (const auto& stroke : strokes)
    for (const Stretch& stretch : stroke)
      if (stretch.samples >= least) all.push_back(&stretch);
  if (all.size() <= kStretchesTried) return all;
  std::vector<const Stretch*> some;
  for (std::size_t k = 0; k < kStretchesTried; ++k) some.push_back(all[k * all.size() / kStretchesTried]);
  return some;
}

/// Of a stretch taken by itself: what the floor counts as noise (contrasts of blocks, steps of the walk), and its equations.
struct CountedNoise {
  Eigen::RowVectorXd white, walk, equations;
};

CountedNoise NoiseOf(const std::shared_ptr<const ModelStructure>& base, const WindowSamples& window,
                     const Eigen::VectorXd& weights, Stretch stretch) {
  stretch.continues = false;
  SpanEquationBuilder builder(base, window);
  const SpanEquations& equations = builder.Build(stretch, 0);
  return {weights.transpose() * equations.noise.leftCols(equations.blocks),
          weights.transpose() * equations.walk,
          weights.transpose() * equations.integral.leftCols(equations.equations)};
}

/// The same with white noise of standard deviation `std` on a channel.
CountedNoise WithNoise(const std::shared_ptr<const ModelStructure>& base, const WindowSamples& window,
                       const Eigen::VectorXd& weights, Stretch stretch, std::size_t channel, double std,
                       Signs& signs) {
  for (double& x : stretch.channel[channel]) x += std * signs.Next();
  return NoiseOf(base, window, weights, std::move(stretch));
}

std::vector<int> MeasuredChannels(const ModelStructure& model) {
  std::vector<int> channels;
  for (std::size_t c = 0; c < model.channel_source.size(); ++c)
    if (model.channel_source[c] >= 0) channels.push_back(static_cast<int>(c));
  return channels;
}

/// Readings of a channel, stretches that continue one another put together.
SignalRuns RunsOf(const std::vector<Stretch>& stroke, int channel) {
  SignalRuns runs;
  for (const Stretch& stretch : stroke) {
    const double* x = stretch[channel];
    const int first = stretch.continues && !runs.empty() ? 1 : 0;
    if (first == 0) runs.emplace_back();
    runs.back().insert(runs.back().end(), x + first, x + stretch.samples);
  }
  return runs;
}

std::string UnitOf(const SignalSpec& spec) {
  const auto unit = FindUnit(spec.unit);
  return unit ? std::string(unit->si) : std::string();
}

/// Energy of a signal's readings over that of their contrasts, as far as it is known; NaN if not.
double KnownScaleOfReadings(const SignalNoise& noise) {
  const double contrast = noise.std * noise.std;
  switch (noise.kind) {
    case NoiseKind::kUnknown:
    case NoiseKind::kWhite:
    case NoiseKind::kDisagreesWithStated:  // the readings themselves show their noise
      return 1;
    case NoiseKind::kSignalInContrast:
      if (std::isfinite(noise.stated)) return noise.stated * noise.stated / contrast;
      return noise.seen_at_rest ? noise.quiet_std * noise.quiet_std / contrast : kUnstated;
    case NoiseKind::kColoured:
    case NoiseKind::kInterpolated:
    case NoiseKind::kHeld:
      return std::isfinite(noise.slow_ratio) ? std::max(noise.ratio, noise.slow_ratio) : noise.ratio;
    case NoiseKind::kQuantised:
    case NoiseKind::kRepeats:
      return std::isfinite(noise.stated) ? noise.stated * noise.stated / contrast : kUnstated;
  }
  return kUnstated;
}

/// The same of its noise in the balance.
double KnownScale(const SignalNoise& noise) { return noise.unseen * KnownScaleOfReadings(noise); }

/// Readings that no sensor gave in their rows.
bool AreMadeUp(const SignalNoise& noise) {
  return noise.kind == NoiseKind::kInterpolated || noise.kind == NoiseKind::kHeld;
}

/// Whether KnownScale is the statement of the machine file. What is stated of filtered noise says nothing of
/// how much of it a block sees, nor does what is stated of noise that the balance filters.
bool FromStatement(const SignalNoise& noise) {
  return noise.unseen == 1 && noise.kind != NoiseKind::kColoured && !AreMadeUp(noise) &&
         std::isfinite(noise.stated);
}

/// By how much the signal may change the noise energy of the balance, as a share of it.
double Leverage(const SignalNoise& noise) {
  const double scale = KnownScale(noise);
  return noise.share * (std::isfinite(scale) ? std::abs(scale - 1) : 1.0);
}

/// `as_noise`: shares if all that is slower than the rows were noise.
void DoubtMotion(double floor_excess, const SignalNoise& noise, double as_noise, FloorTrust& trust) {
  SignalNoise all = noise;
  all.share = as_noise;
  const bool stronger = noise.kind == NoiseKind::kColoured && noise.ratio > 1;
  if (stronger && Leverage(all) > floor_excess && Leverage(noise) <= floor_excess)
    trust.may_be_noise = noise.sentence;
}

void Conclude(double floor_excess, FloorTrust& trust) {
  double scale = 0, shares = 0;
  trust.stated = trust.only_moves = true;
  for (const SignalNoise& noise : trust.signals) {
    const bool counts = Leverage(noise) > floor_excess;
    scale += noise.share * (counts ? KnownScale(noise) : 1);
    shares += noise.share;
    if (noise.kind == NoiseKind::kDisagreesWithStated && noise.share > floor_excess)
      trust.sentences.push_back(noise.sentence);
    if (!counts) {
      if (AreMadeUp(noise)) trust.sentences.push_back(noise.sentence);
      continue;
    }
    if (trust.believable) trust.why = "the noise floor is not used: " + noise.sentence.english;
    trust.believable = false;
    trust.stated = trust.stated && FromStatement(noise);
    trust.only_moves = trust.only_moves && noise.kind == NoiseKind::kSignalInContrast;
    trust.sentences.push_back(noise.sentence);
  }
  trust.stated = trust.stated && !trust.believable;
  trust.only_moves = trust.only_moves && !trust.believable;
  if (!trust.believable) trust.noise_scale = shares > 0 ? scale / shares : kUnstated;
}

/// Of each channel: its share of what the floor counts, and SignalNoise::unseen.
struct NoiseShares {
  std::vector<double> share, unseen;
};

/// Shares of channels whose readings scatter by `std`. What is integrated counts for its part `white_std` alone: what is slower
/// than the rows may be motion, of a spool say, which is no noise.
NoiseShares SharesOf(const ModelStructure& model, std::span<const std::vector<Stretch>> strokes,
                     const WindowSamples& window, const Eigen::VectorXd& theta, std::span<const double> std,
                     std::span<const double> white_std, double unseen_ratio) {
  const auto base = BaseAlone(model);
  Eigen::VectorXd weights(model.base_count + 1);
  weights << theta.head(model.base_count), -1.0;
  std::vector<double> energy(std.size(), 0.0), in_equations = energy;
  Signs signs;
  for (const Stretch* stretch : SomeStretches(strokes, 2 * window.block)) {
    const CountedNoise measured = NoiseOf(base, window, weights, *stretch);
    for (std::size_t c = 0; c < std.size(); ++c) {
      if (!(std[c] > 0)) continue;
      Signs same = signs;
      const CountedNoise more = WithNoise(base, window, weights, *stretch, c, std[c], signs);
      const CountedNoise integrated =
          white_std[c] == std[c] ? more : WithNoise(base, window, weights, *stretch, c, white_std[c], same);
      const double white = (more.white - measured.white).squaredNorm();
      const double walk = std::max(0.0, integrated.walk.squaredNorm() - measured.walk.squaredNorm());
      if (!std::isfinite(white + walk)) continue;
      energy[c] += white + walk;
      in_equations[c] += (more.equations - measured.equations).squaredNorm();
    }
  }
  NoiseShares out{energy, std::vector<double>(std.size(), 1.0)};
  for (std::size_t c = 0; c < std.size(); ++c)
    if (in_equations[c] > unseen_ratio * energy[c] && energy[c] > 0)
      out.unseen[c] = in_equations[c] / energy[c];
  const double total = std::accumulate(energy.begin(), energy.end(), 0.0);
  if (total > 0)
    for (double& e : out.share) e /= total;
  return out;
}

/// That the balance reads the noise of a signal where no contrast shows it.
void TellUnseen(SignalNoise& noise) {
  if (noise.unseen == 1 || !noise.sentence.empty()) return;
  noise.sentence = Tell(
      "noise of {} enters the balance through the window of a rate, which hides it from row to row: "
      "there is about {:.2g} times what rows show",
      "Rauschen von {} geht durch das Fenster einer Änderungsrate in die Bilanz ein, das es von Zeile zu "
      "Zeile verbirgt: es ist etwa das {:.2g}-fache dessen, was Zeilen zeigen",
      noise.name, noise.unseen);
}

/// Of the readings' scatter what passes for white: energy over pairs of rows less than twice that over rows (WhitePartVariance).
double WhiteStd(const SignalNoise& noise) {
  if (!std::isfinite(noise.ratio)) return noise.std;
  return noise.std * std::sqrt(std::clamp(2 - noise.ratio, 0.0, 1.0));
}

}  // namespace

FloorTrust JudgeFloor(const ModelStructure& model, std::span<const std::vector<Stretch>> strokes,
                      const WindowSamples& window, const Eigen::VectorXd& theta, const Machine& machine,
                      const FloorTrustOptions& options) {
  FloorTrust trust;
  const std::vector<int> channels = MeasuredChannels(model);
  std::vector<double> std(model.channel_source.size(), 0.0), white = std;
  std::vector<SignalNoise> judged;
  for (const int channel : channels) {
    const SignalSpec& spec = machine.signals[model.channel_source[channel]];
    std::vector<SignalRuns> runs;
    for (const auto& stroke : strokes) runs.push_back(RunsOf(stroke, channel));
    judged.push_back(JudgeSignalNoise(spec.name, UnitOf(spec), runs, window.period,
                                      spec.noise_std.value_or(kUnstated), options.signal));
    std[channel] = judged.back().std;
    white[channel] = WhiteStd(judged.back());
  }
  const NoiseShares shares = SharesOf(model, strokes, window, theta, std, white, options.unseen_ratio);
  const NoiseShares as_noise = SharesOf(model, strokes, window, theta, std, std, options.unseen_ratio);
  for (std::size_t k = 0; k < judged.size(); ++k) {
    judged[k].share = shares.share[channels[k]];
    judged[k].unseen = as_noise.unseen[channels[k]];
    TellUnseen(judged[k]);
    DoubtMotion(options.floor_excess, judged[k], as_noise.share[channels[k]], trust);
    if (judged[k].share > 0) trust.signals.push_back(std::move(judged[k]));
  }
  std::ranges::stable_sort(trust.signals,
                           [](const SignalNoise& a, const SignalNoise& b) { return a.share > b.share; });
  Conclude(options.floor_excess, trust);
  if (!trust.believable) trust.may_be_noise = {};
  return trust;
}

}  // namespace hydroscope
