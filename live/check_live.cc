#include "live/check_live.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "acquisition/quality_monitor.h"
#include "core/constants.h"
#include "core/printable.h"
#include "core/short_number.h"
#include "core/shown_width.h"
#include "core/units.h"
#include "live/inbox.h"
#include "models/doubled_signals.h"
#include "models/source_kind.h"
#include "pipeline/log_faults/command_answer.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kInboxValues = 4'000'000;

/// Where `check --live` looks twice. Hints for whoever wires a machine up, no verdicts: wide on purpose.
struct HintLimits {
  double rate_off = 0.1;                   ///< of the rate that is expected
  double silent = 0.5, silent_values = 3;  ///< s since the last value at least, and values that did not come
  double flagged = 0.1;                    ///< of the values
  double coldest = 250, warmest = 400;     ///< K: kelvins and degrees are taken for one another
  double least_peak = 1e4, most_peak = 1e8;  ///< Pa: bars and pascals are taken for one another
};
constexpr HintLimits kHints{};

/// Sums over the good values of one channel.
struct Range {
  double min = kNaN, max = kNaN, sum = 0;
  std::int64_t count = 0;

  void Add(double value) {
    min = std::fmin(min, value);
    max = std::fmax(max, value);
    sum += value;
    ++count;
  }
};

std::string Shown(double value, const std::string& si) {
  if (!std::isfinite(value)) return "-";
  const DisplayUnit unit = DisplayUnitFor(si);
  return ShortNumber(value * unit.factor + unit.offset, 4);
}

void AddHints(const SignalSpec& spec, const Machine& machine, std::int64_t rows, CheckedChannel& channel) {
  const Delivery delivery = DeliveryOf(machine, spec);
  const double wanted = 1 / (delivery.streamed ? machine.live->grid_period : delivery.period);
  if (!std::isfinite(channel.age)) {
    channel.hints.push_back(fmt::format("nothing came: {}", FindSourceKind(spec.origin->part())->silent));
    return;
  }
  if (channel.rate < (1 - kHints.rate_off) * wanted || channel.rate > (1 + kHints.rate_off) * wanted)
    channel.hints.push_back(fmt::format("{:.0f} values/s, expected {:.0f}: check grid_period or poll_period",
                                        channel.rate, wanted));
  if (channel.age > std::max(kHints.silent, kHints.silent_values / wanted))
    channel.hints.push_back(
        fmt::format("the last value is {:.1f} s old: the sender went silent", channel.age));
  if (static_cast<double>(channel.flagged) > kHints.flagged * static_cast<double>(rows))
    channel.hints.push_back(fmt::format(
        "{:.0f} % of its values are flagged: check unit, scale, min and max",
        100.0 * static_cast<double>(channel.flagged) / static_cast<double>(std::max<std::int64_t>(1, rows))));
  if (delivery.streamed && channel.min == channel.max)
    channel.hints.push_back(
        "it never changed: a dead sensor, a wrong register, or the machine is switched off");
  const std::string si(channel.unit);
  if (si == "K" && (channel.mean < kHints.coldest || channel.mean > kHints.warmest))
    channel.hints.push_back(fmt::format("an oil temperature of {:.0f} degC is not likely: check the unit",
                                        channel.mean - kZeroCelsius));
  if (si == "Pa" && channel.max > kHints.most_peak)
    channel.hints.push_back(
        fmt::format("{:.0f} bar is beyond hydraulics: check the unit", channel.max * 1e-5));
  if (si == "Pa" && delivery.streamed && channel.max < kHints.least_peak && channel.max > 0)
    channel.hints.push_back("it stays below 0.1 bar: check the unit");
}

}  // namespace

bool LiveCheck::Clean() const {
  return std::all_of(channels.begin(), channels.end(),
                     [](const CheckedChannel& c) { return c.hints.empty(); });
}

Result<LiveCheck> CheckLive(const Machine& machine, double seconds, const LiveService::SourceFactory& factory,
                            const Clock& clock) {
  const HostTime start = clock();
  Aligner aligner(machine, AlignerOptions::For(machine), start);
  Inbox inbox(kInboxValues);
  const int axes = AxisCount(machine);
  const std::size_t signals = machine.signals.size();
  std::vector<QualityMonitor> monitors;
  for (int a = 0; a < axes; ++a) monitors.emplace_back(machine, machine.live->grid_period);
  std::vector<CommandAnswers> answers(static_cast<std::size_t>(axes), CommandAnswers(machine));
  std::vector<Range> ranges(static_cast<std::size_t>(axes) * signals);
  auto sources = factory(machine, clock);
  for (std::size_t i = 0; i < sources.size(); ++i)
    TRY(sources[i]->Start(
        [&inbox, i](SampleBatch&& batch) { inbox.Push(static_cast<int>(i), std::move(batch)); }));
  HostTime now = start;
  std::vector<std::int64_t> first(ranges.size());  // ns, first batch of each channel: rates count from there
  SampleBlock block;
  while (static_cast<double>(now.monotonic_ns - start.monotonic_ns) * 1e-9 < seconds) {
    now = clock();
    for (const Inbox::Entry& entry : inbox.TakeAll(0.01)) {
      for (const std::uint16_t channel : entry.batch.channels)
        if (channel < first.size() && first[channel] == 0) first[channel] = entry.batch.received.monotonic_ns;
      aligner.Add(entry.source, entry.batch);
    }
    aligner.Advance(now.monotonic_ns);
    for (int a = 0; a < axes; ++a)
      while (aligner.Take(a, block)) {
        monitors[static_cast<std::size_t>(a)].Inspect(block);
        answers[static_cast<std::size_t>(a)].Observe(block);
        for (std::size_t s = 0; s < signals; ++s)
          for (std::size_t k = 0; k < block.rows(); ++k)
            if (block.quality[s][k] == quality::kGood)
              ranges[static_cast<std::size_t>(a) * signals + s].Add(block.signal[s][k]);
      }
  }
  LiveCheck check;
  check.seconds = seconds;
  for (const auto& source : sources) check.sources.push_back(source->status());
  for (const auto& source : sources) source->Stop();
  check.streams = aligner.streams();
  std::vector<std::vector<CommandAnswers::Fault>> faults;  // of each axis
  for (const CommandAnswers& answer : answers) {
    faults.push_back(answer.Against());
    std::ranges::move(answer.Sizes(), std::back_inserter(faults.back()));
  }
  const std::vector<DoubledSignals> doubled = DoubledSignalsOf(machine);
  for (const LiveChannel& live : LiveChannels(machine)) {
    const auto signal = static_cast<std::size_t>(live.signal);
    const std::size_t index = static_cast<std::size_t>(live.axis) * signals + signal;
    const SignalSpec& spec = machine.signals[signal];
    if (!spec.origin) continue;
    const ChannelState& state = aligner.channels()[index];
    const ChannelQuality& seen = monitors[static_cast<std::size_t>(live.axis)].channels()[signal];
    const Range& range = ranges[index];
    CheckedChannel channel{
        .name = live.name, .unit = std::string(FindUnit(spec.unit).value_or(Unit{}).si), .hints = {}};
    const double heard = static_cast<double>(now.monotonic_ns - first[index]) * 1e-9;
    channel.rate = static_cast<double>(state.values) / std::max(0.1, heard);
    const std::int64_t age = std::max<std::int64_t>(0, now.monotonic_ns - state.last_received);
    channel.age = state.last_received == 0 ? kNaN : static_cast<double>(age) * 1e-9;
    channel.min = range.min, channel.max = range.max;
    channel.mean = range.count > 0 ? range.sum / static_cast<double>(range.count) : kNaN;
    channel.noise_std = seen.noise_std;
    for (const std::int64_t count : seen.flagged) channel.flagged += count;
    AddHints(spec, machine, seen.rows, channel);
    for (const DoubledSignals& pair : doubled)
      if (pair.live && pair.second == live.signal) channel.hints.push_back(pair.text.english);
    for (const CommandAnswers::Fault& fault : faults[static_cast<std::size_t>(live.axis)])
      if (fault.signal == live.signal) channel.hints.push_back(fault.text.english);
    check.channels.push_back(std::move(channel));
  }
  return check;
}

std::string LiveCheckText(const LiveCheck& check) {
  std::string text = fmt::format("listened for {:g} s\n", check.seconds);
  for (const SourceStatus& source : check.sources)
    text += fmt::format("{}: {}; {} rows, {} lost, {} malformed, {} timeouts\n", Printable(source.name),
                        Printable(source.state.english), source.rows, source.lost_rows, source.malformed,
                        source.timeouts);
  for (const StreamState& stream : check.streams)
    if (stream.has_clock)
      text += fmt::format("sender of {} channels: its clock is {:+.1f} ms from ours\n", stream.channels,
                          -stream.clock_offset * 1e3);
  std::size_t width = 7;
  for (const CheckedChannel& c : check.channels) width = std::max(width, ShownWidth(c.name));
  text += fmt::format("\n{:<{}} {:>5} {:>6} {:>10} {:>10} {:>8} {:<5} {:>7}\n", "channel", width, "1/s",
                      "age ms", "lowest", "highest", "noise", "unit", "flagged");
  for (const CheckedChannel& c : check.channels) {
    const DisplayUnit unit = DisplayUnitFor(c.unit);
    text += fmt::format("{:<{}} {:>5.0f} {:>6} {:>10} {:>10} {:>8} {:<5} {:>7}\n", c.name, width, c.rate,
                        std::isfinite(c.age) ? fmt::format("{:.0f}", c.age * 1e3) : "never",
                        Shown(c.min, c.unit), Shown(c.max, c.unit),
                        std::isfinite(c.noise_std) ? ShortNumber(c.noise_std * unit.factor) : "-",
                        unit.name == "1" ? "-" : unit.name, c.flagged);
  }
  for (const CheckedChannel& c : check.channels)
    for (const std::string& hint : c.hints) text += fmt::format("{}: {}\n", c.name, hint);
  if (check.Clean()) text += "every channel makes sense\n";
  return text;
}

nlohmann::json LiveCheckJson(const LiveCheck& check) {
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
  };
  nlohmann::json channels = nlohmann::json::array(), sources = nlohmann::json::array();
  for (const CheckedChannel& c : check.channels)
    channels.push_back({{"name", c.name},
                        {"unit", c.unit},
                        {"rate_hz", c.rate},
                        {"age_s", number(c.age)},
                        {"min", number(c.min)},
                        {"max", number(c.max)},
                        {"mean", number(c.mean)},
                        {"noise_std", number(c.noise_std)},
                        {"flagged", c.flagged},
                        {"hints", c.hints}});
  for (const SourceStatus& s : check.sources)
    sources.push_back({{"name", s.name},
                       {"connected", s.connected},
                       {"state", s.state.english},
                       {"german", {{"state", s.state.german}}},
                       {"rows", s.rows},
                       {"lost_rows", s.lost_rows}});
  return {{"seconds", check.seconds}, {"sources", sources}, {"channels", channels}, {"clean", check.Clean()}};
}

}  // namespace hydroscope
