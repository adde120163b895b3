#include "pipeline/signal_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "core/constants.h"
#include "core/short_number.h"
#include "core/units.h"

namespace hydroscope {
namespace {

std::string ConditionText(const Machine& machine, const GateBound& bound) {
  const int index = machine.SignalIndex(bound.signal);
  const auto unit = index < 0 ? std::nullopt : FindUnit(machine.signals[index].unit);
  std::string si(unit ? unit->si : "");
  if (bound.rate && si == "m") si = "m/s";
  const DisplayUnit shown = DisplayUnitFor(si);
  std::string text = bound.rate ? fmt::format("ddt({})", bound.signal) : bound.signal;
  if (bound.magnitude) text = fmt::format("|{}|", text);
  if (bound.min) text += " >= " + ShortNumber(*bound.min * shown.factor + (bound.rate ? 0 : shown.offset), 4);
  if (bound.min && bound.max) text += " and";
  if (bound.max) text += " <= " + ShortNumber(*bound.max * shown.factor + (bound.rate ? 0 : shown.offset), 4);
  return shown.name == "1" || shown.name.empty() ? text : fmt::format("{} {}", text, shown.name);
}

}  // namespace

SignalSurvey::SignalSurvey(const Machine& machine, double sample_period)
    : machine_(machine),
      period_(sample_period),
      block_rows_(std::max(1, static_cast<int>(std::lround(machine.window.block / sample_period)))),
      ranges_(machine.signals.size()) {
  for (const GateBound& bound : machine.gate.bounds) {
    Condition condition;
    condition.signal = machine.SignalIndex(bound.signal);
    condition.rate = bound.rate;
    condition.magnitude = bound.magnitude;
    condition.min = bound.min.value_or(-kInfinity);
    condition.max = bound.max.value_or(kInfinity);
    conditions_.push_back(condition);
  }
}

void SignalSurvey::Observe(const SampleBlock& block) {
  for (std::size_t row = 0; row < block.rows(); ++row)
    ObserveTime(block.time[row], !block.quality.empty() && (block.quality[0][row] & quality::kGap) != 0);
  for (std::size_t signal = 0; signal < ranges_.size(); ++signal) ObserveSignal(block, signal);
  for (Condition& condition : conditions_)
    if (condition.signal >= 0) ObserveCondition(block, condition);
}

void SignalSurvey::ObserveTime(double time, bool gap) {
  if (time_.rows++ == 0) {
    time_.first = time_.last = time;
    return;
  }
  const double step = time - time_.last;
  time_.last = time;
  if (!(step > 0)) {
    ++time_.not_forward;
  } else if (gap) {
    ++time_.gaps;
    time_.longest_gap = std::max(time_.longest_gap, step);
  } else {
    squares_ += (step - period_) * (step - period_);
    ++steps_;
  }
}

void SignalSurvey::ObserveSignal(const SampleBlock& block, std::size_t signal) {
  SignalRange& range = ranges_[signal];
  for (std::size_t row = 0; row < block.rows(); ++row) {
    const Quality flags = block.quality[signal][row];
    const double x = block.signal[signal][row];
    if ((flags & (quality::kMissing | quality::kSpike)) == 0) {
      range.min = std::min(range.min, x);
      range.max = std::max(range.max, x);
      range.sum += x;
      ++range.readings;
    }
    if (flags == quality::kGood) ++range.good;
    for (Quality rest = flags; rest != 0; rest &= static_cast<Quality>(rest - 1)) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(rest));
      if (range.flagged[bit]++ == 0) range.first[bit] = block.time[row];
    }
  }
}

void SignalSurvey::ObserveCondition(const SampleBlock& block, Condition& c) const {
  const auto signal = static_cast<std::size_t>(c.signal);
  for (std::size_t row = 0; row < block.rows(); ++row) {
    c.whole = c.whole && (block.quality[signal][row] & quality::kMissing) == 0;
    c.sum += block.signal[signal][row];
    if (++c.count < block_rows_) continue;
    JudgeBlock(c);
  }
}

void SignalSurvey::JudgeBlock(Condition& c) const {
  c.mean[0] = c.mean[1];
  c.mean[1] = c.mean[2];
  c.mean[2] = c.sum / c.count;
  c.blocks = c.whole ? c.blocks + 1 : 0;
  c.sum = 0;
  c.count = 0;
  c.whole = true;
  c.held_in.push_back(false);
  c.mirrored_in.push_back(false);
  if (c.blocks < (c.rate ? 3 : 1)) return;
  const double signed_x = c.rate ? (c.mean[2] - c.mean[0]) / (2 * block_rows_ * period_) : c.mean[2];
  const double x = c.magnitude ? std::abs(signed_x) : signed_x;
  ++c.judged;
  c.held_in.back() = x >= c.min && x <= c.max;
  c.mirrored_in.back() = -x >= c.min && -x <= c.max;
}

TimeSurvey SignalSurvey::time() const {
  TimeSurvey time = time_;
  if (steps_ > 0) time.jitter = std::sqrt(squares_ / static_cast<double>(steps_));
  return time;
}

std::vector<ConditionSurvey> SignalSurvey::conditions() const {
  std::vector<ConditionSurvey> out;
  for (std::size_t i = 0; i < conditions_.size(); ++i) {
    const double judged = static_cast<double>(std::max<std::int64_t>(1, conditions_[i].judged));
    const auto share = [&](const std::vector<bool>& in) {
      return static_cast<double>(std::ranges::count(in, true)) / judged;
    };
    out.push_back({ConditionText(machine_, machine_.gate.bounds[i]), share(conditions_[i].held_in),
                   share(conditions_[i].mirrored_in)});
  }
  return out;
}

GateSurvey SignalSurvey::gate() const {
  std::size_t blocks = conditions_.empty() ? 0 : conditions_.front().held_in.size();
  for (const Condition& c : conditions_) blocks = std::min(blocks, c.held_in.size());
  const auto share = [&](std::optional<int> mirrored) {
    std::size_t held = 0;
    for (std::size_t block = 0; block < blocks; ++block)
      held += std::ranges::all_of(conditions_, [&](const Condition& c) {
        return c.signal == mirrored ? c.mirrored_in[block] : c.held_in[block];
      });
    return static_cast<double>(held) / static_cast<double>(std::max<std::size_t>(1, blocks));
  };
  GateSurvey gate{share(std::nullopt), {}};
  for (std::size_t s = 0; s < machine_.signals.size(); ++s) {
    const int signal = static_cast<int>(s);
    const bool bounded =
        std::ranges::any_of(conditions_, [&](const Condition& c) { return c.signal == signal; });
    if (bounded) gate.mirrored.emplace_back(machine_.signals[s].name, share(signal));
  }
  return gate;
}

}  // namespace hydroscope
