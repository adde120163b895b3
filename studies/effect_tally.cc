#include "studies/effect_tally.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/contains.h"

namespace hydroscope {
namespace {

constexpr const char* kNone = "-";

}  // namespace

void EffectTally::Counts::Add(const Counts& other) {
  cases += other.cases;
  first += other.first;
  ambiguous += other.ambiguous;
  unknown += other.unknown;
  adequate += other.adequate;
  wrong += other.wrong;
}

std::string EffectTally::Add(const std::string& hidden, double size, const StatesExplanation& x) {
  const bool named = Contains(x.set, hidden);
  const bool wrong = !x.set.empty() && !named;
  counts_[hidden].Add({1, !x.set.empty() && x.set.front() == hidden, x.verdict == Verdict::kAmbiguous,
                       x.verdict == Verdict::kUnknown, x.verdict == Verdict::kAdequate, wrong});
  // How much the hidden effect explains by itself, in noise variances: what is too small cannot be named.
  const auto own = std::ranges::find_if(
      x.ranking, [&](const StateCandidate& c) { return c.added == std::vector<std::string>{hidden}; });
  return fmt::format(
      "hidden {:<22} {:<9.3g} {:<9} [{}]{} left {:.3f} -> {:.3f}{}{}", hidden, size, VerdictName(x.verdict),
      fmt::join(x.set, ", "), x.nearest.empty() ? "" : fmt::format(" part {}", fmt::join(x.nearest, ", ")),
      x.base_left.share, x.final_left.share,
      own == x.ranking.end() ? "" : fmt::format(", gains {:.0f}", own->gain), wrong ? " WRONG" : "");
}

EffectTally::Counts EffectTally::Hidden() const {
  Counts all;
  for (const auto& [id, counts] : counts_)
    if (id != kNone) all.Add(counts);
  return all;
}

std::string EffectTally::Table() const {
  std::string text = fmt::format("\n{:<22} {:>5} {:>6} {:>10} {:>8} {:>9} {:>6}\n", "hidden", "logs", "first",
                                 "ambiguous", "unknown", "adequate", "wrong");
  const auto line = [&](const std::string& id, const Counts& c) {
    text += fmt::format("{:<22} {:>5} {:>6} {:>10} {:>8} {:>9} {:>6}\n", id, c.cases, c.first, c.ambiguous,
                        c.unknown, c.adequate, c.wrong);
  };
  for (const auto& [id, counts] : counts_)
    if (id != kNone) line(id, counts);
  line("all effects", Hidden());
  if (const auto none = counts_.find(kNone); none != counts_.end()) line("nothing", none->second);
  return text;
}

bool EffectTally::Reached() const {
  Counts all;
  for (const auto& [id, counts] : counts_) all.Add(counts);
  const Counts hidden = Hidden();
  return hidden.first >= 0.95 * hidden.cases && all.wrong <= 0.01 * all.cases;
}

}  // namespace hydroscope
