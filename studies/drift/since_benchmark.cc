#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <vector>

#include "core/contains.h"
#include "host/output.h"
#include "simulator/die_cushion/effects.h"
#include "simulator/die_cushion/press.h"
#include "studies/drift/drift_benchmarks.h"
#include "studies/random_effect.h"
#include "studies/simulated_replay.h"
#include "workbench/explain/explain_change.h"
#include "workbench/history/history_options.h"

namespace hydroscope {
namespace {

enum ChangeKind {
  kNewStrong,
  kNewWeak,
  kNewTooWeak,
  kNewBeside,
  kGrown,
  kParameterMoved,
  kEffectAsBefore,
  kHealthyAsBefore,
  kChangeKinds
};
constexpr std::array<const char*, kChangeKinds> kChangeNames = {"an effect appears, error +10 % or more",
                                                                "a weak effect appears, 2 ... 10 %",
                                                                "an effect appears, below 2 %",
                                                                "an effect appears beside another",
                                                                "an effect grows",
                                                                "only a parameter moves",
                                                                "an effect as before",
                                                                "healthy as before"};
constexpr bool Appears(ChangeKind kind) { return kind <= kNewBeside; }

/// One machine before and after.
struct MachineHistory {
  ChangeKind kind = kHealthyAsBefore;
  PressOptions before, after;
  std::vector<std::string> changed;  ///< effects that appeared or grew
  std::string refused;               ///< why the strokes cannot be explained, "" if they can
  ChangeResult result;
};

struct ChangeTally {
  int cases = 0, first = 0, in_set = 0, wrong = 0, beside = 0, silent = 0, unknown = 0, flagged = 0,
      refused = 0;
};

/// A log of the machine with a motion, noise and oil of its own.
PressOptions LogOfMachine(const PressOptions& machine, std::mt19937_64& random) {
  PressOptions log = machine;
  log.seed = random() >> 32;
  log.seconds = 60 + 120 * Uniform(random);
  log.oil_start = 298 + 10 * Uniform(random);
  log.oil_end = log.oil_start + 5 + 20 * Uniform(random);
  return log;
}

EffectSetting AnotherEffect(std::mt19937_64& random, const std::string& than) {
  EffectSetting effect = RandomEffect(random, 0.5, 2.0, true);
  while (effect.id == than) effect = RandomEffect(random, 0.5, 2.0, true);
  return effect;
}

/// By 5 ... 15 % of K', V0 or Q_vn, down or up.
void MoveParameter(std::mt19937_64& random, PressMachine& machine) {
  double* const parameters[] = {&machine.K, &machine.V0, &machine.Q_vn};
  const double share = 0.05 + 0.10 * Uniform(random);
  *parameters[random() % 3] *= Uniform(random) < 0.5 ? 1 + share : 1 - share;
}

MachineHistory DrawHistory(int index, const SinceOptions& o) {
  std::mt19937_64 random(o.seed * 1000003 + index);
  const PressOptions machine = RandomMachine(random() >> 32);
  MachineHistory h;
  h.before = LogOfMachine(machine, random);
  h.after = LogOfMachine(machine, random);
  switch (index % 10) {
    case 5:
      h.kind = kNewBeside;
      h.before.effects = {RandomEffect(random, 0.5, 2.0, true)};
      h.after.effects = {h.before.effects[0], AnotherEffect(random, h.before.effects[0].id)};
      h.changed = {h.after.effects[1].id};
      break;
    case 6:
      h.kind = kGrown;
      h.before.effects = h.after.effects = {RandomEffect(random, 0.3, 1.0, true)};
      h.after.effects[0].size *= 2 + 2 * Uniform(random);
      h.changed = {h.after.effects[0].id};
      break;
    case 7:
      h.kind = kParameterMoved;
      MoveParameter(random, h.after.machine);
      break;
    case 8:
      h.kind = kEffectAsBefore;
      h.before.effects = h.after.effects = {RandomEffect(random, 0.3, 2.0, true)};
      break;
    case 9:
      h.kind = kHealthyAsBefore;
      break;
    default:
      h.kind = kNewStrong;
      h.after.effects = {o.effect.empty() ? RandomEffect(random, 0.1, 2.0, true)
                                          : RandomSize(random, o.effect, 0.1, 2.0)};
      h.changed = {h.after.effects[0].id};
  }
  return h;
}

/// Replays the two logs into a database and asks what changed since the second one.
Status AskWhatChanged(MachineHistory& h) {
  const WorkFolder folder;
  const std::string database = folder.File("press.db");
  TRY(ReplaySimulated({h.before, h.after}, folder, database, ""));
  HistoryOptions options;
  options.db = database;
  const auto chosen = TRY(OpenHistory(options, ""));
  const auto sides = TRY(Split(chosen.database, database, chosen.choices.front(), "run:2"));
  auto result = ExplainChange(sides.first, sides.second);
  if (!result) {
    h.refused = result.error().text;
    return {};
  }
  h.result = std::move(*result);
  if (h.kind == kNewStrong) {
    const double excess = ErrorOverFloor(h.result.after.explanation.base);
    h.kind = excess >= kStrongError ? kNewStrong : excess >= kNoticedError ? kNewWeak : kNewTooWeak;
  }
  return {};
}

/// Whether one of the candidates for a cause is what changed.
bool IsRight(const MachineHistory& h, const std::vector<std::string>& group) {
  return std::ranges::any_of(group, [&](const auto& id) { return Contains(h.changed, id); });
}

/// Causes named that changed in no way.
std::ptrdiff_t WrongGroups(const MachineHistory& h) {
  const auto& groups = h.result.after.explanation.groups;
  return std::ranges::count_if(groups, [&](const auto& g) { return !IsRight(h, g); });
}

void CountAnswer(const MachineHistory& h, ChangeTally& t) {
  const Explanation& x = h.result.after.explanation;
  ++t.cases;
  t.refused += !h.refused.empty();
  if (!h.refused.empty()) return;
  t.silent += x.verdict == Verdict::kAdequate;
  t.unknown += x.verdict == Verdict::kUnknown;
  if (x.set.empty()) return;
  const bool right = IsRight(h, x.set);
  t.first += Contains(h.changed, x.set.front());
  t.in_set += right;
  t.wrong += !right;
  t.beside += right && WrongGroups(h) > 0;
  t.flagged += x.partial;
}

std::string SettingsText(const std::vector<EffectSetting>& effects) {
  std::string text;
  for (const EffectSetting& e : effects) text += fmt::format("{}={:.3g} ", e.id, e.size);
  return text;
}

std::string GroupsText(const Explanation& x) {
  std::string text;
  for (const auto& group : x.groups)
    text += (text.empty() ? "" : " + ") + fmt::format("{}", fmt::join(group, "|"));
  return text;
}

std::string MovedText(const std::vector<ValueChange>& values) {
  std::string text;
  for (const ValueChange& v : values)
    if (v.significant) text += fmt::format("{} {:.3g} -> {:.3g} ", v.name, v.before, v.after);
  return text;
}

void WriteHistories(const std::string& path, const std::vector<MachineHistory>& histories) {
  std::ofstream file(path);
  file << "case\tkind\tbefore\tafter\tverdict\tgroups\tfound before\texcess base\tfinal\tgain first\t"
          "gain second\tremainder\tlaw\tdoubt\tmoved\tnewest\trefused\n";
  int index = 0;
  for (const MachineHistory& h : histories) {
    const Explanation &was = h.result.before.explanation, &x = h.result.after.explanation;
    const auto gain = [](const std::vector<RankedEffect>& r) { return r.empty() ? 0.0 : r.front().gain; };
    file << fmt::format(
        "{}\t{}\t{}\t{}\t{}\t{}\t{} {}\t{:.3f}\t{:.3f}\t{:.0f}\t{:.0f}\t{:.0f}\t{}\t{}\t{}{}\t{}\t{}\n",
        index++, kChangeNames[h.kind], SettingsText(h.before.effects), SettingsText(h.after.effects),
        VerdictName(x.verdict), GroupsText(x), VerdictName(was.verdict), GroupsText(was), x.base.excess_ratio,
        x.final.excess_ratio, gain(x.ranking), gain(x.second), x.remainder, x.remainder_law, x.doubt.english,
        MovedText(h.result.parameters), MovedText(h.result.effects), h.result.newest, h.refused);
  }
}

double InPercent(int part, int whole) { return whole > 0 ? 100.0 * part / whole : 0.0; }

void PrintAnswers(const std::array<ChangeTally, kChangeKinds>& tallies) {
  fmt::print("{:<40}{:>6}{:>7}{:>8}{:>7}{:>8}{:>8}{:>9}{:>9}{:>9}\n", "", "cases", "first", "in set", "wrong",
             "beside", "silent", "unknown", "flagged", "refused");
  for (int k = 0; k < kChangeKinds; ++k) {
    const ChangeTally& t = tallies[k];
    fmt::print("{:<40}{:>6}{:>7}{:>8}{:>7}{:>8}{:>8}{:>9}{:>9}{:>9}\n", kChangeNames[k], t.cases, t.first,
               t.in_set, t.wrong, t.beside, t.silent, t.unknown, t.flagged, t.refused);
  }
}

/// At most 2 % of the answers where something changed name what did not, at most 1 % where nothing did; of
/// strong effects two thirds stand first.
bool GoalsReached(const std::array<ChangeTally, kChangeKinds>& tallies) {
  int changed = 0, changed_wrong = 0, same = 0, same_wrong = 0;
  for (int k = 0; k < kChangeKinds; ++k) {
    const bool changes = Appears(static_cast<ChangeKind>(k)) || k == kGrown;
    (changes ? changed : same) += tallies[k].cases;
    (changes ? changed_wrong : same_wrong) += tallies[k].wrong + tallies[k].beside;
  }
  fmt::print(
      "\nnamed though it did not change: {} of {} histories with a change ({:.1f} %, at most 2 %), {} of {} "
      "without ({:.1f} %, at most 1 %)\n",
      changed_wrong, changed, InPercent(changed_wrong, changed), same_wrong, same,
      InPercent(same_wrong, same));
  const ChangeTally& strong = tallies[kNewStrong];
  fmt::print("strong effects first in the set: {:.1f} %, at least 66 %\n",
             InPercent(strong.first, strong.cases));
  return InPercent(changed_wrong, changed) <= 2 && InPercent(same_wrong, same) <= 1 &&
         3 * strong.first >= 2 * strong.cases;
}

bool KnowsEffect(const std::string& id) {
  const auto& effects = PressEffects();
  return std::ranges::any_of(effects, [&](const EffectInfo& e) { return e.id == id; });
}

}  // namespace

int RunSinceBenchmark(const SinceOptions& o) {
  if (!o.effect.empty() && !KnowsEffect(o.effect))
    return ReportError(UsageError("the simulator has no effect '{}'", o.effect).value());
  std::vector<MachineHistory> histories;
  std::array<ChangeTally, kChangeKinds> tallies;
  ProgressBar progress("what changed", "histories");
  for (int i = 0; i < o.cases; ++i) {
    MachineHistory h = DrawHistory(i, o);
    if (const Status asked = AskWhatChanged(h); !asked) return ReportError(asked.error());
    CountAnswer(h, tallies[h.kind]);
    histories.push_back(std::move(h));
    progress.Update((i + 1.0) / o.cases, i + 1);
  }
  fmt::print("{} histories of a machine, 60 ... 180 s before and after, seed {}\n\n", o.cases, o.seed);
  PrintAnswers(tallies);
  if (!o.details.empty()) WriteHistories(o.details, histories);
  const bool reached = GoalsReached(tallies);
  std::cout << (reached ? "\nall goals reached\n" : "\nNOT all goals reached\n");
  return reached ? 0 : 1;
}

}  // namespace hydroscope
