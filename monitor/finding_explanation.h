#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "diagnosis/drift/drift_monitor.h"
#include "diagnosis/explain.h"
#include "storage/database.h"

namespace hydroscope {

/// Strokes since a change at which it is compared with those before; what then stays open is compared again
/// with more.
inline constexpr std::array<std::int64_t, 3> kStrokesToExplain = {24, 60, 150};

/// Compares the strokes before and after a finding by the engine of `hydroscope explain --since`, from stored
/// Grams alone, and says in one or two sentences what changed: effects that appeared with their sizes,
/// parameters that moved, and how far the error on strokes left out fell. At most 300 strokes on either side
/// are used: those before from `first_healthy` to `healthy_end` (EndOfHealthy); `end` is behind the newest stroke. What the
/// comparison does not prove is told as such. Never fails: what prevented it is what it says.
drift::FindingExplanation ExplainFinding(const Database& database, const std::string& path,
                                         const std::string& machine, std::int64_t machine_id,
                                         const drift::DriftFinding& finding, std::int64_t first_healthy,
                                         std::int64_t healthy_end, std::int64_t end);

/// Behind the last stroke that none of the change is in. The tests begin anew where a finding is named, within
/// DriftThresholds::most_to_explain strokes: what else the same change did is found beside it and dated later, so a finding
/// that begins by then is compared with the strokes before the first of them.
std::int64_t EndOfHealthy(const drift::DriftFinding& finding,
                          const std::vector<drift::DriftFinding>& findings);

/// What a finding is called where the comparison does not see its quantities move, but others (`moved`), or effects (`set`) of
/// which one did it, or which are named without proof, and none is what its rule is about; "": as its rule names it.
Told TitleBeside(const drift::DriftFinding& finding, Verdict verdict, const std::vector<std::string>& set,
                 const std::vector<std::string>& moved);

}  // namespace hydroscope
