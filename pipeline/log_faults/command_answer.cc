#include "pipeline/log_faults/command_answer.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/records/quality.h"
#include "core/units.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// A declared range of a command ends so far beyond its full value at most.
constexpr double kRoomBeyondFull = 1.5;

/// SI of the command that drives the signal to its end.
double FullCommand(const StandstillRule& rule, const SignalSpec& command) {
  if (!command.min || !command.max) return rule.full_command;
  const double declared = std::max(std::abs(*command.min), std::abs(*command.max));
  const bool agrees = declared >= rule.full_command && declared <= kRoomBeyondFull * rule.full_command;
  return agrees || !(declared > 0) ? rule.full_command : declared;
}

Told ColumnTold(const SignalSpec& spec) {
  if (spec.column.empty()) return Told(spec.name);
  return Tell("{} (column {})", "{} (Spalte {})", spec.name, spec.column);
}

}  // namespace

double CommandAnswers::Pair::Motion() const {
  return rows > 0 ? std::sqrt(
                        std::max({0.0, xx / rows - x / rows * (x / rows), yy / rows - y / rows * (y / rows)}))
                  : 0;
}

double CommandAnswers::Pair::Correlation() const {
  const double spread = (xx - x * x / rows) * (yy - y * y / rows);
  return spread > 0 ? (xy - x * y / rows) / std::sqrt(spread) : 0;
}

/// Of their spreads: a delay takes nothing from it.
double CommandAnswers::Pair::Gain() const { return std::sqrt((yy - y * y / rows) / (xx - x * x / rows)); }

CommandAnswers::CommandAnswers(const Machine& machine, const CommandAnswerOptions& options)
    : machine_(machine), options_(options) {
  for (const StandstillRule& rule : KindOf(machine).standstill) {
    const int signal = machine.SignalIndex(rule.signal), command = machine.SignalIndex(rule.command);
    if (signal < 0 || rule.command.empty() || !(rule.end > 0)) continue;
    Pair pair{.rule = &rule, .signal = signal, .command = command};
    if (command >= 0) pair.full = FullCommand(rule, machine.signals[static_cast<std::size_t>(command)]);
    pairs_.push_back(pair);
  }
}

void CommandAnswers::Observe(const SampleBlock& block) {
  constexpr Quality kNoReading = quality::kMissing | quality::kSpike | quality::kStuck;
  for (Pair& pair : pairs_)
    for (std::size_t row = 0; row < block.rows(); ++row) {
      const auto s = static_cast<std::size_t>(pair.signal);
      const double reading = block.signal[s][row], y = reading / pair.rule->end;
      if (!std::isfinite(reading) || (block.quality[s][row] & kNoReading) != 0) continue;
      ++pair.read;
      pair.beyond += std::abs(y) > options_.beyond_end && reading != pair.last;
      pair.largest = std::max(pair.largest, std::abs(y));
      pair.last = reading;
      if (pair.command < 0 || block.quality[s][row] != quality::kGood) continue;
      const auto c = static_cast<std::size_t>(pair.command);
      const double x = block.signal[c][row] / pair.full;
      if (block.quality[c][row] != quality::kGood || !std::isfinite(x)) continue;
      ++pair.rows, pair.x += x, pair.y += y, pair.xx += x * x, pair.yy += y * y, pair.xy += x * y;
    }
}

bool CommandAnswers::Moves(const Pair& pair) const {
  return pair.rows >= static_cast<double>(options_.least_rows) && pair.Motion() >= options_.least_motion;
}

Told CommandAnswers::NamesOf(const Pair& pair) const {
  return Tell("{} and its command {}", "{} und sein Befehl {}",
              ColumnTold(machine_.signals[static_cast<std::size_t>(pair.signal)]),
              ColumnTold(machine_.signals[static_cast<std::size_t>(pair.command)]));
}

/// Which of the two it is; "" if neither is likelier.
Told CommandAnswers::LikelyText(const Pair& pair, std::optional<double> in_gate) const {
  if (!in_gate) return {};
  if (*in_gate >= options_.strokes)
    return Tell(", as the gate finds strokes with {} as it is, most likely {}",
                ", und da das Gate mit {}, wie es ist, Hübe findet, höchstwahrscheinlich {}",
                pair.rule->signal, pair.rule->command);
  if (*in_gate > options_.no_strokes) return {};
  return Tell(", as the gate finds no strokes with {} as it is, most likely {}",
              ", und da das Gate mit {}, wie es ist, keine Hübe findet, höchstwahrscheinlich {}",
              pair.rule->signal, pair.rule->signal);
}

std::vector<CommandAnswers::Fault> CommandAnswers::Against(std::optional<double> in_gate) const {
  std::vector<Fault> faults;
  for (const Pair& pair : pairs_)
    if (Moves(pair) && pair.Correlation() <= -options_.against)
      faults.push_back(
          {pair.signal,
           Tell(
               "{} go against each other: one of the two counts the other way round{}. Set scale = -1 for it in "
               "[signals] of the machine file",
               "{} bewegen sich gegeneinander: eines der beiden zählt andersherum{}. Dafür in [signals] der "
               "Maschinendatei scale = -1 setzen",
               NamesOf(pair), LikelyText(pair, in_gate))});
  return faults;
}

/// Moved farther than its end.
Told CommandAnswers::BeyondText(const Pair& pair) const {
  if (static_cast<double>(pair.beyond) <= options_.beyond_share * static_cast<double>(pair.read)) return {};
  return Tell(
      "{0} reaches {1:.0f} % of where it ends, and moves there: look at its unit and scale in [signals] of the machine file",
      "{0} erreicht {1:.0f} % der Stellung, in der es endet, und bewegt sich dort: Einheit und Skalierung in [signals] der "
      "Maschinendatei ansehen",
      ColumnTold(machine_.signals[static_cast<std::size_t>(pair.signal)]), 100 * pair.largest);
}

Told CommandAnswers::GainText(const Pair& pair) const {
  if (!Moves(pair) || pair.Correlation() < options_.together) return {};
  const double gain = pair.Gain();
  if (gain >= 1 / options_.most_gain && gain <= options_.most_gain) return {};
  const SignalSpec& command = machine_.signals[static_cast<std::size_t>(pair.command)];
  const Unit unit = FindUnit(command.unit).value_or(Unit{});
  return Tell(
      "{0} move together, but by {1:.2g} times what they should: the signal would reach its end at {2:.3g} {4}, where {3:.3g} {4} are "
      "usual. Look at unit and scale of both in [signals] of the machine file; if {2:.3g} {4} is right, state it as max of {5}",
      "{0} bewegen sich zusammen, aber um das {1:.2g}fache dessen, was sie sollten: das Signal wäre bei {2:.3g} {4} am Ende, üblich sind "
      "{3:.3g} {4}. Einheit und Skalierung beider in [signals] der Maschinendatei ansehen; wenn {2:.3g} {4} stimmt, "
      "es als max von {5} angeben",
      NamesOf(pair), gain, pair.full / gain / unit.scale, pair.full / unit.scale, command.unit, command.name);
}

std::vector<CommandAnswers::Fault> CommandAnswers::Sizes() const {
  std::vector<Fault> faults;
  for (const Pair& pair : pairs_)
    for (Told text : {BeyondText(pair), GainText(pair)})
      if (!text.empty()) faults.push_back({pair.signal, std::move(text)});
  return faults;
}

}  // namespace hydroscope
