#include "workbench/explain/odd_text.h"

#include <fmt/format.h>

#include "models/counted_words.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRun = 3;  ///< strokes one after another of which only the first and the last are told

/// "3 (at 12.4 s), 9 to 14 (40.1 to 93.7 s)".
Told PlacesOf(const ExplainResult& result, const OddStrokes& odd) {
  const auto summary = [&](std::size_t at) -> const StrokeSummary& {
    return result.log.strokes[odd.strokes[at]].summary;
  };
  Told places;
  for (std::size_t first = 0, next = 0; first < odd.strokes.size(); first = next) {
    for (next = first + 1; next < odd.strokes.size(); ++next)
      if (odd.strokes[next] != odd.strokes[next - 1] + 1) break;
    if (next - first < kRun) next = first + 1;
    const StrokeSummary &begin = summary(first), &end = summary(next - 1);
    const Told place = next == first + 1
                           ? Tell("{} (at {:.1f} s)", "{} (bei {:.1f} s)", begin.index, begin.begin)
                           : Tell("{} to {} ({:.1f} to {:.1f} s)", "{} bis {} ({:.1f} bis {:.1f} s)",
                                  begin.index, end.index, begin.begin, end.begin);
    places = places.empty() ? place : Tell("{}, {}", "{}, {}", places, place);
  }
  return places;
}

/// Titles and ids of effects of which one or several are at work.
Told NamesOf(const ExplainResult& result, const std::vector<std::string>& ids) {
  Told names;
  for (const std::string& id : ids) {
    const Effect* effect = result.FindEffect(id);
    const Told name =
        effect ? Tell("{} ({})", "{} ({})", Told(effect->title, effect->german.title), id) : Told(id, id);
    names = names.empty() ? name : Tell("{}, {}", "{}, {}", names, name);
  }
  return names;
}

}  // namespace

Told OddText(const ExplainResult& result, const OddStrokes& odd) {
  const CountedWords words = CountedWordsOf(result.log.machine);
  const bool one = odd.strokes.size() == 1;
  const Told which = Tell(
      "{} {}", "{} {}",
      Told(std::string(one ? words.one : words.many), std::string(one ? words.german : words.german_several)),
      PlacesOf(result, odd));
  const Told differs = one ? Tell("{} differs", "{} weicht", which) : Tell("{} differ", "{} weichen", which);
  const char* were = one ? "It was" : "They were";
  if (!odd.parameter.empty())
    return Tell(
        "{0} from the rest, and another value of {1} there, or one of its own in each, explains that as well as any effect does: "
        "the oil, the machine or a setting changed. {2} left out",
        "{0} von den übrigen ab, und ein anderer Wert von {1} dort, oder ein eigener in jedem, erklärt das so gut wie jeder Effekt: "
        "das Öl, die Maschine oder eine Einstellung hat sich geändert. Das ist ausgelassen",
        differs, odd.parameter, were);
  if (odd.set.empty())
    return Tell(
        "{} from the rest, and no effect of the library says how. {} left out; look at what happened there",
        "{} von den übrigen ab, und kein Effekt der Bibliothek sagt, wie. Das ist ausgelassen; zu prüfen ist, was dort geschah",
        differs, were);
  if (odd.set == result.explanation.set)
    return Tell("this is so in {} alone; the others are described without it",
                "das gilt nur für {}; die übrigen sind ohne es beschrieben", which);
  const Told doubt =
      odd.doubt.empty() ? Told() : Tell(" (not proven: {})", " (nicht bewiesen: {})", odd.doubt);
  return Tell("{0} from the rest: in {1} alone there is besides {2}{3}. {4} left out",
              "{0} von den übrigen ab: nur dort gibt es außerdem {2}{3}. Das ist ausgelassen", differs,
              one ? "it" : "them", NamesOf(result, odd.set), doubt, were);
}

}  // namespace hydroscope
