#include "studies/plant_grade.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/contains.h"
#include "simulator/die_cushion/effects.h"
#include "simulator/die_cushion/plant_laws.h"
#include "studies/random_effect.h"

namespace hydroscope {
namespace {

constexpr double kNormal999 = 3.2905;       ///< half width of the 99.9 % interval, standard deviations
constexpr double kOffShare = 0.02;          ///< of the value, beyond its interval
constexpr double kOffSpool = 0.002;         ///< 1, the same for y_0, which is near 0
constexpr double kHighestPressure = 220e5;  ///< Pa, up to which K of a stiffening oil may be meant

struct TrueRange {
  double low, high;
  void Take(double value) { low = std::min(low, value), high = std::max(high, value); }
};

/// Every value that a base parameter had during the log.
std::map<std::string, TrueRange> TrueRanges(const PressOptions& o) {
  constexpr int kInstants = 50;
  const PressMachine& m = o.machine;
  const auto list = ResolveImperfections(o.imperfections).value();
  const PressEffectSizes effects = ResolveEffects(o.effects).value();
  const PlantMoments moments(list, o.seconds, o.seed);
  const double slope = PlantLawsOf(list).modulus_slope;
  std::map<std::string, TrueRange> ranges = {
      {"K", {m.K, m.K}}, {"V0", {m.V0, m.V0}}, {"Q_vn", {m.Q_vn, m.Q_vn}}, {"y_0", {m.y_0, m.y_0}}};
  for (int k = 0; k <= kInstants; ++k) {
    const double part = static_cast<double>(k) / kInstants;
    const double oil = o.oil_start + part * (o.oil_end - o.oil_start);
    const PlantMoments::Moment now = moments.At(part * o.seconds, oil, 0);
    ranges.at("K").Take(m.K * now.K_factor);
    ranges.at("K").Take(m.K * now.K_factor + slope * kHighestPressure);
    ranges.at("V0").Take(m.V0 * now.V0_factor);
    ranges.at("Q_vn").Take(m.Q_vn * now.gain * ViscosityGain(effects, oil));
    ranges.at("y_0").Take(m.y_0 + now.y_0_shift);
  }
  return ranges;
}

bool HasTrueName(const PlantCase& c, const std::vector<std::string>& group) {
  return std::any_of(group.begin(), group.end(),
                     [&](const std::string& id) { return Contains(c.right, id); });
}

/// Everything that was named: effects of all strokes, and of those that differ.
std::vector<std::vector<std::string>> Names(const PlantAnswer& answer) {
  std::vector<std::vector<std::string>> names = answer.groups;
  for (const auto& set : answer.odd)
    if (!set.empty()) names.push_back(set);
  return names;
}

bool AnyTrueName(const PlantCase& c, const PlantAnswer& answer) {
  const auto names = Names(answer);
  return std::any_of(names.begin(), names.end(), [&](const auto& group) { return HasTrueName(c, group); });
}

}  // namespace

const char* GradeName(PlantGrade grade) {
  switch (grade) {
    case PlantGrade::kRight:
      return "right";
    case PlantGrade::kWrong:
      return "wrong";
    case PlantGrade::kFlagged:
      return "wrong, flagged";
    case PlantGrade::kUnknown:
      return "unknown";
    case PlantGrade::kMissed:
      return "missed";
  }
  return "";
}

bool Identifiable(const PlantCase& c, double excess) {
  const PlantNature nature = c.kind->nature;
  if (nature == PlantNature::kRelative || nature == PlantNature::kFault) return false;
  return excess > kStrongError || excess < kNoticedError;
}

PlantGrade GradeAnswer(const PlantCase& c, const PlantAnswer& answer) {
  const bool refuse = c.kind->nature == PlantNature::kRefused;
  if (answer.refused) return refuse ? PlantGrade::kRight : PlantGrade::kUnknown;
  if (refuse && answer.verdict != Verdict::kUnknown) return PlantGrade::kWrong;
  if (AnyTrueName(c, answer)) return PlantGrade::kRight;
  if (!Names(answer).empty()) return answer.flagged ? PlantGrade::kFlagged : PlantGrade::kWrong;
  if (answer.verdict != Verdict::kAdequate || !answer.odd.empty()) return PlantGrade::kUnknown;
  return answer.excess > kStrongError ? PlantGrade::kMissed : PlantGrade::kRight;
}

bool ExtraName(const PlantCase& c, const PlantAnswer& answer) {
  if (answer.refused || !AnyTrueName(c, answer)) return false;
  const auto names = Names(answer);
  return std::any_of(names.begin(), names.end(), [&](const auto& group) { return !HasTrueName(c, group); });
}

std::string ParametersOff(const PlantCase& c, const std::vector<Estimate>& parameters) {
  std::string text;
  const auto ranges = TrueRanges(c.options);
  for (const Estimate& e : parameters) {
    const auto found = ranges.find(e.parameter);
    if (found == ranges.end()) continue;
    const TrueRange& range = found->second;
    const double distance = std::max({0.0, range.low - e.value, e.value - range.high});
    const double middle = std::abs(range.low + range.high) / 2;
    const double allowed = kNormal999 * e.std + (e.parameter == "y_0" ? kOffSpool : kOffShare * middle);
    if (distance > allowed)
      text += fmt::format("{} {:.4g} for {:.4g}...{:.4g} ", e.parameter, e.value, range.low, range.high);
  }
  return text;
}

}  // namespace hydroscope
