#include "workbench/explain/odd_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "models/counted_words.h"
#include "models/find_effect.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRun = 3;  ///< strokes one after another of which only the first and the last are told

/// Name of the log that a stroke is of; "" where there is one log alone.
std::string LogOf(const LogStrokes& log, std::size_t stroke) {
  const auto at = static_cast<std::size_t>(log.strokes[stroke].gram.log);
  return log.logs > 1 && at < log.log_names.size() ? log.log_names[at] : std::string();
}

/// "3 (at 12.4 s), 9 to 14 (40.1 to 93.7 s)"; of several logs "3 (of b.csv, at 12.4 s)".
Told PlacesOf(const LogStrokes& log, const std::vector<std::size_t>& strokes) {
  const auto summary = [&](std::size_t at) -> const StrokeSummary& {
    return log.strokes[strokes[at]].summary;
  };
  Told places;
  for (std::size_t first = 0, next = 0; first < strokes.size(); first = next) {
    for (next = first + 1; next < strokes.size(); ++next)
      if (strokes[next] != strokes[next - 1] + 1 || LogOf(log, strokes[next]) != LogOf(log, strokes[first]))
        break;
    if (next - first < kRun) next = first + 1;
    const StrokeSummary &begin = summary(first), &end = summary(next - 1);
    const std::string name = LogOf(log, strokes[first]);
    const Told of = name.empty() ? Told() : Tell("of {}, ", "von {}, ", name);
    const Told place = next == first + 1
                           ? Tell("{} ({}at {:.1f} s)", "{} ({}bei {:.1f} s)", begin.index, of, begin.begin)
                           : Tell("{} to {} ({}{:.1f} to {:.1f} s)", "{} bis {} ({}{:.1f} bis {:.1f} s)",
                                  begin.index, end.index, of, begin.begin, end.begin);
    places = places.empty() ? place : Tell("{}, {}", "{}, {}", places, place);
  }
  return places;
}

/// Titles and ids of effects of which one or several are at work.
Told NamesOf(const ModelStructure& model, const std::vector<std::string>& ids) {
  Told names;
  for (const std::string& id : ids) {
    const auto at = FindEffect(model, id);
    const Effect* effect = at ? model.effects[static_cast<std::size_t>(*at)].get() : nullptr;
    const Told name =
        effect ? Tell("{} ({})", "{} ({})", Told(effect->title, effect->german.title), id) : Told(id, id);
    names = names.empty() ? name : Tell("{}, {}", "{}, {}", names, name);
  }
  return names;
}

/// "strokes 3 (at 12.4 s), 9 to 14 (40.1 to 93.7 s)".
Told WhichOf(const LogStrokes& log, const std::vector<std::size_t>& strokes) {
  const CountedWords words = CountedWordsOf(log.machine);
  const bool one = strokes.size() == 1;
  return Tell(
      "{} {}", "{} {}",
      Told(std::string(one ? words.one : words.many), std::string(one ? words.german : words.german_several)),
      PlacesOf(log, strokes));
}

}  // namespace

Told OddText(const ExplainResult& result, const OddStrokes& odd) {
  return OddText(result.log, result.explanation, odd);
}

Told OddText(const LogStrokes& log, const Explanation& explanation, const OddStrokes& odd) {
  const bool one = odd.strokes.size() == 1;
  const Told which = WhichOf(log, odd.strokes);
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
  if (odd.set == explanation.set)
    return Tell("this is so in {} alone; the others are described without it",
                "das gilt nur für {}; die übrigen sind ohne es beschrieben", which);
  const Told doubt =
      odd.doubt.empty() ? Told() : Tell(" (not proven: {})", " (nicht bewiesen: {})", odd.doubt);
  return Tell("{0} from the rest: in {1} alone there is besides {2}{3}. {4} left out",
              "{0} von den übrigen ab: nur dort gibt es außerdem {2}{3}. Das ist ausgelassen", differs,
              one ? "it" : "them", NamesOf(*explanation.model, odd.set), doubt, were);
}

std::vector<ToldOddStrokes> ToldOddStrokesOf(const LogStrokes& log, const Explanation& explanation) {
  std::vector<ToldOddStrokes> out;
  for (const OddStrokes& odd : explanation.odd_strokes) out.push_back({odd, OddText(log, explanation, odd)});
  return out;
}

std::vector<std::size_t> IndicesOf(const std::vector<ToldOddStrokes>& odd) {
  std::vector<std::size_t> out;
  for (const ToldOddStrokes& some : odd)
    out.insert(out.end(), some.odd.strokes.begin(), some.odd.strokes.end());
  std::ranges::sort(out);
  return out;
}

Told WhichDiffer(const LogStrokes& log, const std::vector<ToldOddStrokes>& odd) {
  const std::vector<std::size_t> strokes = IndicesOf(odd);
  const Told which = WhichOf(log, strokes);
  return strokes.size() == 1 ? Tell("{} differs from the rest", "{} weicht von den übrigen ab", which)
                             : Tell("{} differ from the rest", "{} weichen von den übrigen ab", which);
}

nlohmann::json OddStrokesJson(const LogStrokes& log, const std::vector<ToldOddStrokes>& odd) {
  nlohmann::json out = nlohmann::json::array();
  for (const auto& [some, sentence] : odd) {
    nlohmann::json strokes = nlohmann::json::array(), begin = nlohmann::json::array();
    nlohmann::json logs = nlohmann::json::array();
    for (const std::size_t s : some.strokes) {
      strokes.push_back(log.strokes[s].summary.index);
      begin.push_back(log.strokes[s].summary.begin);
      if (const std::string name = LogOf(log, s); !name.empty()) logs.push_back(name);
    }
    out.push_back({{"strokes", strokes},
                   {"begin_s", begin},
                   {"set", some.set},
                   {"parameter", some.parameter},
                   {"doubt", some.doubt.english},
                   {"sentence", sentence.english},
                   {"german", {{"sentence", sentence.german}}}});
    if (!logs.empty()) out.back()["logs"] = logs;
  }
  return out;
}

}  // namespace hydroscope
