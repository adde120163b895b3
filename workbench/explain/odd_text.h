#pragma once

#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// Which strokes differ from the rest and what is so in them, a sentence without its full stop: "strokes 3 (at 12.4 s),
/// 9 (at 40.1 s) differ from the rest: in them alone there is ... too". `odd` is one of the explanation's.
Told OddText(const ExplainResult& result, const OddStrokes& odd);

}  // namespace hydroscope
