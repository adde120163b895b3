#include "pipeline/episode_cutter.h"

#include <algorithm>
#include <cmath>

#include "core/told_error.h"
#include "models/closed_loop.h"
#include "pipeline/shaft_rows.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMostWarnings = 10;
/// Flags of the row's time: it does not follow the row before.
constexpr Quality kTimeBreaks =
    quality::kGap | quality::kTimeBackwards | quality::kClockJump | quality::kDuplicate | quality::kLate;
/// Single readings that stand out are faults as long as they are rare; near its own dynamics a signal is full of them.
constexpr double kRareSpikes = 0.002;
/// Rows over which a reading must repeat before it is called stuck, however short the machine file's time.
constexpr double kStuckRows = 20;

bool GoodReading(double value, Quality flags, Quality forgiven) {
  return (flags & ~forgiven) == 0 && std::isfinite(value);
}

}  // namespace

void EpisodeCutter::Rows::Clear() {
  time.clear();
  for (auto& s : signal) s.clear();
  for (auto& q : quality) q.clear();
}

Status EpisodeCutter::Check(const Machine& machine) {
  for (const GateBound& bound : machine.gate.bounds)
    if (bound.rate)
      return BadInput(Tell(
          "machine '{}': [gate] ddt({}) has no place where rows are judged in episodes; write a condition on a signal",
          "Maschine '{}': [gate] ddt({}) hat keinen Platz, wo Zeilen in Episoden beurteilt werden; eine Bedingung für "
          "ein Signal schreiben",
          machine.name, bound.signal));
  return {};
}

EpisodeCutter::EpisodeCutter(const Machine& machine, EpisodeSignals of, const Options& options, Sink sink)
    : machine_(machine),
      signals_(std::move(of)),
      options_(options),
      sink_(std::move(sink)),
      marker_(machine) {
  const std::size_t signals = machine.signals.size();
  rows_.signal.resize(signals);
  rows_.quality.resize(signals);
  input_.assign(signals, false);
  for (const int s : signals_.inputs) input_[s] = true;
  if (ClosedLoopOf(machine) != nullptr) driven_ = SignalsOfLoop(machine).back();
  shaft_ = machine.SignalIndex(machine.states.shaft);
  if (shaft_ >= 0) input_[shaft_] = true;
}

bool EpisodeCutter::JudgesStuck(const SignalSpec& signal, double period) {
  return signal.stuck_time >= kStuckRows * period;
}

void EpisodeCutter::ForgiveSpikes(const std::vector<double>& share) { spikes_ = share; }

bool EpisodeCutter::InGate(const SampleBlock& block, std::size_t row) {
  const GateSpec& gate = machine_.gate;
  const bool holds = std::ranges::all_of(gate.bounds, [&](const GateBound& b) {
    double x = block.signal[machine_.SignalIndex(b.signal)][row];
    if (b.magnitude) x = std::abs(x);
    return (!b.min || x >= *b.min) && (!b.max || x <= *b.max);
  });
  outside_ = holds ? 0 : outside_ + options_.period;
  return holds || (outside_ > 0 && outside_ < gate.stroke_gap && row_ > 0);
}

bool EpisodeCutter::InputsGood(const SampleBlock& block, std::size_t row) const {
  constexpr Quality kForgiven = kTimeBreaks | kFineOnInputs;
  for (std::size_t s = 0; s < input_.size(); ++s) {
    const Quality forgiven = static_cast<int>(s) == driven_ ? kForgiven & ~quality::kStuck : kForgiven;
    if (input_[s] && !GoodReading(block.signal[s][row], block.quality[s][row], forgiven)) return false;
  }
  return true;
}

bool EpisodeCutter::BreaksTime(const SampleBlock& block, std::size_t row) const {
  if (!last_time_) return false;
  if (!(block.time[row] > *last_time_)) return true;
  return std::ranges::any_of(block.quality,
                             [&](const auto& flags) { return (flags[row] & kTimeBreaks) != 0; });
}

void EpisodeCutter::Process(const SampleBlock& block) {
  for (std::size_t row = 0; row < block.rows(); ++row) TakeRow(block, row);
}

void EpisodeCutter::TakeRow(const SampleBlock& block, std::size_t row) {
  const bool breaks = BreaksTime(block, row);
  if (const bool marked = marker_.Changes(block.signal, row); breaks || marked) End();
  if (breaks && warnings_.size() < kMostWarnings)
    warnings_.push_back(
        Tell("the clock steps by {:.4g} s at row {} ({:.6g} s): a new episode begins there",
             "die Uhr springt um {:.4g} s in Zeile {} ({:.6g} s): dort beginnt eine neue Episode",
             block.time[row] - *last_time_, row_ + 1, block.time[row]));
  last_time_ = block.time[row];
  for (StrokeCounters* c : {&totals_, &present_}) ++c->samples;
  for (const auto& flags : block.quality)
    for (std::size_t bit = 0; bit < present_.flagged.size(); ++bit)
      if ((flags[row] >> bit & 1) != 0) ++present_.flagged[bit];
  const bool inside = InputsGood(block, row) && InGate(block, row);
  if (inside) {
    if (rows_.size() == 0) rows_.first = row_;
    for (StrokeCounters* c : {&totals_, &present_}) ++c->gated;
    rows_.time.push_back(block.time[row]);
    for (std::size_t s = 0; s < rows_.signal.size(); ++s) {
      rows_.signal[s].push_back(block.signal[s][row]);
      rows_.quality[s].push_back(block.quality[s][row]);
    }
  }
  ++row_;
  const auto wanted = machine_.states.episode_seconds;
  const bool full = !options_.whole && rows_.size() > 0 &&
                    ((wanted && static_cast<double>(rows_.size()) * options_.period >= *wanted) ||
                     static_cast<std::int64_t>(rows_.size()) >= options_.most_rows);
  if (!inside || full) End();
}

void EpisodeCutter::Finish() { End(); }

/// Flags of a signal that are no faults.
Quality EpisodeCutter::Forgiven(std::size_t signal) const {
  const auto& flags = rows_.quality[signal];
  const auto spikes = std::ranges::count_if(flags, [](Quality q) { return (q & quality::kSpike) != 0; });
  const double share =
      spikes_.empty() ? static_cast<double>(spikes) / static_cast<double>(flags.size()) : spikes_[signal];
  Quality forgiven = kTimeBreaks;
  if (input_[signal]) forgiven |= kFineOnInputs;
  if (share > kRareSpikes) forgiven |= quality::kSpike;
  if (!JudgesStuck(machine_.signals[signal], options_.period)) forgiven |= quality::kStuck;
  return forgiven;
}

/// The rows kept are a piece without a break.
void EpisodeCutter::End() {
  if (rows_.size() == 0) return;
  std::vector<Quality> forgiven;
  for (std::size_t s = 0; s < rows_.signal.size(); ++s) forgiven.push_back(Forgiven(s));
  // An episode begins where all outputs are there, since initial values may be read from them.
  std::size_t first = 0;
  const std::size_t end = rows_.size();
  while (first < end && !std::ranges::all_of(signals_.outputs, [&](int s) {
           const auto at = static_cast<std::size_t>(s);
           return GoodReading(rows_.signal[at][first], rows_.quality[at][first], forgiven[at]);
         }))
    ++first;
  const double seconds = first < end ? rows_.time[end - 1] - rows_.time[first] : 0;
  if (end - first < kLeastRows || (!machine_.gate.bounds.empty() && seconds < machine_.gate.min_stroke)) {
    ++discarded_;
    rows_.Clear();
    return;
  }
  const auto wanted = machine_.states.episode_seconds;
  const std::size_t rows = end - first,
                    parts = wanted && options_.whole
                                ? std::max<std::size_t>(
                                      1, static_cast<std::size_t>(std::lround(seconds / *wanted)))
                                : 1;
  for (std::size_t k = 0; k < parts; ++k)
    Emit(first + rows * k / parts, first + rows * (k + 1) / parts, forgiven);
  rows_.Clear();
}

/// False if the shaft stood still for most of it.
bool EpisodeCutter::AtAngles(Episode& episode) {
  const double rows = RowsPerRevolution(episode, shaft_);
  if (rows > 0 && rows < kLeastRowsPerRevolution) {
    if (warnings_.size() < kMostWarnings)
      warnings_.push_back(Tell(
          "{:.3g} rows per revolution of the shaft at {:.6g} s, {} are needed to take its ripple out: it is left in",
          "{:.3g} Zeilen je Umdrehung der Welle bei {:.6g} s, {} sind nötig, um ihre Welligkeit "
          "herauszunehmen: sie bleibt darin",
          rows, episode.time.front(), kLeastRowsPerRevolution));
    return true;
  }
  episode = AtShaftAngles(episode, shaft_, signals_.outputs, machine_.log.hold);
  return episode.rows() >= static_cast<int>(kLeastRows);
}

void EpisodeCutter::Emit(std::size_t first, std::size_t end, const std::vector<Quality>& forgiven) {
  if (end < first + kLeastRows) return;
  Episode episode;
  episode.log = options_.log;
  episode.first_row = rows_.first + static_cast<std::int64_t>(first);
  episode.time.assign(rows_.time.begin() + first, rows_.time.begin() + end);
  episode.signal.resize(static_cast<Eigen::Index>(end - first),
                        static_cast<Eigen::Index>(rows_.signal.size()));
  for (std::size_t s = 0; s < rows_.signal.size(); ++s)
    for (std::size_t row = first; row < end; ++row)
      episode.signal(static_cast<Eigen::Index>(row - first), static_cast<Eigen::Index>(s)) =
          GoodReading(rows_.signal[s][row], rows_.quality[s][row], forgiven[s]) ? rows_.signal[s][row] : NAN;
  if (shaft_ >= 0 && !AtAngles(episode)) {
    ++discarded_;
    return;
  }
  const auto used = static_cast<std::int64_t>(end - first);
  totals_.used += used;
  present_.used = used;
  sink_(std::move(episode), present_);
  present_ = {};
}

}  // namespace hydroscope
