#include <fmt/format.h>

#include <cmath>

#include "core/constants.h"
#include "core/relative_change.h"
#include "core/units.h"
#include "diagnosis/drift/drift_monitor.h"

namespace hydroscope::drift {
namespace {

constexpr double kLeakagePressure = 2e7;  ///< Pa, at which leakage is stated: 200 bar

std::string PartText(const FindingPart& part) {
  if (part.unit == "m3/(s Pa)") {
    const double factor = 6e4 * kLeakagePressure;
    return fmt::format("{} {:+.2f} ± {:.2f} l/min at 200 bar", part.quantity, part.size * factor,
                       kNormal95 * part.std * factor);
  }
  if (part.share) return fmt::format("{} {:+.3f} ± {:.3f} %", part.quantity, 100 * part.size, 196 * part.std);
  const DisplayUnit unit = DisplayUnitFor(part.unit);
  const std::string name = part.unit == "1" ? "" : fmt::format(" {}", unit.name);
  const std::string values = fmt::format("{:.4g} -> {:.4g}{}", part.reference * unit.factor + unit.offset,
                                         (part.reference + part.size) * unit.factor + unit.offset, name);
  if (const auto share = RelativeChange(part.reference, part.std, part.size))
    return fmt::format("{} {:+.1f} ± {:.1f} % ({})", part.quantity, 100 * *share,
                       196 * part.std / std::abs(part.reference), values);
  return fmt::format("{} {:+.3g} ± {:.2g}{} ({})", part.quantity, part.size * unit.factor,
                     kNormal95 * part.std * unit.factor, name, values);
}

}  // namespace

std::string FindingText(const DriftFinding& finding, const char* counted) {
  const ChangeTime& since = finding.since;
  std::string text =
      fmt::format("since {} {}{}: {}", counted, since.last_before + 1,
                  since.low == since.high ? "" : fmt::format(" ({} to {})", since.low + 1, since.high + 1),
                  finding.name.empty() ? "something changed; its cause is not told apart yet" : finding.name);
  for (std::size_t i = 0; i < finding.parts.size(); ++i)
    text += (i == 0 ? "; " : ", ") + PartText(finding.parts[i]);
  for (std::size_t i = 0; i < finding.rivals.size(); ++i)
    text += (i == 0 ? "; would explain as much: " : ", ") + finding.rivals[i];
  return text;
}

}  // namespace hydroscope::drift
