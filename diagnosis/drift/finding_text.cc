#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/effect_units.h"
#include "core/interval_text.h"
#include "core/relative_change.h"
#include "core/unit_told.h"
#include "core/units.h"
#include "diagnosis/drift/drift_monitor.h"
#include "models/machine_kind.h"

namespace hydroscope::drift {
namespace {

/// "-1.50 ± 0.40 %"
Told PercentTold(double share, double half_width) {
  return TellNumber(ChangeWithInterval(100 * share, 100 * half_width) + " %");
}

Told NameOf(const FindingPart& part) {
  return part.title.empty() ? Told(part.quantity, part.quantity) : part.title;
}

Told PartText(const FindingPart& part) {
  const Told quantity = NameOf(part);
  if (part.share) return Tell("{} {}", "{} {}", quantity, PercentTold(part.size, kNormal95 * part.std));
  if (part.reference == 0) {  // an effect that is absent when healthy
    const EffectUnit unit = EffectUnitFor(part.unit);
    return Tell("{} {} {}", "{} {} {}", quantity,
                TellNumber(ChangeWithInterval(part.size * unit.factor, kNormal95 * part.std * unit.factor)),
                UnitTold(unit.name));
  }
  const DisplayUnit unit = DisplayUnitFor(part.unit);
  const Told unit_name = part.unit == "1" ? Told{} : UnitTold(fmt::format(" {}", unit.name));
  const double before = part.reference * unit.factor + unit.offset, change = part.size * unit.factor,
               half = kNormal95 * part.std * unit.factor;
  const int digits = DigitsFor(before, half);
  const Told values =
      Tell("{}{}", "{}{}",
           TellNumber(fmt::format("{:.{}g} -> {:.{}g}", before, digits, before + change, digits)), unit_name);
  const auto share = part.relative ? RelativeChange(part.reference, part.std, part.size) : std::nullopt;
  if (share && *share <= -1)
    return Tell("{} beyond anything physical", "{} jenseits alles physikalisch Möglichen", quantity);
  if (share)
    return Tell("{} {} ({})", "{} {} ({})", quantity,
                PercentTold(*share, kNormal95 * part.std / std::abs(part.reference)), values);
  return Tell("{} {}{} ({})", "{} {}{} ({})", quantity, TellNumber(ChangeWithInterval(change, half)),
              unit_name, values);
}

}  // namespace

bool FindingPart::moved() const { return !reversed && std::abs(size) > kNormal95 * std; }

bool DriftFinding::nameless() const {
  return !described() && !parts.empty() && std::ranges::none_of(parts, &FindingPart::moved);
}

CountedIn CountedInOf(const MachineKind& kind) {
  if (InEpisodes(kind)) return {Tell("episode", "Episode"), Tell("episodes", "Episoden")};
  return {};
}

CountedIn ValveChecksCounted() {
  return {Tell("valve check", "Ventilprüfung"), Tell("valve checks", "Ventilprüfungen"), false};
}

Told SinceText(const DriftFinding& finding, const CountedIn& counted) {
  const ChangeTime& since = finding.since;
  const Told between =
      since.low == since.high ? Told{} : Tell(" ({} to {})", " ({} bis {})", since.low + 1, since.high + 1);
  return Tell("since {} {}{}", "seit {} {}{}", counted.one, since.last_before + 1, between);
}

Told NameText(const DriftFinding& finding) {
  if (!finding.compared.cause_title.empty()) return finding.compared.cause_title;
  if (finding.nameless())
    return Tell("Change that the model does not describe", "Änderung, die das Modell nicht beschreibt");
  if (!finding.described() && !finding.rule.empty())
    return Tell("Change that the model does not describe; nearest: {}",
                "Änderung, die das Modell nicht beschreibt; am nächsten kommt: {}", finding.name);
  if (!finding.name.empty()) return finding.name;
  return Tell("something changed; its cause is not told apart yet",
              "etwas hat sich geändert; die Ursache ist noch nicht zu unterscheiden");
}

Told SizesText(const DriftFinding& finding) {
  std::vector<Told> parts, sizes;
  for (const FindingPart& part : finding.parts)
    parts.push_back(finding.nameless() ? NameOf(part) : PartText(part));
  if (!parts.empty())
    sizes.push_back(finding.nameless()
                        ? Tell("whether {} moved cannot be told now",
                               "ob {} sich bewegt hat, ist jetzt nicht zu sagen", Joined(parts))
                        : Joined(parts));
  if (!finding.rivals.empty())
    sizes.push_back(Tell("would explain as much: {}", "ebenso viel würde erklären: {}",
                         fmt::format("{}", fmt::join(finding.rivals, ", "))));
  return Joined(sizes, "; ");
}

std::string FindingText(const DriftFinding& finding, const CountedIn& counted) {
  const std::string sizes = SizesText(finding).english;
  return fmt::format("{}: {}{}{}", SinceText(finding, counted).english, NameText(finding).english,
                     sizes.empty() ? "" : "; ", sizes);
}

}  // namespace hydroscope::drift
