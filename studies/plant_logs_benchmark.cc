#include "studies/plant_logs_benchmark.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <iostream>

#include "core/units.h"
#include "host/output.h"
#include "pipeline/geometry_tolerance.h"
#include "simulator/die_cushion/press.h"
#include "studies/parallel.h"
#include "studies/simulated_strokes.h"
#include "workbench/explain/explain_log.h"
#include "workbench/fit_suspicion.h"

namespace hydroscope {
namespace {

struct PlantOutcome {
  PlantCase drawn;
  PlantAnswer answer;
  PlantGrade grade = PlantGrade::kUnknown;
  bool fitted = false, fit_warned = false;
  std::string fit_off;  ///< parameters that are off, "" = none
  std::string said;     ///< the verdict, or why there is none
};

Result<LogStrokes> StrokesOfPlant(const PressOptions& options, KeepSamples keep) {
  Machine machine = MachineFor(options);
  AssumeTolerances(machine);
  return StrokesOf(SimulatePress(options), machine, keep);
}

/// Held-out error of the base model on a simulated log, nullopt if it cannot be fitted.
std::optional<double> BaseError(const PressOptions& options) {
  const auto strokes = StrokesOfPlant(options, KeepSamples::kNo);
  if (!strokes) return std::nullopt;
  const auto fit = FitBaseModel(*strokes->model, strokes->Grams(), strokes->window);
  return fit ? std::optional(fit->rms_holdout) : std::nullopt;
}

/// How much what is hidden raises the error of the base model.
double ExcessOf(const PlantCase& c) {
  const auto is_law = [](const PlantKind* kind) {
    return kind->nature == PlantNature::kLibrary || kind->nature == PlantNature::kRelative;
  };
  if (c.options.effects.empty() && std::ranges::none_of(c.imperfections, is_law)) return 0;
  const auto found = BaseError(c.ToBeFound()), reference = BaseError(c.Reference());
  return found && reference && *reference > 0 ? std::max(0.0, *found / *reference - 1) : 0;
}

void FitPlant(const LogStrokes& strokes, PlantOutcome& out) {
  const auto fit = FitBaseModel(*strokes.model, strokes.Grams(), strokes.window);
  if (!fit) return;
  out.fitted = true;
  out.fit_off = ParametersOff(out.drawn, fit->parameters);
  out.fit_warned = std::any_of(fit->parameters.begin(), fit->parameters.end(),
                               [](const Estimate& e) { return e.reason != EstimateReason::kUpdated; });
}

void ExplainPlant(LogStrokes strokes, PlantOutcome& out) {
  const auto explained = ExplainStrokes(std::move(strokes));
  out.answer.refused = !explained;
  out.fit_warned = out.fit_warned || !explained || SuspicionOf(*explained).suspected;
  if (!explained) {
    out.said = explained.error().text;
    return;
  }
  const Explanation& x = explained->explanation;
  out.answer.verdict = x.verdict;
  out.answer.flagged = x.partial || !x.doubt.empty();
  out.answer.groups = x.groups;
  for (const OddStrokes& odd : x.odd_strokes) out.answer.odd.push_back(odd.set);
  std::vector<std::string> groups;
  for (const auto& group : x.groups) groups.push_back(fmt::format("{}", fmt::join(group, "|")));
  for (const auto& set : out.answer.odd) groups.push_back(fmt::format("odd: {}", fmt::join(set, "|")));
  out.said = fmt::format("{} {} {} {}", VerdictName(x.verdict), fmt::join(groups, " + "), x.doubt.english,
                         fmt::join(InEnglish(x.warnings), "; "));
}

PlantOutcome RunPlantCase(PlantCase drawn) {
  PlantOutcome out;
  out.drawn = std::move(drawn);
  out.answer.excess = ExcessOf(out.drawn);
  auto strokes = StrokesOfPlant(out.drawn.options, KeepSamples::kYes);
  if (strokes) {
    FitPlant(*strokes, out);
    ExplainPlant(std::move(*strokes), out);
  } else {
    out.answer.refused = true;
    out.said = strokes.error().text;
  }
  out.grade = GradeAnswer(out.drawn, out.answer);
  return out;
}

PlantTally TallyOf(const PlantOutcome& o) {
  PlantTally t;
  t.cases = 1;
  t.right = o.grade == PlantGrade::kRight;
  t.wrong = o.grade == PlantGrade::kWrong;
  t.flagged = o.grade == PlantGrade::kFlagged;
  t.unknown = o.grade == PlantGrade::kUnknown;
  t.missed = o.grade == PlantGrade::kMissed;
  t.extra = ExtraName(o.drawn, o.answer);
  t.identifiable = Identifiable(o.drawn, o.answer.excess);
  t.identifiable_unknown = t.identifiable != 0 && (t.unknown != 0 || t.missed != 0);
  t.fits = o.fitted;
  t.fit_off = o.fitted && !o.fit_off.empty() && !o.fit_warned;
  return t;
}

std::string DetailLine(int index, const PlantOutcome& o) {
  std::string hidden;
  for (const EffectSetting& e : o.drawn.options.effects) hidden += fmt::format("{}={:.3g} ", e.id, e.size);
  for (const ImperfectionSetting& s : o.drawn.options.imperfections) {
    if (!hidden.empty() && hidden.back() != ' ') hidden += ' ';
    hidden += fmt::format("{}={:.3g}", s.kind, s.size);
    for (const auto& [name, value] : s.extra) hidden += fmt::format(",{}={:.4g}", name, value);
    if (!s.channel.empty()) hidden += ",on=" + s.channel;
  }
  return fmt::format("{}\t{}\t{}\t{}\t{:.3f}\t{}\t{}\t{}\t{}\t{}\t{}", index, o.drawn.kind->name,
                     GradeName(o.grade), ExtraName(o.drawn, o.answer) ? "extra" : "", o.answer.excess,
                     Identifiable(o.drawn, o.answer.excess) ? "identifiable" : "", hidden, o.said,
                     o.answer.flagged ? "flagged" : "", o.fit_off, o.fit_warned ? "fit warned" : "");
}

Result<std::vector<const PlantKind*>> KindsNamed(const std::vector<std::string>& names) {
  std::vector<const PlantKind*> kinds;
  std::vector<std::string> known;
  for (const PlantKind& kind : PlantKinds()) {
    known.push_back(kind.name);
    if (names.empty()) kinds.push_back(&kind);
  }
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      const std::string nearest = Nearest(name, known);
      return nearest.empty() ? UsageError("no kind '{}'; there are {}", name, fmt::join(known, ", "))
                             : UsageError("no kind '{}'; did you mean '{}'?", name, nearest);
    }
    kinds.push_back(&PlantKinds()[found - known.begin()]);
  }
  return kinds;
}

double ShareOf(int part, int whole) { return whole > 0 ? static_cast<double>(part) / whole : 0.0; }

void PrintTally(const std::string& name, const PlantTally& t) {
  std::cout << fmt::format("{:<33}{:>6}{:>7}{:>7}{:>9}{:>7}{:>9}{:>8}{:>10}/{:<4}{:>6}/{:<4}\n", name,
                           t.cases, t.right, t.wrong, t.flagged, t.extra, t.unknown, t.missed,
                           t.identifiable_unknown, t.identifiable, t.fit_off, t.fits);
}

}  // namespace

void PlantTally::Add(const PlantTally& o) {
  cases += o.cases;
  right += o.right;
  wrong += o.wrong;
  flagged += o.flagged;
  extra += o.extra;
  unknown += o.unknown;
  missed += o.missed;
  identifiable += o.identifiable;
  identifiable_unknown += o.identifiable_unknown;
  fits += o.fits;
  fit_off += o.fit_off;
}

std::vector<std::string> PlantGoals::Missed(const PlantTally& t) const {
  std::vector<std::string> lines;
  const auto check = [&](const char* what, int part, int whole, double limit) {
    const double share = ShareOf(part, whole);
    if (share > limit)
      lines.push_back(fmt::format("{}: {:.1f} %, allowed {:.1f} %", what, 100 * share, 100 * limit));
  };
  check("wrong", t.wrong, t.cases, wrong);
  check("wrong but flagged", t.flagged, t.cases, flagged);
  check("unknown or missed where identifiable", t.identifiable_unknown, t.identifiable, unknown);
  check("fit off without a word", t.fit_off, t.fits, fit_off);
  return lines;
}

Result<PlantLogsResult> RunPlantLogs(const PlantLogsOptions& o) {
  const auto kinds = TRY(KindsNamed(o.kinds));
  std::vector<PlantOutcome> outcomes(static_cast<std::size_t>(o.cases));
  ProgressBar progress("plant logs", "logs");
  ForEachCase(
      o.cases, progress,
      [&](int k) { outcomes[k] = RunPlantCase(DrawPlantCase(o.first + k, o.seed, kinds, o.further)); },
      o.threads);
  PlantLogsResult result;
  for (const PlantKind* kind : kinds) result.kinds.emplace_back(kind->name, PlantTally{});
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    const PlantTally tally = TallyOf(outcomes[k]);
    const int number = o.first + static_cast<int>(k);
    result.kinds[static_cast<std::size_t>(number) % kinds.size()].second.Add(tally);
    result.all.Add(tally);
    result.details.push_back(DetailLine(number, outcomes[k]));
    if (tally.wrong != 0) result.wrong.push_back(result.details.back());
  }
  return result;
}

int RunPlantLogsBenchmark(const PlantLogsOptions& o) {
  const auto result = RunPlantLogs(o);
  if (!result) return ReportError(result.error());
  std::cout << fmt::format("{} simulated logs of 60 ... 180 s, {} kinds of imperfection, seed {}\n\n",
                           o.cases, result->kinds.size(), o.seed);
  std::cout << fmt::format("{:<33}{:>6}{:>7}{:>7}{:>9}{:>7}{:>9}{:>8}{:>15}{:>11}\n", "", "cases", "right",
                           "wrong", "flagged", "extra", "unknown", "missed", "unk./identif.", "fit off");
  for (const auto& [name, tally] : result->kinds)
    if (tally.cases > 0) PrintTally(name, tally);
  PrintTally("all", result->all);
  const PlantTally& t = result->all;
  std::cout << fmt::format(
      "\nwrong {:.1f} %, wrong but flagged {:.1f} %, unknown or missed {:.1f} % of those identifiable, a "
      "second name without cause {:.1f} %, fit off without a word {:.1f} %\n",
      100 * ShareOf(t.wrong, t.cases), 100 * ShareOf(t.flagged, t.cases),
      100 * ShareOf(t.identifiable_unknown, t.identifiable), 100 * ShareOf(t.extra, t.cases),
      100 * ShareOf(t.fit_off, t.fits));
  if (!o.details.empty()) {
    std::ofstream file(o.details);
    file << "case\tkind\tgrade\textra\texcess\tidentifiable\thidden\tsaid\tflagged\tfit off\tfit warned\n";
    for (const std::string& line : result->details) file << line << '\n';
  }
  if (!result->wrong.empty())
    std::cout << fmt::format("\nwrong (number, kind, ... as --details has it)\n{}\n",
                             fmt::join(result->wrong, "\n"));
  const std::vector<std::string> missed = PlantGoals().Missed(t);
  for (const std::string& line : missed) std::cout << line << '\n';
  std::cout << (missed.empty() ? "\nall goals reached\n" : "\nNOT all goals reached\n");
  return missed.empty() ? 0 : 1;
}

}  // namespace hydroscope
