#include "simulator/die_cushion/imperfections.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/nearest_or_all.h"
#include "simulator/die_cushion/sensors.h"

namespace hydroscope {
namespace {

Result<const ImperfectionInfo*> FindKind(const std::string& name) {
  std::vector<std::string> names;
  for (const ImperfectionInfo& info : PressImperfections()) {
    if (info.name == name) return &info;
    names.push_back(info.name);
  }
  return UsageError("the simulator knows no imperfection '{}'; {}", name, NearestOrAll(name, names));
}

Status TakeExtra(const ImperfectionInfo& info, const std::string& name, double value, Imperfection& one) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < info.extras.size(); ++k) {
    names.push_back(info.extras[k].name);
    if (names.back() != name) continue;
    if (!std::isfinite(value) || value < 0)
      return UsageError("imperfection {}: {} is {}; it must be 0 {} or more", info.name, name, value,
                        info.extras[k].unit);
    one.extras[k] = value;
    return {};
  }
  if (names.empty()) return UsageError("imperfection {} has no further number; found '{}'", info.name, name);
  return UsageError("imperfection {} knows no '{}'; {}", info.name, name, NearestOrAll(name, names));
}

Status TakeChannel(const ImperfectionInfo& info, const std::string& given, Imperfection& one) {
  if (info.channel.empty()) {
    if (given.empty()) return {};
    return UsageError("imperfection {} acts on no channel; found '{}'", info.name, given);
  }
  const std::string& name = given.empty() ? info.channel : given;
  if (name == "all") return {};
  one.channel = ChannelIndex(name);
  if (one.channel) return {};
  std::vector<std::string> names(kPressChannels.begin(), kPressChannels.end());
  names.emplace_back("all");
  return UsageError("imperfection {} on unknown channel '{}'; {}", info.name, name,
                    NearestOrAll(name, names));
}

}  // namespace

Result<std::vector<Imperfection>> ResolveImperfections(const std::vector<ImperfectionSetting>& settings) {
  std::vector<Imperfection> list;
  for (const ImperfectionSetting& setting : settings) {
    const auto info = TRY(FindKind(setting.kind));
    Imperfection one;
    one.kind = info->kind;
    one.size = setting.size;
    for (const EffectExtra& extra : info->extras) one.extras.push_back(extra.value);
    if (!(setting.size >= info->low && setting.size <= info->high))
      return UsageError("imperfection {} is {} {}; it must lie between {} and {} {}", setting.kind,
                        setting.size, info->unit, info->low, info->high, info->unit);
    TRY(TakeChannel(*info, setting.channel, one));
    for (const auto& [name, value] : setting.extra) TRY(TakeExtra(*info, name, value, one));
    list.push_back(std::move(one));
  }
  return list;
}

const Imperfection* FindImperfection(const std::vector<Imperfection>& list, ImperfectionKind kind) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Imperfection& one) { return one.kind == kind; });
  return found == list.end() ? nullptr : &*found;
}

}  // namespace hydroscope
