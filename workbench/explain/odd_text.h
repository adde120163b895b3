#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// Strokes that differ from the rest, and OddText of them.
struct ToldOddStrokes {
  OddStrokes odd;
  Told sentence;
};

/// Which strokes differ from the rest and what is so in them, a sentence without its full stop: "strokes 3 (at 12.4 s),
/// 9 (at 40.1 s) differ from the rest: in them alone there is ... too". `odd` is one of the explanation's.
Told OddText(const LogStrokes& log, const Explanation& explanation, const OddStrokes& odd);
Told OddText(const ExplainResult& result, const OddStrokes& odd);
/// All of an explanation of the strokes of `log`.
std::vector<ToldOddStrokes> ToldOddStrokesOf(const LogStrokes& log, const Explanation& explanation);

/// All strokes of `odd`, as indices in order.
std::vector<std::size_t> IndicesOf(const std::vector<ToldOddStrokes>& odd);
/// "strokes 3 (at 12.4 s), 9 to 14 (40.1 to 93.7 s) differ from the rest", of all strokes of `odd`.
Told WhichDiffer(const LogStrokes& log, const std::vector<ToldOddStrokes>& odd);
/// `odd_strokes` of `explain` and `compare`.
nlohmann::json OddStrokesJson(const LogStrokes& log, const std::vector<ToldOddStrokes>& odd);

}  // namespace hydroscope
