#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "core/constants.h"
#include "core/short_number.h"
#include "core/units.h"
#include "host/output.h"
#include "host/real_clock.h"
#include "models/counted_words.h"
#include "models/parameter_unit.h"
#include "monitor/learning.h"
#include "monitor/rules_for.h"
#include "workbench/history/history_options.h"

namespace hydroscope {
namespace {

struct LearnArguments {
  HistoryOptions history;
  std::string machine, user, comment, json;
  bool force = false;
};

/// What is to be learned, each looked at first.
Result<std::vector<LearningCandidate>> Candidates(const LearnArguments& a, const ChosenHistory& history,
                                                  const AlarmJournal& journal) {
  std::vector<LearningCandidate> candidates;
  for (const HistoryChoice& choice : history.choices) {
    auto candidate = TRY(
        LookBeforeLearning(history.database, a.history.db, choice.machine, choice.parts.front(), journal));
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

/// Tells what speaks against learning; an error if any of it refuses and nobody insists.
Status TellDoubts(const LearnArguments& a, const std::vector<LearningCandidate>& candidates) {
  std::string refused;
  for (const LearningCandidate& c : candidates) {
    for (const LearningDoubt& doubt : c.doubts)
      SayBeside(fmt::format("{} {} {} to {}: {}\n", c.part.machine, CountedWordsOf(c.machine).many,
                            c.part.first, c.part.last - 1, doubt.text.english));
    if (c.Refused()) refused += (refused.empty() ? "" : ", ") + c.part.machine;
  }
  if (refused.empty() || a.force) return {};
  return BadInput(
      "nothing was learned: what is stored of {} does not look like a healthy machine. Choose others "
      "with --from and --to, or insist with --force",
      refused);
}

std::string LearnedText(const nlohmann::json& learned, const Machine& machine) {
  const CountedWords counted = CountedWordsOf(machine);
  std::string text = fmt::format(
      "{}: reference {} learned from {} {} to {}, {} kinds of {}\n", learned.at("machine").get<std::string>(),
      learned.at("reference_version").get<int>(), counted.many,
      learned.at("first_stroke").get<std::int64_t>(), learned.at("last_stroke").get<std::int64_t>(),
      learned.at("operating_classes").get<int>(), counted.one);
  for (const auto& curve : learned.at("curves")) {
    const auto quantity = curve.at("quantity").get<std::string>(), si = curve.at("unit").get<std::string>();
    const DisplayUnit unit = ParameterUnit(KindOf(machine), quantity, si);
    text += fmt::format("  {:<6} {:>10} {:<6}", quantity,
                        ShortNumber(curve.at("value").get<double>() * unit.factor + unit.offset, 4),
                        unit.name == "-" ? "" : unit.name);
    const double from = curve.at("from_K").get<double>(), to = curve.at("to_K").get<double>();
    if (std::isfinite(from))  // oil temperature is measured
      text += fmt::format(" over oil temperature: {}, {:.0f} to {:.0f} degC",
                          curve.at("form").get<std::string>(), from - kZeroCelsius, to - kZeroCelsius);
    text += "\n";
  }
  return text;
}

Status RunLearn(const LearnArguments& a) {
  const auto history = TRY(OpenHistory(a.history, a.machine));
  const auto rules = TRY(RulesFor(a.machine, history.choices.front().machine));
  std::string note;
  auto journal = TRY(OpenJournalOf(a.history.db, WallSeconds(), note));
  if (!note.empty()) SayBeside("note: " + note + "\n");
  const auto candidates = TRY(Candidates(a, history, journal));
  nlohmann::json document = {{"learned", nlohmann::json::array()}, {"refused", nlohmann::json::array()}};
  if (const Status may = TellDoubts(a, candidates); !may) {
    for (const LearningCandidate& c : candidates)
      if (c.Refused())
        document["refused"].push_back({{"machine", c.part.machine},
                                       {"first_stroke", c.part.first},
                                       {"last_stroke", c.part.last - 1},
                                       {"doubts", DoubtsJson(c.doubts)}});
    if (!a.json.empty()) TRY(WriteJson(a.json, document));
    return may;
  }
  for (const LearningCandidate& candidate : candidates) {
    auto learned = TRY(LearnReference(history.database, a.history.db, candidate, rules, journal,
                                      {a.user, a.comment}, WallSeconds()));
    if (a.json != "-") Say(LearnedText(learned, candidate.machine));
    document["learned"].push_back(std::move(learned));
  }
  return a.json.empty() ? Status() : WriteJson(a.json, document);
}

}  // namespace

void AddLearnCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<LearnArguments>();
  CLI::App* command =
      app.add_subcommand("learn",
                         "Learns the healthy machine from stored strokes or episodes and freezes it: "
                         "drift is judged against it from then on");
  command->add_option("--db,-d", a->history.db, "Database that replay or serve fills")->required();
  command->add_option("--machine-name", a->history.machines,
                      "Machine of the database, repeatable; all without it");
  command->add_option("--from", a->history.from,
                      "First stroke or episode: number, log (run:3), time (81.5s) or date (2025-03-01)");
  command->add_option("--to", a->history.to, "Stroke or episode before which to stop, likewise");
  command->add_option("--machine,-m", a->machine,
                      "Machine file whose rules file (press.toml -> press_rules.toml) says what is watched");
  command->add_option("--user", a->user, "Who acts (default: the user logged in)");
  command->add_option("--comment", a->comment, "Why, kept in the journal");
  command->add_flag("--force", a->force, "Learn, whatever speaks against it");
  command->add_option("--json", a->json, "Write the result as JSON; - is stdout");
  command->footer(
      "Needed where the rules file says freeze = \"command\", and after a repair or a "
      "change of oil. Every reference is\n"
      "a version of its own in the journal; alarms of the one before are cleared. What "
      "is learned from is explained\n"
      "first: an effect in them, a change, an open alarm or several versions of the "
      "model are told, and nothing is\n"
      "learned without --force.\n"
      "Examples:\n"
      "  hydroscope learn --db press.db --machine press.toml\n"
      "  hydroscope learn --db press.db --machine-name press/cushion_2 --from 2025-03-01 --comment \"new seal\"");
  RunsAs(*command, exit_code, [a] {
    if (a->user.empty())
      if (const char* user = std::getenv("USER"); user != nullptr) a->user = user;
    return RunLearn(*a);
  });
}

}  // namespace hydroscope
