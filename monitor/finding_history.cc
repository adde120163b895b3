#include "monitor/finding_history.h"

#include <algorithm>

#include "diagnosis/drift/serial.h"
#include "monitor/axis_alarms.h"

namespace hydroscope {
namespace {

bool IsNamed(const drift::DriftFinding& finding) {
  return finding.state == drift::FindingState::kNamed && !finding.parts.empty();
}

std::map<std::string, int> MovementsOf(const drift::DriftFinding& finding) {
  std::map<std::string, int> movements;
  for (const drift::FindingPart& part : finding.parts) movements[part.quantity] = part.size > 0 ? 1 : -1;
  return movements;
}

}  // namespace

void FindingHistory::Follow(const std::vector<drift::DriftFinding>& findings, std::int64_t stroke,
                            double time) {
  for (StandingFinding& known : findings_) {
    if (known.to != StandingFinding::kStillStands) continue;
    const bool stands = std::ranges::any_of(
        findings, [&](const drift::DriftFinding& f) { return f.number == known.number && IsNamed(f); });
    if (stands) continue;
    known.to = stroke;
    known.to_time = time;
  }
  for (const drift::DriftFinding& finding : findings) {
    const bool known = std::ranges::any_of(findings_, [&](const StandingFinding& k) {
      return k.number == finding.number && k.to == StandingFinding::kStillStands;
    });
    if (known || !IsNamed(finding)) continue;
    findings_.push_back({finding.number, finding.since.last_before + 1, stroke, StandingFinding::kStillStands,
                         time, 0, AlarmIdOf(finding), MovementsOf(finding)});
  }
  if (findings_.size() > kRemembered) findings_.erase(findings_.begin(), findings_.end() - kRemembered);
}

void FindingHistory::Save(ByteWriter& out) const {
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(findings_.size()));
  for (const StandingFinding& f : findings_) {
    for (const std::int64_t value : {f.number, f.since, f.from, f.to}) out.Put(value);
    out.Put(f.from_time);
    out.Put(f.to_time);
    drift::PutText(out, f.alarm);
    out.Put<std::uint32_t>(static_cast<std::uint32_t>(f.movements.size()));
    for (const auto& [quantity, direction] : f.movements) {
      drift::PutText(out, quantity);
      out.Put(direction);
    }
  }
}

bool FindingHistory::Restore(ByteReader& in) {
  findings_.clear();
  for (auto left = in.Get<std::uint32_t>(); left > 0 && in.ok(); --left) {
    StandingFinding f;
    for (std::int64_t* value : {&f.number, &f.since, &f.from, &f.to}) *value = in.Get<std::int64_t>();
    f.from_time = in.Get<double>();
    f.to_time = in.Get<double>();
    f.alarm = drift::GetText(in);
    for (auto moved = in.Get<std::uint32_t>(); moved > 0 && in.ok(); --moved) {
      const std::string quantity = drift::GetText(in);
      f.movements[quantity] = in.Get<int>();
    }
    findings_.push_back(std::move(f));
  }
  return in.ok();
}

}  // namespace hydroscope
