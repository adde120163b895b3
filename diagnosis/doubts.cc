#include "diagnosis/doubts.h"

#include <algorithm>

namespace hydroscope {

/// The model as it is leaves no more than noise, and none of the effects that stand out would not by chance.
bool Doubts::MayBeChance(const Explanation& found) const {
  return options_.IsDownToNoise(start_.fit) &&
         std::none_of(found.ranking.begin(), found.ranking.end(), [&](const RankedEffect& r) {
           return r.significant && (r.p_value < options_.chance_at_floor || ranking_.IsConfirmed(r.effect));
         });
}

/// Two effects found at once of which one, or its twin, is easily taken for the other.
std::optional<std::pair<std::string, std::string>> Doubts::Relatives(
    const std::vector<std::vector<std::string>>& groups) const {
  if (groups.size() != 2) return std::nullopt;
  const auto is_or_is_twin = [&](const std::string& id, const std::string& a) {
    return id == a || FindTwin(strokes_.model(), id, a) != nullptr;
  };
  const auto confused = [&](const std::string& a, const std::string& b) {
    return std::any_of(strokes_.model().effects.begin(), strokes_.model().effects.end(), [&](const auto& e) {
      return is_or_is_twin(e->id, a) &&
             std::any_of(e->confused_with.begin(), e->confused_with.end(),
                         [&](const std::string& other) { return is_or_is_twin(other, b); });
    });
  };
  const std::string &a = groups[0].front(), &b = groups[1].front();
  if (!confused(a, b) && !confused(b, a)) return std::nullopt;
  return std::make_pair(a, b);
}

/// Share of the gain that would be lost with the effect that matters least; 1 if only one was found. A delay that is taken for how
/// the flow between rows is integrated does not count.
double Doubts::LeastShare(const Explanation& found) const {
  const auto started = static_cast<std::size_t>(found.started);
  if (found.chosen.size() < started + 2) return 1;
  const double gain = ranking_.Gain(start_.fit, found.final);
  const auto unseen = MayMoveBetweenRows(found);
  double least = 1;
  for (std::size_t k = started; k < found.chosen.size(); ++k) {
    if (unseen && unseen->integrated && k == started + unseen->effect) continue;
    std::vector<EffectChoice> others = found.chosen;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const ExtendedFit without = strokes_.Fit(others);
    if (without.solved) least = std::min(least, ranking_.Gain(without, found.final) / gain);
  }
  return least;
}

std::optional<Doubts::UnseenDelay> Doubts::MayMoveBetweenRows(const Explanation& found) const {
  const auto started = static_cast<std::size_t>(found.started);
  for (std::size_t k = started; k < found.final.effects.size(); ++k) {
    const EffectEstimate& late = found.final.effects[k];
    const Effect& effect = *strokes_.model().effects[late.choice.effect];
    if (effect.unseen_rows == 0 || late.size > effect.unseen_rows * strokes_.period()) continue;
    const bool integrated = late.size <= options_.integrated_rows * strokes_.period();
    const double milliseconds = 1e3 * late.size, apart = 1e3 * strokes_.period();
    return UnseenDelay{
        k - started, integrated,
        integrated
            ? Tell(
                  "{0} of {1:.2g} ms would explain a little: rows {2:.3g} ms apart make as much of a spool that follows a command "
                  "held from row to row, and it is taken for that",
                  "{0} von {1:.2g} ms würde ein wenig erklären: so viel machen Zeilen im Abstand von {2:.3g} ms aus einem Schieber, "
                  "der einem von Zeile zu Zeile gehaltenen Befehl folgt, und dafür wird es genommen",
                  effect.id, milliseconds, apart)
            : Tell(
                  "rows are {1:.3g} ms apart, and a signal that moves early between two rows, as one does that follows a command "
                  "held so long, looks {0:.2g} ms late as well",
                  "die Zeilen liegen {1:.3g} ms auseinander, und ein Signal, das sich zwischen zwei Zeilen früh bewegt, wie eines, "
                  "das einem so lange gehaltenen Befehl folgt, sieht ebenfalls {0:.2g} ms verspätet aus",
                  milliseconds, apart)};
  }
  return std::nullopt;
}

/// A value that the data would rather have beyond what its law allows: they follow another law. "" if there is none.
Told Doubts::ValueAtItsLimit(const Explanation& found) const {
  for (auto k = static_cast<std::size_t>(found.started); k < found.chosen.size(); ++k)
    if (const auto* value = NumberAtItsLimit(strokes_.model(), found.chosen[k], options_.limit_share))
      return Tell(
          "{} of {} comes out at the limit of what it may be: another law of this kind may be at work",
          "{} von {} liegt an der Grenze des Zulässigen: es kann ein anderes Gesetz dieser Art sein",
          value->name, strokes_.model().effects[found.chosen[k].effect]->id);
  return {};
}

/// An effect that a test off the log says is there, and that is not in the model; "" if there is none.
std::string Doubts::MeasuredAndLeftOut(const ExtendedFit& fit) const {
  const auto& effects = strokes_.model().effects;
  for (int e = 0; e < static_cast<int>(effects.size()); ++e)
    if (ranking_.IsConfirmed(e) && std::none_of(fit.effects.begin(), fit.effects.end(),
                                                [&](const auto& in) { return in.choice.effect == e; }))
      return effects[static_cast<std::size_t>(e)]->id;
  return "";
}

Told Doubts::Of(const Explanation& found, bool at_floor) const {
  const double gain = ranking_.Gain(start_.fit, found.final);
  if (const std::string known = MeasuredAndLeftOut(found.final); !known.empty()) {
    return Tell(
        "the test off the log says that {} is there, which is not in this model: it may be part of the size found",
        "die Prüfung ohne Log sagt, dass {} da ist, was in diesem Modell fehlt: die gefundene Größe kann es enthalten",
        known);
  }
  const bool more = found.remainder > options_.doubt_remainder + options_.doubt_share * gain;
  if ((!at_floor || more) && !found.remainder_law.empty()) {
    return Tell("it leaves something that another law would explain ({})",
                "es bleibt etwas, das ein anderes Gesetz erklären würde ({})", found.remainder_law);
  }
  if (!at_floor || found.final.excess_ratio > options_.doubt_excess) {
    return Tell("it leaves {:.0f} % more energy than sensor noise",
                "es bleiben {:.0f} % mehr Energie als das Sensorrauschen", 100 * found.final.excess_ratio);
  }
  if (found.margin < options_.doubt_margin) {
    return Tell("a law without a name explains the error as well ({})",
                "ein Gesetz ohne Namen erklärt den Fehler ebenso gut ({})", found.margin_law);
  }
  if (MayBeChance(found)) {
    return Tell(
        "without it the error is no larger than noise, and of so many effects one may stand out by chance",
        "ohne ihn ist der Fehler nicht größer als das Rauschen, und von so vielen Effekten kann einer "
        "zufällig hervortreten");
  }
  if (auto unseen = MayMoveBetweenRows(found); unseen && !unseen->integrated) {
    return std::move(unseen->why);
  }
  if (Told limit = ValueAtItsLimit(found); !limit.empty()) {
    return limit;
  }
  if (const auto blend = Relatives(found.groups)) {
    return Tell("{} and {} have similar signatures, and together they can pass for a third law",
                "{} und {} haben ähnliche Spuren und können zusammen als ein drittes Gesetz durchgehen",
                blend->first, blend->second);
  }
  if (const double least = LeastShare(found); least < options_.small_second) {
    return Tell(
        "one of the effects makes {:.1f} % of the difference only, as much as the other may owe to a "
        "law that is not quite its own",
        "einer der Effekte macht nur {:.1f} % des Unterschieds aus, so viel wie am anderen liegen kann, wenn dessen "
        "Gesetz nicht ganz zutrifft",
        100 * least);
  }
  return {};
}

Told WhyNotProven(const Explanation& x) {
  if (x.set.empty() || (!x.partial && x.doubt.empty())) return {};
  return x.doubt.empty() ? Tell("more than noise is left", "es bleibt mehr als Rauschen") : x.doubt;
}

}  // namespace hydroscope
