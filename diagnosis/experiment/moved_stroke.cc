#include "diagnosis/experiment/moved_stroke.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hydroscope {
namespace {

/// Stretches that follow one another without a gap, as one series per channel.
struct Run {
  int before = 0, samples = 0, after = 0;
  std::vector<std::vector<double>> channel;
};

std::vector<Run> RunsOf(const StrokeStretches& stroke) {
  std::vector<Run> runs;
  for (const Stretch& stretch : stroke) {
    const bool continues = stretch.continues && !runs.empty();
    if (!continues) runs.push_back({stretch.before, 0, 0, {}});
    Run& run = runs.back();
    run.channel.resize(stretch.channel.size());
    for (std::size_t c = 0; c < stretch.channel.size(); ++c) {
      if (stretch.channel[c].empty()) continue;
      std::vector<double>& series = run.channel[c];
      const double* samples = stretch[static_cast<int>(c)];
      series.resize(series.size() - static_cast<std::size_t>(continues ? run.after : 0));
      series.insert(series.end(), samples + (continues ? 1 : -stretch.before),
                    samples + stretch.samples + stretch.after);
    }
    run.samples += stretch.samples - (continues ? 1 : 0);
    run.after = stretch.after;
  }
  return runs;
}

/// The run read at `speed` times the pace, its channels shifted.
Run Read(const Run& run, const StrokeMove& move, int measured) {
  const auto steps = [&](int samples) { return static_cast<int>(std::floor(samples / move.speed + 1e-9)); };
  Run out{steps(run.before), steps(run.samples - 1) + 1, 0, {}};
  out.after = steps(run.samples - 1 + run.after) - (out.samples - 1);
  const int count = out.before + out.samples + out.after;
  out.channel.assign(run.channel.size(), {});
  for (int c = 0; c < static_cast<int>(run.channel.size()); ++c) {
    const std::vector<double>& series = run.channel[c];
    if (series.empty()) continue;
    std::vector<double>& moved = out.channel[c];
    moved.assign(count, 0.0);
    if (c >= measured) continue;  // derived ones follow from those
    const auto shift = move.shift.find(c);
    const double offset = shift == move.shift.end() ? 0.0 : shift->second;
    for (int k = 0; k < count; ++k) {
      const double at =
          std::clamp(run.before + (k - out.before) * move.speed, 0.0, static_cast<double>(series.size() - 1));
      const auto low = static_cast<std::size_t>(at);
      const std::size_t high = std::min(low + 1, series.size() - 1);
      const double share = at - static_cast<double>(low);
      moved[k] = (1 - share) * series[low] + share * series[high] + offset;
    }
  }
  return out;
}

/// Whole blocks of the run, a span in each stretch, and `beyond` samples before and after it where known.
void Cut(const Run& run, double period, int beyond, const WindowSamples& window, StrokeStretches& out) {
  const int blocks = run.samples / window.block;
  for (int first = 0; first + window.min_span <= blocks; first += window.span) {
    const int lead = first > 0 ? 1 : 0, begin = first * window.block - lead;
    Stretch stretch;
    stretch.samples = std::min(window.span, blocks - first) * window.block + lead;
    stretch.period = period;
    stretch.continues = first > 0;
    stretch.before = std::min(beyond, run.before + begin);
    stretch.after = std::min(beyond, run.samples + run.after - begin - stretch.samples);
    for (const std::vector<double>& series : run.channel) {
      const auto from = series.begin() + (run.before + begin - stretch.before);
      stretch.channel.emplace_back();
      if (!series.empty())
        stretch.channel.back().assign(from, from + stretch.before + stretch.samples + stretch.after);
    }
    out.push_back(std::move(stretch));
  }
}

}  // namespace

StrokeStretches MovedStroke(const StrokeStretches& recorded, const StrokeMove& move, int measured,
                            const WindowSamples& window) {
  StrokeStretches out;
  int beyond = 0;
  for (const Stretch& stretch : recorded) beyond = std::max({beyond, stretch.before, stretch.after});
  for (const Run& run : RunsOf(recorded))
    Cut(Read(run, move, measured), recorded.front().period, beyond, window, out);
  return out;
}

double MeanOf(const StrokeStretches& stroke, int channel) {
  double sum = 0, count = 0;
  for (const Stretch& stretch : stroke) {
    sum = std::accumulate(stretch[channel], stretch[channel] + stretch.samples, sum);
    count += stretch.samples;
  }
  return count > 0 ? sum / count : 0.0;
}

double SpeedOf(const StrokeStretches& stroke, int channel, const WindowSamples& window) {
  double way = 0, time = 0;
  for (const Stretch& stretch : stroke) {
    const int m = std::min(window.block, stretch.samples / 2);
    if (m == 0) continue;
    const double* x = stretch[channel];
    const double first = std::accumulate(x, x + m, 0.0) / m;
    const double last = std::accumulate(x + stretch.samples - m, x + stretch.samples, 0.0) / m;
    way += std::abs(last - first);
    time += (stretch.samples - m) * stretch.period;
  }
  return time > 0 ? way / time : 0.0;
}

}  // namespace hydroscope
