#include "workbench/states/experiment_output.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/short_number.h"
#include "diagnosis/experiment/rival_separation.h"
#include "models/state_effects.h"
#include "workbench/states/states_words.h"

namespace hydroscope {
namespace {

Told Moved(const StatesExplained& e, const TriedRecord& tried) {
  return MoveText(tried.move, *e.explanation.final.fit.model, e.log.episodes.front());
}

Told SeparationText(const StatesExplained& e) {
  const StateExperiment& x = e.experiment;
  if (!x.proposed())
    return Tell(
        "No record within what the inputs may be tells the rivals apart: the best, {}, has an expected separation of {:.0f} "
        "where {:.0f} is worth the while. Say under signals of [experiment] in the machine file what else the inputs may be "
        "run at, or measure another signal.",
        "Keine Aufzeichnung innerhalb dessen, was die Eingänge dürfen, trennt die Rivalen: die beste, {}, hat eine erwartete "
        "Trennung von {:.0f}, erst {:.0f} lohnt. Unter signals von [experiment] in der Maschinendatei sagen, wie die Eingänge "
        "sonst gefahren werden dürfen, oder ein weiteres Signal messen.",
        x.tried.empty() ? Tell("none", "keine") : Moved(e, x.tried.front()),
        x.tried.empty() ? x.now.separation : x.tried.front().separation, kExperiment.worthwhile);
  const TriedRecord& best = x.tried.front();
  return Tell(
      "Record {} ({:.3g} s; expected separation {:.0f}, now {:.0f}, {:.0f} settles it); then explain "
      "this log and that one together.{}",
      "Aufzeichnen: {} ({:.3g} s; erwartete Trennung {:.0f}, jetzt {:.0f}, {:.0f} klärt es); dann diese und jene "
      "Aufzeichnung zusammen erklären lassen.{}",
      Moved(e, best), best.seconds, best.separation, x.now.separation, kExperiment.settled,
      x.settles() ? Told{} : Tell(" It may not be enough.", " Vielleicht reicht es nicht."));
}

/// Share of the standard error as recorded that the best record must leave at most, or records are not what is wanting.
constexpr double kHelps = 0.9;

/// Whether no record would tell the rivals apart, or show the parameters that are asked for: what one of them changes the others
/// make up for.
bool NoRecordHelps(const StateExperiment& x) {
  if (!x.rivals.empty()) return !x.proposed();
  return !x.tried.empty() && x.tried.front().standard_error > kHelps * x.now.standard_error;
}

Told UnseenParametersText(const StatesExplained& e) {
  const StateExperiment& x = e.experiment;
  const std::string names = fmt::format("{}", fmt::join(x.unseen, ", "));
  if (NoRecordHelps(x))
    return Tell(
        "No record of these signals shows {}: whatever the inputs do, the outputs hardly change if {}. Write a value in "
        "place of one of them into the machine file, or measure another signal.",
        "Keine Aufzeichnung dieser Signale zeigt {}: was die Eingänge auch tun, die Ausgänge ändern sich kaum, wenn {}. Für "
        "einen davon einen Wert in die Maschinendatei schreiben oder ein weiteres Signal messen.",
        names,
        x.unseen.size() > 1 ? Tell("they move together", "sie sich gemeinsam ändern")
                            : Tell("it moves", "er sich ändert"));
  if (!x.proposed())
    return Tell(
        "These data do not see {}, and no record within what the inputs may be shows all of them. Say under signals of "
        "[experiment] in the machine file what else the inputs may be run at.",
        "Diese Daten sehen {} nicht, und keine Aufzeichnung innerhalb dessen, was die Eingänge dürfen, zeigt alle. Unter "
        "signals von [experiment] in der Maschinendatei sagen, wie die Eingänge sonst gefahren werden dürfen.",
        names);
  const TriedRecord& best = x.tried.front();
  return Tell(
      "To see {}, record {} ({:.3g} s): standard errors of at most {:.2g} % of the value in place of {:.2g} %; then "
      "explain this log and that one together.",
      "Um {} zu sehen, aufzeichnen: {} ({:.3g} s): Standardfehler von höchstens {:.2g} % des Wertes statt {:.2g} %; dann diese "
      "und jene Aufzeichnung zusammen erklären lassen.",
      names, Moved(e, best), best.seconds, 100 * best.standard_error, 100 * x.now.standard_error);
}

nlohmann::json SignalsJson(const StatesExplained& e, const TriedRecord& tried) {
  nlohmann::json signals = nlohmann::json::array();
  const Machine& machine = e.log.machine;
  for (const RecordMove::Levels& levels : tried.move.inputs)
    signals.push_back({{"signal", machine.signals[levels.signal].name},
                       {"speed", false},
                       {"levels", {{levels.from, levels.to}}}});
  if (!tried.move.course) return signals;
  nlohmann::json levels = nlohmann::json::array();
  for (const double level : tried.move.course->levels) levels.push_back({level, level});
  signals.push_back({{"signal", tried.move.course->signal}, {"speed", false}, {"levels", levels}});
  return signals;
}

nlohmann::json TriedJson(const StatesExplained& e, const TriedRecord& tried) {
  nlohmann::json out = {
      {"record", Moved(e, tried).english},
      {"signals", SignalsJson(e, tried)},
      {"times_as_fast", tried.move.speed},
      {"course", tried.move.course ? nlohmann::json(tried.move.course->name.english) : nlohmann::json()},
      {"seconds", tried.seconds}};
  if (e.experiment.rivals.empty())
    out["standard_error"] = tried.standard_error;
  else
    out["separation"] = tried.separation;
  return out;
}

/// Of effects that explain a part, but are not named: records that show them where this one does not.
std::vector<Told> TestsOfNearest(const StatesExplained& e) {
  std::vector<Told> text;
  if (e.explanation.verdict != Verdict::kUnknown) return text;
  const std::vector<Effect> library = StateEffectsOf(e.log.machine);
  for (const std::string& id : e.explanation.nearest)
    if (const Effect* effect = FindStateEffect(library, id); effect != nullptr && !effect->shown_by.empty())
      text.push_back(
          Tell("To test {}, record {}.", "Um {} zu prüfen, aufzeichnen: {}.", id, effect->shown_by));
  return text;
}

}  // namespace

std::optional<Told> StatesToRecord(const StatesExplained& e) {
  std::vector<Told> text = TestsOfNearest(e);
  if (e.only_zeros()) text.push_back(ZerosToRead(*e.zeros, e.log.machine));
  if (!e.experiment.rivals.empty())
    text.push_back(SeparationText(e));
  else if (!e.experiment.unseen.empty())
    text.push_back(UnseenParametersText(e));
  return text.empty() ? std::nullopt : std::optional(Joined(text, " "));
}

std::string RecordTable(const StatesExplained& e) {
  constexpr std::size_t kShown = 8;
  const StateExperiment& x = e.experiment;
  if (x.tried.empty() || NoRecordHelps(x)) return "";
  const bool rivals = !x.rivals.empty();
  std::string text = fmt::format("\nWhat to record, best first\n  {:>10} {:>9}  {}\n",
                                 rivals ? "separation" : "std error", "s", "record");
  const auto line = [&](const TriedRecord& tried, const std::string& what) {
    const std::string worth =
        rivals ? fmt::format("{:.0f}", tried.separation) : ShortNumber(100 * tried.standard_error, 2) + " %";
    text += fmt::format("  {:>10} {:>9}  {}\n", worth, ShortNumber(tried.seconds), what);
  };
  for (std::size_t k = 0; k < std::min(kShown, x.tried.size()); ++k)
    line(x.tried[k], Moved(e, x.tried[k]).english);
  line(x.now, "what was recorded, alone");
  return text;
}

nlohmann::json ExperimentPlanJson(const StatesExplained& e) {
  const StateExperiment& x = e.experiment;
  if (!x.proposed()) return nullptr;
  nlohmann::json plan = TriedJson(e, x.tried.front());
  plan["strokes"] = 1;
  plan["unseen"] = x.unseen;
  plan["rivals"] = x.rivals;
  plan[x.rivals.empty() ? "standard_error_now" : "separation_now"] =
      x.rivals.empty() ? x.now.standard_error : x.now.separation;
  plan["tried"] = nlohmann::json::array();
  for (const TriedRecord& tried : x.tried) plan["tried"].push_back(TriedJson(e, tried));
  return plan;
}

}  // namespace hydroscope
