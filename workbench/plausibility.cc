#include "workbench/plausibility.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "core/constants.h"
#include "core/units.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

constexpr double kHardlyEver = 0.01;  // share of rows: so few are as good as none
// Share of rows in which a mirrored condition would hold, to be advised.
constexpr double kOftenEnough = 0.05;

/// What a quantity on a hydraulic machine looks like; `measure` of a signal lies between `low` and `high`, SI.
struct Expectation {
  const char* si;
  enum { kLargest, kTravel, kMean } measure;
  double low, high;  ///< SI
  Told text;         ///< of what is expected
  std::vector<const char*> units;
};

const std::vector<Expectation>& Expectations() {
  static const std::vector<Expectation> kAll = {
      {"Pa",
       Expectation::kLargest,
       5e5,
       1e8,
       {"pressures of a hydraulic machine reach 5 to 1000 bar",
        "Drücke einer Hydraulik reichen bis 5 bis 1000 bar"},
       {"bar", "Pa", "MPa", "kPa", "psi", "mbar"}},
      {"m",
       Expectation::kTravel,
       1e-3,
       10,
       {"strokes are 1 mm to 10 m long", "Hübe sind 1 mm bis 10 m lang"},
       {"mm", "m", "cm", "um"}},
      {"K",
       Expectation::kMean,
       253,
       403,
       {"oil is between -20 and 130 °C", "Öl liegt zwischen -20 und 130 °C"},
       {"degC", "K", "degF"}},
      {"V",
       Expectation::kLargest,
       0.1,
       50,
       {"valve commands reach 0.1 to 50 V", "Ventilbefehle reichen bis 0,1 bis 50 V"},
       {"V", "mV"}}};
  return kAll;
}

double Measure(const Expectation& expected, double min, double max, double mean) {
  switch (expected.measure) {
    case Expectation::kLargest:
      return std::max(std::abs(min), std::abs(max));
    case Expectation::kTravel:
      return max - min;
    case Expectation::kMean:
      return mean;
  }
  return mean;
}

/// A share, such as an opening, that the machine's kind knows the size of.
std::optional<Expectation> ExpectedShare(const Machine& machine, const std::string& signal) {
  constexpr double kLeastShare = 0.02;  // of the largest: less looks like per cent taken for 1
  for (const MachineInput& input : KindOf(machine).signals)
    if (input.name == signal && input.si == "1" && input.size)
      return Expectation{"1",
                         Expectation::kLargest,
                         kLeastShare * input.size->high,
                         input.size->high,
                         {"it should lie between -1 and 1", "er sollte zwischen -1 und 1 liegen"},
                         {"1", "%"}};
  return std::nullopt;
}

/// Oil of a kind of machine that keeps it cooler than others do.
Expectation AsTheKindHasIt(const Machine& machine, const std::string& signal, Expectation expected) {
  for (const MachineInput& input : KindOf(machine).signals) {
    if (input.name != signal || !input.size || input.size->of != PlausibleSize::kMean) continue;
    expected.low = input.size->low, expected.high = input.size->high;
    expected.text = Tell("oil of such a machine is between {:.0f} and {:.0f} °C",
                         "Öl einer solchen Maschine liegt zwischen {:.0f} und {:.0f} °C",
                         expected.low - kZeroCelsius, expected.high - kZeroCelsius);
  }
  return expected;
}

std::optional<Expectation> ExpectationFor(const Machine& machine, const SignalSpec& spec, const Unit& unit) {
  if (const auto share = ExpectedShare(machine, spec.name)) return share;
  for (const Expectation& e : Expectations())
    if (e.si == unit.si) return e.measure == Expectation::kMean ? AsTheKindHasIt(machine, spec.name, e) : e;
  return std::nullopt;
}

/// The unit in which the column's numbers would look right, if any.
std::optional<std::string> BetterUnit(const Expectation& expected, const CheckedSignal& signal,
                                      const Unit& unit) {
  const auto raw = [&](double si) { return (si - unit.offset) / unit.scale; };
  for (const char* name : expected.units) {
    const auto other = FindUnit(name);
    if (!other || name == signal.spec.unit) continue;
    const auto si = [&](double x) { return raw(x) * other->scale + other->offset; };
    const double measure =
        Measure(expected, si(signal.range.min), si(signal.range.max), si(signal.range.mean()));
    if (measure >= expected.low && measure <= expected.high) return name;
  }
  return std::nullopt;
}

void JudgeUnit(const Machine& machine, const CheckedSignal& signal, std::vector<Told>& hints) {
  const auto unit = FindUnit(signal.spec.unit);
  if (!unit || !signal.range.seen()) return;
  const auto expected = ExpectationFor(machine, signal.spec, *unit);
  if (!expected) return;
  const double measure = Measure(*expected, signal.range.min, signal.range.max, signal.range.mean());
  if (measure >= expected->low && measure <= expected->high) return;
  const auto raw = [&](double si) { return (si - unit->offset) / unit->scale; };
  const auto better = BetterUnit(*expected, signal, *unit);
  hints.push_back(Tell(
      "{} (column {}): the numbers go from {:.4g} to {:.4g}, unit \"{}\" in the machine file; {}{}",
      "{} (Spalte {}): die Zahlen gehen von {:.4g} bis {:.4g}, Einheit \"{}\" in der Maschinendatei; {}{}",
      signal.spec.name, signal.spec.column, raw(signal.range.min), raw(signal.range.max), signal.spec.unit,
      expected->text,
      better ? Tell(". They look like {}: set unit = \"{}\"", ". Sie sehen nach {} aus: unit = \"{}\" setzen",
                    *better, *better)
             : Told{}));
}

void JudgeRest(const CheckedSignal& signal, std::vector<Told>& hints) {
  if (signal.range.readings < 100 || signal.range.max > signal.range.min) return;
  hints.push_back(
      Tell("{} (column {}): one and the same reading in the whole log; is the sensor connected?",
           "{} (Spalte {}): ein und derselbe Wert in der ganzen Aufzeichnung; ist der Sensor angeschlossen?",
           signal.spec.name, signal.spec.column));
}

void JudgeCopies(const CheckResult& check, std::vector<Told>& hints) {
  if (check.pass.copied_rows == 0) return;
  hints.push_back(Tell(
      "{} rows repeat earlier rows to the last digit, under other time stamps: a buffer or a file was written twice. They "
      "are left out as duplicate",
      "{} Zeilen wiederholen frühere bis auf die letzte Stelle, mit anderen Zeitstempeln: ein Puffer oder eine Datei wurde "
      "zweimal geschrieben. Sie bleiben als doppelt außer Betracht",
      check.pass.copied_rows));
}

/// A few readings on a line are what a command may do, too.
void JudgeDrawn(const CheckResult& check, std::vector<Told>& hints) {
  constexpr auto kBit =
      static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(quality::kInterpolated)));
  for (const ChannelQuality& channel : check.pass.channels)
    if (const std::int64_t drawn = channel.flagged[kBit];
        static_cast<double>(drawn) > kHardlyEver * static_cast<double>(channel.rows))
      hints.push_back(Tell(
          "{}: {} readings lie on straight lines between others: the logger had none and drew them. They are left out as "
          "interpolated",
          "{}: {} Werte liegen auf Geraden zwischen anderen: der Logger hatte keine und hat sie gezogen. Sie bleiben als "
          "interpoliert außer Betracht",
          channel.name, drawn));
}

void JudgeFaults(const LogPass& pass, const Machine& machine, std::vector<Told>& hints) {
  hints.insert(hints.end(), pass.outside_declared.begin(), pass.outside_declared.end());
  hints.insert(hints.end(), pass.reversed.begin(), pass.reversed.end());
  hints.insert(hints.end(), pass.wrong_answers.begin(), pass.wrong_answers.end());
  if (!pass.no_verdict.empty()) hints.push_back(pass.no_verdict);
  for (const ReadingFaults::Echo& echo : pass.echoes) hints.push_back(echo.Sentence());
  hints.insert(hints.end(), pass.swapped.begin(), pass.swapped.end());
  const std::vector<Told> left_out = pass.LeftOut(machine);
  hints.insert(hints.end(), left_out.begin(), left_out.end());
}

/// Without strokes, a signal that is hardly ever good explains more than the gate.
void JudgeGood(const CheckResult& check, const CheckedSignal& signal, std::vector<Told>& hints) {
  if (check.driving.strokes > 0 || !signal.spec.required || check.time.rows == 0) return;
  if (static_cast<double>(signal.range.good) > kHardlyEver * static_cast<double>(check.time.rows)) return;
  hints.push_back(Tell("{} (column {}): {} of {} readings are good, and no stroke can be used without it",
                       "{} (Spalte {}): {} von {} Werten sind gut, und ohne ihn ist kein Hub zu gebrauchen",
                       signal.spec.name, signal.spec.column, signal.range.good, check.time.rows));
}

/// Each condition of the gate holds now and then, all of them never: a sign may be turned round.
void JudgeTogether(const CheckResult& check, std::vector<Told>& hints) {
  const auto seldom = [](const ConditionSurvey& c) { return c.share < kHardlyEver; };
  if (check.gate.share >= kHardlyEver || std::ranges::any_of(check.conditions, seldom)) return;
  std::string turned;
  double share = 0;
  for (const auto& [signal, mirrored] : check.gate.mirrored) {
    if (mirrored <= kOftenEnough) continue;
    turned += (turned.empty() ? "" : ", ") + signal;
    share = std::max(share, mirrored);
  }
  if (turned.empty()) return;
  hints.push_back(Tell(
      "gate: its conditions hold one by one but never together; with the sign of one signal reversed they would in {:.0f} % of the "
      "log. Look which way round these count ({}), and set scale = -1 for the one that is turned round",
      "Gate: seine Bedingungen gelten einzeln, aber nie zusammen; mit umgekehrtem Vorzeichen eines Signals gälten sie in {:.0f} % "
      "der Aufzeichnung. Nachsehen, wie herum diese zählen ({}), und für das verkehrte scale = -1 setzen",
      100 * share, turned));
}

void JudgeGate(const CheckResult& check, std::vector<Told>& hints) {
  if (check.driving.strokes > 0) return;
  JudgeTogether(check, hints);
  for (const ConditionSurvey& c : check.conditions) {
    if (c.share >= kHardlyEver) continue;
    const Told what =
        c.share_mirrored > kOftenEnough
            ? Tell(
                  "with the sign of the signal reversed it would hold in {:.0f} %: set scale = -1 for that signal, or "
                  "reverse the condition",
                  "mit umgekehrtem Vorzeichen des Signals gälte sie in {:.0f} %: scale = -1 für dieses Signal setzen, "
                  "oder die Bedingung umkehren",
                  100 * c.share_mirrored)
            : Tell("check its limits in [gate] against the range of the signal above",
                   "ihre Grenzen in [gate] gegen den Bereich des Signals prüfen");
    hints.push_back(Tell("gate: the condition {} holds in {:.1f} % of the log; {}",
                         "Gate: die Bedingung {} gilt in {:.1f} % der Aufzeichnung; {}", c.condition,
                         100 * c.share, what));
  }
}

/// Where strokes are all alike, what only their difference would show is not in the intervals.
void JudgeVariety(const Driving& d, std::vector<Told>& hints) {
  if (d.strokes < 2) return;
  for (const ConditionRange& range : d.ranges)
    if (!range.condition.hides.empty() && range.low > 0 && !range.varies())
      hints.push_back(Tell(
          "the {} is {}: {}. The intervals hold only if the model lacks nothing; "
          "vary {} between strokes to find out",
          "{}: {}; {}. Die Intervalle gelten nur, wenn dem Modell nichts fehlt; um es herauszufinden, zwischen "
          "den Hüben variieren: {}",
          range.condition.title, range.Text(), range.condition.hides, range.condition.vary));
}

}  // namespace

std::vector<Told> PlausibilityHints(const CheckResult& check) {
  std::vector<Told> hints;
  const bool of_strokes =
      KindOf(check.machine).build != nullptr;  // else signals may be as small as they like
  for (const CheckedSignal& signal : check.signals) {
    if (!signal.present) continue;
    if (of_strokes && check.driving.words.hydraulic) JudgeUnit(check.machine, signal, hints);
    JudgeRest(signal, hints);
    if (of_strokes) JudgeGood(check, signal, hints);
  }
  JudgeCopies(check, hints);
  JudgeDrawn(check, hints);
  JudgeFaults(check.pass, check.machine, hints);
  if (of_strokes) JudgeGate(check, hints);
  JudgeVariety(check.driving, hints);
  return hints;
}

}  // namespace hydroscope
