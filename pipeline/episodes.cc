#include "pipeline/episodes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "models/episode_marker.h"
#include "models/state_model.h"
#include "pipeline/batch_fit.h"
#include "pipeline/raw_log.h"

namespace hydroscope {
namespace {

constexpr int kLeastRows = 10;  ///< of an episode
/// Flags of the row's time: it does not follow the row before.
constexpr Quality kTimeBreaks =
    quality::kGap | quality::kTimeBackwards | quality::kClockJump | quality::kDuplicate | quality::kLate;
/// Single readings that stand out are faults as long as they are rare; near its own dynamics a signal is full of them.
constexpr double kRareSpikes = 0.002;
/// Rows over which a reading must repeat before it is called stuck, however short the machine file's time.
constexpr double kStuckRows = 20;

/// All rows of one log with their flags.
struct Rows {
  std::vector<double> time;
  std::vector<std::vector<double>> signal;
  std::vector<std::vector<Quality>> quality;
};

class Cutter {
 public:
  Cutter(const StateModel& model, const Rows& rows, int log, EpisodeLog& out)
      : model_(model), rows_(rows), log_(log), out_(out), marker_(model.machine) {}

  Status Run() {
    if (const Status fine = ReadGate(); !fine) return fine;
    ForgiveFlags();
    const std::size_t count = rows_.time.size();
    std::size_t first = 0;
    double outside = 0;
    for (std::size_t row = 0; row < count; ++row) {
      const bool breaks = row > 0 && BreaksTime(row);
      if (const bool marked = marker_.Changes(rows_.signal, row); breaks || marked) {
        Take(first, row);
        first = row;
      }
      if (breaks) Tell(row);
      const bool inside = InputsGood(row) && InGate(row, outside);
      if (inside) continue;
      Take(first, row);
      first = row + 1;
    }
    Take(first, count);
    return {};
  }

 private:
  Status ReadGate() {
    for (const GateBound& bound : model_.machine.gate.bounds)
      if (bound.rate)
        return BadInput(
            "machine '{}': [gate] ddt({}) has no place in a model with states; write a condition on a signal",
            model_.machine.name, bound.signal);
    return {};
  }
  bool InGate(std::size_t row, double& outside) const {
    const GateSpec& gate = model_.machine.gate;
    const bool holds = std::all_of(gate.bounds.begin(), gate.bounds.end(), [&](const GateBound& b) {
      const int signal = model_.machine.SignalIndex(b.signal);
      double x = rows_.signal[static_cast<std::size_t>(signal)][row];
      if (b.magnitude) x = std::abs(x);
      return (!b.min || x >= *b.min) && (!b.max || x <= *b.max);
    });
    outside = holds ? 0 : outside + out_.period;
    return holds || (outside > 0 && outside < gate.stroke_gap && row > 0);
  }
  void ForgiveFlags() {
    forgiven_.assign(rows_.signal.size(), kTimeBreaks);
    for (std::size_t s = 0; s < rows_.signal.size(); ++s) {
      const bool input =
          std::find(model_.inputs.begin(), model_.inputs.end(), static_cast<int>(s)) != model_.inputs.end();
      const auto& flags = rows_.quality[s];
      const auto spikes =
          std::count_if(flags.begin(), flags.end(), [](Quality q) { return (q & quality::kSpike) != 0; });
      if (input || static_cast<double>(spikes) > kRareSpikes * static_cast<double>(flags.size()))
        forgiven_[s] |= quality::kSpike;
      if (input || model_.machine.signals[s].stuck_time < kStuckRows * out_.period)
        forgiven_[s] |= quality::kStuck;
    }
  }
  bool Good(std::size_t signal, std::size_t row) const {
    return (rows_.quality[signal][row] & ~forgiven_[signal]) == 0 && std::isfinite(rows_.signal[signal][row]);
  }
  bool InputsGood(std::size_t row) const {
    return std::all_of(model_.inputs.begin(), model_.inputs.end(),
                       [&](int s) { return Good(static_cast<std::size_t>(s), row); });
  }
  bool BreaksTime(std::size_t row) const {
    if (!(rows_.time[row] > rows_.time[row - 1])) return true;
    return std::any_of(rows_.quality.begin(), rows_.quality.end(),
                       [&](const auto& flags) { return (flags[row] & kTimeBreaks) != 0; });
  }
  void Tell(std::size_t row) {
    const double step = rows_.time[row] - rows_.time[row - 1];
    out_.warnings.push_back(
        fmt::format("the clock steps by {:.4g} s at row {} ({:.6g} s): a new episode begins there", step,
                    row + 1, rows_.time[row]));
  }

  void Take(std::size_t first, std::size_t end) {
    // An episode begins where all outputs are there, since initial values may be read from them.
    while (first < end && !std::all_of(model_.outputs.begin(), model_.outputs.end(),
                                       [&](int s) { return Good(static_cast<std::size_t>(s), first); }))
      ++first;
    const std::size_t rows = end - first;
    if (first >= end || rows < kLeastRows) return;
    const double seconds = rows_.time[end - 1] - rows_.time[first];
    if (!model_.machine.gate.bounds.empty() && seconds < model_.machine.gate.min_stroke) return;
    const auto wanted = model_.machine.states.episode_seconds;
    const std::size_t parts =
        wanted ? std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(seconds / *wanted))) : 1;
    for (std::size_t k = 0; k < parts; ++k)
      TakeRows(first + rows * k / parts, first + rows * (k + 1) / parts);
  }
  void TakeRows(std::size_t first, std::size_t end) {
    if (end < first + kLeastRows) return;
    Episode episode;
    episode.log = log_;
    episode.first_row = static_cast<std::int64_t>(first);
    episode.time.assign(rows_.time.begin() + static_cast<std::ptrdiff_t>(first),
                        rows_.time.begin() + static_cast<std::ptrdiff_t>(end));
    episode.signal.resize(static_cast<Eigen::Index>(end - first),
                          static_cast<Eigen::Index>(rows_.signal.size()));
    for (std::size_t s = 0; s < rows_.signal.size(); ++s)
      for (std::size_t row = first; row < end; ++row)
        episode.signal(static_cast<Eigen::Index>(row - first), static_cast<Eigen::Index>(s)) =
            Good(s, row) ? rows_.signal[s][row] : NAN;
    out_.used += static_cast<std::int64_t>(end - first);
    out_.episodes.push_back(std::move(episode));
  }

  const StateModel& model_;
  const Rows& rows_;
  int log_;
  EpisodeLog& out_;
  EpisodeMarker marker_;
  std::vector<Quality> forgiven_;
};

Result<Rows> ReadRows(const std::string& log, const Machine& machine, EpisodeLog& out) {
  auto reader = OpenRecording(log, machine);
  if (!reader) return tl::unexpected(reader.error());
  Rows rows;
  rows.signal.resize(machine.signals.size());
  rows.quality.resize(machine.signals.size());
  LogPassHooks hooks;
  hooks.observe = [&](const SampleBlock& block) {
    if (static_cast<std::int64_t>(rows.time.size()) >= kMaxKeptSamples) return;
    rows.time.insert(rows.time.end(), block.time.begin(), block.time.end());
    for (std::size_t s = 0; s < rows.signal.size(); ++s) {
      rows.signal[s].insert(rows.signal[s].end(), block.signal[s].begin(), block.signal[s].end());
      rows.quality[s].insert(rows.quality[s].end(), block.quality[s].begin(), block.quality[s].end());
    }
  };
  auto pass = PassLog(**reader, machine, nullptr, "reading", hooks);
  if (!pass) return tl::unexpected(pass.error());
  if (!pass->summary.stopped.empty()) return BadInput("{}", pass->summary.stopped);
  out.period = (*reader)->SamplePeriod();
  out.rows += static_cast<std::int64_t>(rows.time.size());
  out.pass = std::move(*pass);
  return rows;
}

}  // namespace

double EpisodeLog::Seconds() const {
  return std::accumulate(episodes.begin(), episodes.end(), 0.0,
                         [](double sum, const Episode& e) { return sum + e.time.back() - e.time.front(); });
}

Result<EpisodeLog> ReadEpisodes(const std::vector<std::string>& logs, const Machine& machine) {
  const auto model = BuildStateModel(machine, machine.added_effects);
  if (!model) return tl::unexpected(model.error());
  EpisodeLog out;
  out.machine = machine;
  for (const std::string& log : logs) {
    const auto rows = ReadRows(log, machine, out);
    if (!rows) return tl::unexpected(rows.error());
    Cutter cutter(**model, *rows, static_cast<int>(&log - logs.data()), out);
    if (const Status cut = cutter.Run(); !cut) return tl::unexpected(cut.error());
  }
  if (out.episodes.empty())
    return BadInput(
        "{}: no episode of {} rows in which all inputs are good readings{}; 'hydroscope "
        "check' says what is wrong with the signals",
        logs.front(), kLeastRows, machine.gate.bounds.empty() ? "" : " and [gate] holds");
  return out;
}

}  // namespace hydroscope
