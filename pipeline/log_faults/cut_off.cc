#include "pipeline/log_faults/cut_off.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "estimation/states/white_noise.h"
#include "models/output_unit.h"
#include "pipeline/log_faults/pressures_in_motion.h"

namespace hydroscope {
namespace {

/// Standard deviation of white noise, of readings that are all there.
double NoiseOf(const std::vector<double>& x) {
  WhiteNoiseVariance white;
  white.Add(Eigen::Map<const Eigen::VectorXd>(x.data(), std::ssize(x)), 1);
  return std::sqrt(white.Value());
}

bool AllThere(const std::vector<double>& x) {
  return std::ranges::all_of(x, [](double value) { return std::isfinite(value); });
}

}  // namespace

SaturatedPressures::SaturatedPressures(const Machine& machine, const SaturationOptions& options)
    : machine_(machine), options_(options) {
  const PressuresInMotion in_motion = PressuresInMotionOf(machine);
  position_ = in_motion.position;
  for (const std::size_t s : in_motion.pressures) tracks_.push_back({s, {}});
  last_.assign(1 + tracks_.size(), std::vector<double>(kRows));
}

void SaturatedPressures::Observe(const SampleBlock& block) {
  if (tracks_.empty()) return;
  for (std::size_t row = 0; row < block.rows(); ++row) {
    last_[0][filled_] = block.signal[position_][row];
    for (std::size_t t = 0; t < tracks_.size(); ++t)
      last_[t + 1][filled_] = block.signal[tracks_[t].signal][row];
    if (++filled_ == kRows) EndPiece();
  }
}

/// Keeps every second piece, so that memory stays bounded for any log.
void SaturatedPressures::Thin() {
  stride_ *= 2;
  for (Track& track : tracks_) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < track.pieces.size(); k += 2) track.pieces[kept++] = track.pieces[k];
    track.pieces.resize(kept);
  }
}

void SaturatedPressures::EndPiece() {
  filled_ = 0;
  if (ended_++ % stride_ != 0) return;
  if (tracks_.front().pieces.size() >= kMostPieces) Thin();
  const std::vector<double>& z = last_[0];
  const bool moves = AllThere(z) && std::abs(z.back() - z.front()) > options_.moves * NoiseOf(z);
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const std::vector<double>& p = last_[t + 1];
    if (!AllThere(p)) continue;
    const double noise = NoiseOf(p);
    const auto [low, high] = std::ranges::minmax_element(p);
    tracks_[t].pieces.push_back(
        {static_cast<float>(*low), static_cast<float>(*high), static_cast<float>(noise), moves});
  }
}

std::vector<CutOff> SaturatedPressures::Found() const {
  std::vector<CutOff> found;
  for (const Track& track : tracks_)
    for (CutOff& cut : Found(track)) found.push_back(std::move(cut));
  return found;
}

std::vector<CutOff> SaturatedPressures::Found(const Track& track) const {
  if (track.pieces.size() < 2 * options_.fewest) return {};
  float top = -INFINITY, bottom = INFINITY;
  for (const Piece& piece : track.pieces) {
    top = std::max(top, piece.high);
    bottom = std::min(bottom, piece.low);
  }
  std::vector<float> away;
  for (const Piece& piece : track.pieces)
    if (piece.moves && piece.high < top - options_.away * (top - bottom)) away.push_back(piece.noise);
  if (away.size() < options_.fewest) return {};
  std::ranges::nth_element(away, away.begin() + std::ssize(away) / 2);
  const float noise = away[away.size() / 2];

  std::size_t at = 0, quiet = 0, entries = 0;
  float from = top;
  bool was_noisy = false;
  for (const Piece& piece : track.pieces) {
    const bool is_at = piece.moves && piece.low > top - options_.band * noise;
    if (is_at) {
      ++at;
      if (piece.noise < options_.quiet * noise) {
        ++quiet;
        from = std::min(from, piece.low);
        entries += was_noisy;
        was_noisy = false;
      }
    } else if (piece.high < top - options_.band * noise) {
      was_noisy = piece.noise > options_.noisy * noise;
    }
  }
  if (quiet < options_.fewest || entries < options_.entries ||
      static_cast<double>(quiet) < options_.nearly_all * static_cast<double>(at))
    return {};
  const SignalSpec& spec = machine_.signals[track.signal];
  const DisplayUnit unit = ShownUnit(machine_, spec.name);
  return {
      {track.signal, true, from, true,
       Tell(
           "{} comes to {:.4g} {} time and again while the machine moves, goes no higher, and has next to no noise there: its "
           "sensor or amplifier is saturated. These readings are left out, so nothing is said of what the machine does beyond",
           "{} kommt immer wieder auf {:.4g} {}, während die Maschine sich bewegt, geht nicht höher und rauscht dort kaum: sein "
           "Sensor oder Verstärker ist gesättigt. Diese Messwerte bleiben weg, darüber hinaus ist also nichts gesagt",
           spec.name, top * unit.factor + unit.offset, std::string(unit.name))}};
}

std::vector<CutOff> CutOffsOf(const std::vector<ChannelQuality>& channels, const Machine& machine) {
  std::vector<CutOff> found;
  for (std::size_t signal = 0; signal < channels.size(); ++signal)
    for (const bool upper : {true, false}) {
      const ChannelQuality& channel = channels[signal];
      const double at = channel.cut_off[upper ? 0 : 1];
      if (std::isnan(at)) continue;
      const DisplayUnit unit = ShownUnit(machine, channel.name);
      found.push_back(
          {signal, upper, at, false,
           Tell(
               "{} never reads {} {:.4g} {}, where its noise is cut off: its sensor or converter ends there (saturation). These "
               "readings are left out, so nothing is said of what the machine does beyond",
               "{} zeigt nie {} {:.4g} {}, dort ist sein Rauschen abgeschnitten: sein Sensor oder Wandler endet dort (Sättigung). "
               "Diese Messwerte bleiben weg, über die Maschine jenseits davon ist damit nichts gesagt",
               channel.name, upper ? Wording("above", "mehr als") : Wording("below", "weniger als"),
               at * unit.factor + unit.offset, std::string(unit.name))});
    }
  return found;
}

Machine Within(Machine machine, std::span<const CutOff> cut_offs) {
  for (const CutOff& cut : cut_offs) {
    SignalSpec& spec = machine.signals[cut.signal];
    if (cut.upper)
      spec.max = std::min(spec.max.value_or(kInfinity), std::nextafter(cut.from, -kInfinity));
    else
      spec.min = std::max(spec.min.value_or(-kInfinity), std::nextafter(cut.from, kInfinity));
  }
  return machine;
}

}  // namespace hydroscope
