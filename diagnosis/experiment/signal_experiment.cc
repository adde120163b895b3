#include "diagnosis/experiment/signal_experiment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/quantile.h"
#include "core/short_number.h"
#include "diagnosis/experiment/moved_stroke.h"
#include "diagnosis/experiment/rival_separation.h"
#include "diagnosis/sample_grams.h"
#include "models/expressions/check.h"
#include "models/machine_file/table.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

constexpr std::size_t kTemplates = 12;   ///< recorded strokes that are moved
constexpr std::size_t kFewestAlike = 4;  ///< strokes that stand for their kind
/// Strokes of a kind must save a third of the time against going on as recorded: what is asked of people must
/// be worth it.
constexpr double kClearlyFewer = 0.67;
constexpr double kOfTheWay = 0.95;  ///< that a signal gets within a stroke: beyond, noise makes the extremes

std::set<std::string> SignalsIn(const Machine& machine, const std::string& expression,
                                const ExpressionNames& names) {
  std::set<std::string> signals;
  if (const auto checked = CheckExpression(expression, names))
    for (const std::string& name : NamesIn(*checked->tree))
      if (machine.SignalIndex(name) >= 0) signals.insert(name);
  return signals;
}

/// Signals that the terms of the balance and the effects of `model` read.
std::set<std::string> InputsOf(const Machine& machine, const RivalModel& model) {
  std::set<std::string> inputs;
  for (const TermSpec& term : machine.balance.terms)
    inputs.merge(SignalsIn(machine, term.expression, ExpressionNamesOf(machine)));
  for (const UserEffectSpec& effect : machine.user_effects)
    for (std::size_t e = 0; e < model.structure->effects.size(); ++e)
      if (effect.id == model.structure->effects[e]->id && !model.structure->effect_shapes[e].empty())
        for (const TermSpec& term : effect.terms)
          inputs.merge(SignalsIn(machine, term.expression, ExpressionNamesOf(machine, effect)));
  return inputs;
}

/// What strokes differ in: the mean of a signal, or its speed.
struct Feature {
  std::string signal;
  int channel = 0;
  bool speed = false;

  double Of(const StrokeStretches& stroke, const WindowSamples& window) const {
    return speed ? SpeedOf(stroke, channel, window) : MeanOf(stroke, channel);
  }
};

/// Levels that the machine file allows of a feature.
struct AllowedLevels {
  Feature feature;
  double low = 0, high = 0;
};

/// A series to choose from: its levels, and the evidence and duration of its mean stroke.
struct Series {
  std::vector<SignalLevels> signals;
  RivalEvidence stroke;
  double seconds = 0;
};

double SecondsOf(const StrokeStretches& stroke) {
  return std::accumulate(stroke.begin(), stroke.end(), 0.0, [](double sum, const Stretch& s) {
    return sum + (s.samples - (s.continues ? 1 : 0)) * s.period;
  });
}

class SignalSearch {
 public:
  SignalSearch(const Explanation& explanation, const Machine& machine,
               std::span<const StrokeStretches> recorded, const WindowSamples& window)
      : machine_(machine),
        recorded_(recorded),
        window_(window),
        model_(RivalModelOf(explanation)),
        theta_(explanation.final.theta.head(model_.structure->base_count)),
        grams_(GramsOf(model_.structure, recorded, window)),
        known_(EvidenceOf(model_, theta_, grams_, window)),
        rivals_(model_, StrokeSet(model_.structure, grams_, window)) {
    // A model error that the explanation leaves speaks against the right rival as loudly as sensor noise.
    known_.noise *= 1 + std::max(0.0, explanation.final.excess_ratio);
    noise_ = known_.noise / known_.equations;
    for (const StrokeStretches& stroke : recorded) seconds_ += SecondsOf(stroke);
  }

  SignalExperiment Run() const {
    SignalExperiment out;
    out.separation_now = out.separation = rivals_.Nearest(known_);
    const std::set<std::string> inputs = InputsOf(machine_, model_);
    out.inputs.assign(inputs.begin(), inputs.end());
    const std::vector<AllowedLevels> allowed = Allowed(inputs);
    if (!machine_.experiment.signals.empty()) out.tied = Tied(inputs);
    const bool move = !allowed.empty() && out.tied.empty();
    out.unusable = !machine_.experiment.signals.empty() && out.tied.empty() && !move;
    SignalExperiment best = out;
    for (const Series& series : move ? MovedSeries(allowed) : RecordedSeries(inputs))
      best = Better(Tried(series, out), best, 1.0);
    const SignalExperiment same =
        Tried({{}, MeanOfRecorded(All()), seconds_ / static_cast<double>(recorded_.size())}, out);
    best = Better(best, same, kClearlyFewer);
    if (best.separation >= kExperiment.worthwhile) return best;
    out.separation = best.separation;
    return out;
  }

 private:
  std::vector<std::size_t> All() const {
    std::vector<std::size_t> all(recorded_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  }

  /// The signal of the output that terms or effects in question read too, "" = the output alone answers.
  std::string Tied(const std::set<std::string>& inputs) const {
    for (const std::string& name : SignalsIn(machine_, machine_.balance.output, ExpressionNamesOf(machine_)))
      if (inputs.contains(name)) return name;
    return "";
  }

  int ChannelOf(const std::string& signal) const {
    const auto& names = model_.structure->channel_names;
    const auto at = std::find(names.begin(), names.end(), signal);
    return at == names.end() ? -1 : static_cast<int>(at - names.begin());
  }

  int Measured() const {
    const auto& source = model_.structure->channel_source;
    return static_cast<int>(std::count_if(source.begin(), source.end(), [](int s) { return s >= 0; }));
  }

  double Typical(const Feature& feature) const {
    std::vector<double> values;
    for (const StrokeStretches& stroke : recorded_) values.push_back(feature.Of(stroke, window_));
    return Median(values, 0);
  }

  /// What the machine file allows of the signals that matter. Limits left out are those recorded; strokes
  /// must stay inside the gate, and a signal that moves within a stroke inside its limits.
  std::vector<AllowedLevels> Allowed(const std::set<std::string>& inputs) const {
    std::vector<AllowedLevels> out;
    for (const GateBound& bound : machine_.experiment.signals) {
      AllowedLevels levels{{bound.signal, ChannelOf(bound.signal), bound.rate}};
      if (levels.feature.channel < 0 || !inputs.contains(bound.signal)) continue;
      const double typical = Typical(levels.feature);
      levels.low = bound.min.value_or(typical);
      levels.high = bound.max.value_or(typical);
      for (const GateBound& gate : machine_.gate.bounds) {
        if (gate.signal != bound.signal || gate.rate != bound.rate) continue;
        if (gate.min && *gate.min > 0) levels.low = std::max(levels.low, *gate.min);
        if (gate.max && *gate.max > 0) levels.high = std::min(levels.high, *gate.max);
      }
      if (!bound.rate) {
        const double reach = Reach(levels.feature.channel);
        levels.low += reach;
        levels.high -= reach;
      }
      if (levels.low <= levels.high && (!bound.rate || levels.low > 0)) out.push_back(levels);
    }
    return out;
  }

  /// How far a signal gets from its mean within a stroke, noise aside: kOfTheWay in a typical stroke.
  double Reach(int channel) const {
    std::vector<double> reaches;
    for (const StrokeStretches& stroke : recorded_) {
      const double mean = MeanOf(stroke, channel);
      std::vector<double> ways;
      for (const Stretch& stretch : stroke)
        for (int k = 0; k < stretch.samples; ++k) ways.push_back(std::abs(stretch[channel][k] - mean));
      reaches.push_back(Quantile(std::move(ways), kOfTheWay, 0));
    }
    return Median(std::move(reaches), 0);
  }

  RivalEvidence Evidence(std::span<const StrokeStretches> strokes) const {
    RivalEvidence evidence = EvidenceOf(model_, theta_, strokes, window_);
    evidence.noise = noise_ * evidence.equations;
    return evidence;
  }

  RivalEvidence MeanOfRecorded(const std::vector<std::size_t>& which) const {
    std::vector<StrokeStretches> strokes;
    for (const std::size_t k : which) strokes.push_back(recorded_[k]);
    return RivalEvidence().Add(Evidence(strokes), 1.0 / static_cast<double>(which.size()));
  }

  /// The mean stroke of every combination of levels.
  Series Moved(const std::vector<std::pair<AllowedLevels, std::vector<double>>>& moves) const {
    Series out;
    std::vector<std::vector<double>> combinations = {{}};
    for (const auto& [allowed, levels] : moves) {
      const std::string& unit = machine_.signals[machine_.SignalIndex(allowed.feature.signal)].unit;
      out.signals.push_back({allowed.feature.signal, allowed.feature.speed, unit, {}});
      std::vector<std::vector<double>> longer;
      for (const double level : levels) {
        out.signals.back().levels.emplace_back(level, level);
        for (std::vector<double> combination : combinations) {
          combination.push_back(level);
          longer.push_back(std::move(combination));
        }
      }
      combinations = std::move(longer);
    }
    std::vector<StrokeStretches> strokes;
    const std::size_t step = std::max<std::size_t>(1, recorded_.size() / kTemplates);
    for (std::size_t k = 0; k < recorded_.size(); k += step)
      for (const std::vector<double>& levels : combinations) {
        StrokeMove move;
        for (std::size_t m = 0; m < moves.size(); ++m) {
          const Feature& feature = moves[m].first.feature;
          const double now = feature.Of(recorded_[k], window_);
          if (!feature.speed)
            move.shift[feature.channel] = levels[m] - now;
          else if (now > 0)
            move.speed = levels[m] / now;
        }
        strokes.push_back(MovedStroke(recorded_[k], move, Measured(), window_));
        out.seconds += SecondsOf(strokes.back());
      }
    const auto count = static_cast<double>(strokes.size());
    out.seconds /= count;
    out.stroke.Add(Evidence(strokes), 1 / count);
    return out;
  }

  /// One signal at its levels in turn, or two at both ends of theirs.
  std::vector<Series> MovedSeries(const std::vector<AllowedLevels>& allowed) const {
    std::vector<Series> out;
    for (std::size_t a = 0; a < allowed.size(); ++a) {
      const double low = allowed[a].low, high = allowed[a].high;
      for (const std::vector<double>& levels :
           {std::vector{low}, {high}, {low, high}, {low, 0.5 * (low + high), high}})
        out.push_back(Moved({{allowed[a], levels}}));
      for (std::size_t b = 0; b < a; ++b)
        if (!(allowed[a].feature.speed && allowed[b].feature.speed))
          out.push_back(Moved({{allowed[b], {allowed[b].low, allowed[b].high}}, {allowed[a], {low, high}}}));
    }
    return out;
  }

  /// Recorded strokes with low, with high and with both kinds of values of each feature.
  std::vector<Series> RecordedSeries(const std::set<std::string>& inputs) const {
    std::vector<Series> out;
    const std::size_t third = recorded_.size() / 3;
    if (third < kFewestAlike) return out;
    for (const std::string& signal : inputs)
      for (const bool speed : {false, true}) {
        const Feature feature{signal, ChannelOf(signal), speed};
        if (feature.channel < 0) continue;
        std::vector<std::pair<double, std::size_t>> order;
        for (std::size_t k = 0; k < recorded_.size(); ++k)
          order.emplace_back(feature.Of(recorded_[k], window_), k);
        std::sort(order.begin(), order.end());
        const auto range = [&](std::size_t first, std::size_t count) {
          return std::make_pair(order[first].first, order[first + count - 1].first);
        };
        const std::size_t top = order.size() - third;
        const std::string& unit = machine_.signals[machine_.SignalIndex(signal)].unit;
        for (const auto& starts : {std::vector<std::size_t>{0}, {top}, {0, top}}) {
          Series series;
          series.signals = {{signal, speed, unit, {}}};
          std::vector<std::size_t> which;
          for (const std::size_t first : starts) {
            series.signals[0].levels.push_back(range(first, third));
            for (std::size_t k = first; k < first + third; ++k) which.push_back(order[k].second);
          }
          for (const std::size_t k : which)
            series.seconds += SecondsOf(recorded_[k]) / static_cast<double>(which.size());
          series.stroke = MeanOfRecorded(which);
          out.push_back(std::move(series));
        }
      }
    return out;
  }

  /// How far the series gets, in as few strokes as settle the case.
  SignalExperiment Tried(const Series& series, SignalExperiment out) const {
    const auto separation = [&](int count) {
      return rivals_.Nearest(RivalEvidence(known_).Add(series.stroke, count));
    };
    out.signals = series.signals;
    out.strokes = StrokesToSettle(machine_.experiment.max_strokes, separation);
    out.separation = separation(out.strokes);
    out.seconds = out.strokes * series.seconds;
    return out;
  }

  /// `a` if it settles the case in at most `share` of the time of `b`, or goes further where neither settles
  /// it; else `b`.
  static const SignalExperiment& Better(const SignalExperiment& a, const SignalExperiment& b, double share) {
    if (a.settles() != b.settles()) return a.settles() ? a : b;
    const bool better = a.settles() ? a.seconds < share * b.seconds : share * a.separation > b.separation;
    return better ? a : b;
  }

  const Machine& machine_;
  std::span<const StrokeStretches> recorded_;
  const WindowSamples& window_;
  RivalModel model_;
  Eigen::VectorXd theta_;
  std::vector<StrokeGram> grams_;  ///< of what is recorded
  RivalEvidence known_;
  Rivals rivals_;
  double noise_ = 0;  ///< of an equation
  double seconds_ = 0;
};

Told LevelsText(const SignalLevels& s) {
  const FileUnit unit = FindFileUnit(s.unit).value_or(FileUnit{});
  const auto shown = [&](double si) { return (si - (s.speed ? 0 : unit.offset)) / unit.scale; };
  std::vector<std::string> levels;
  for (const auto& [low, high] : s.levels)
    levels.push_back(low == high ? ShortNumber(shown(low), 4)
                                 : ShortNumber(shown(low), 4) + " ... " + ShortNumber(shown(high), 4));
  const Told name =
      s.speed ? Tell("the speed of {}", "die Geschwindigkeit von {}", s.signal) : Told(s.signal);
  const std::string dimension = s.unit == "1" ? (s.speed ? "1/s" : "") : s.unit + (s.speed ? "/s" : "");
  return Tell("{} at {} {}{}", "{} bei {} {}{}", name,
              Told(fmt::to_string(fmt::join(levels, " and ")), fmt::to_string(fmt::join(levels, " und "))),
              dimension, levels.size() > 1 ? Tell(" in turn", " nacheinander") : Told{});
}

}  // namespace

bool SignalExperiment::settles() const { return strokes > 0 && separation >= kExperiment.settled; }

SignalExperiment ProposeSignalExperiment(const Explanation& explanation, const Machine& machine,
                                         std::span<const StrokeStretches> recorded,
                                         const WindowSamples& window) {
  if (explanation.verdict != Verdict::kAmbiguous || !KindOf(machine).own_library || recorded.empty())
    return {};
  return SignalSearch(explanation, machine, recorded, window).Run();
}

Told SignalExperimentText(const SignalExperiment& e) {
  Told text;
  if (!e.tied.empty())
    text = Tell(
        "What [experiment] allows was not computed: the output and the other side of the balance both read "
        "{}, and how the machine would answer is in no expression; only strokes as recorded were weighed. ",
        "Was [experiment] erlaubt, wurde nicht berechnet: der Ausgang und die andere Seite der Bilanz lesen beide "
        "{}, und wie die Maschine antworten würde, steht in keinem Ausdruck; "
        "nur Hübe wie aufgezeichnet wurden gewogen. ",
        e.tied);
  if (e.unusable)
    text = Tell(
        "Nothing that [experiment] allows can be used: it is of no signal that the effects in question or "
        "the terms read, or outside the gate, or narrower than what the signal does within a stroke. ",
        "Nichts, was [experiment] erlaubt, lässt sich nutzen: es ist von keinem Signal, das die "
        "fraglichen Effekte oder die Terme lesen, oder liegt außerhalb des Gates, oder ist enger als das, "
        "was das Signal in einem Hub tut. ");
  if (e.strokes == 0)
    return Joined(
        {text,
         Tell(
             "No series of strokes that can be computed would settle it: the separation is {:.0f} "
             "now and {:.0f} at most, {:.0f} is needed. The effects in question and the terms read "
             "{}: say under [experiment] signals of the machine file what those may be run at, or "
             "allow more, and explain again.",
             "Keine Reihe von Hüben, die sich berechnen lässt, würde es klären: die Trennung ist jetzt {:.0f} "
             "und höchstens {:.0f}, nötig sind {:.0f}. Die fraglichen Effekte und die Terme lesen {}: unter "
             "[experiment] signals der Maschinendatei sagen, bei welchen Werten sie gefahren werden dürfen, "
             "oder mehr erlauben, und wieder erklären lassen.",
             e.separation_now, e.separation, kExperiment.settled, fmt::to_string(fmt::join(e.inputs, ", ")))},
        "");
  if (e.signals.empty()) {
    text = Joined(
        {text, Tell("Record {} more strokes like these", "{} weitere Hübe wie diese aufzeichnen", e.strokes)},
        "");
  } else {
    Told levels;
    for (const SignalLevels& s : e.signals)
      levels = levels.empty() ? LevelsText(s)
                              : Tell("{}, each with {}", "{}, jeder mit {}", levels, LevelsText(s));
    text = Joined({text, Tell("Record {} strokes with {}, all else as in this log",
                              "{} Hübe aufzeichnen mit {}, alles andere wie in dieser Aufzeichnung",
                              e.strokes, levels)},
                  "");
  }
  return Joined(
      {text,
       Tell(" ({:.0f} s; expected separation {:.0f}, now {:.0f}, {:.0f} settles it); then explain "
            "this log and that one together.{}",
            " ({:.0f} s; erwartete Trennung {:.0f}, jetzt {:.0f}, {:.0f} klärt es); dann diese und jene "
            "Aufzeichnung zusammen erklären lassen.{}",
            e.seconds, e.separation, e.separation_now, kExperiment.settled,
            e.settles() ? Told{} : Tell(" It may not be enough.", " Vielleicht reicht es nicht."))},
      "");
}

}  // namespace hydroscope
