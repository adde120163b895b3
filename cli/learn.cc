#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "core/constants.h"
#include "core/units.h"
#include "host/output.h"
#include "host/real_clock.h"
#include "monitor/axis_monitor.h"
#include "monitor/learning_check.h"
#include "monitor/rules_for.h"
#include "storage/journal_pairing.h"
#include "workbench/history/history_options.h"

namespace hydroscope {
namespace {

struct LearnArguments {
  HistoryOptions history;
  std::string machine, user, comment, json;
  bool force = false;
};

/// A machine that may be learned, or not.
struct Candidate {
  Machine machine;
  HistoryPart part;
  std::vector<LearningDoubt> doubts;

  bool Refused() const {
    return std::any_of(doubts.begin(), doubts.end(), [](const LearningDoubt& d) { return d.Refuses(); });
  }
};

nlohmann::json DoubtsJson(const std::vector<LearningDoubt>& doubts) {
  nlohmann::json out = nlohmann::json::array();
  for (const LearningDoubt& doubt : doubts)
    out.push_back(
        {{"kind", LearningDoubtName(doubt.kind)}, {"text", doubt.text}, {"refuses", doubt.Refuses()}});
  return out;
}

/// What is to be learned, each looked at first.
Result<std::vector<Candidate>> Candidates(const LearnArguments& a, const ChosenHistory& history,
                                          const AlarmJournal& journal) {
  std::vector<Candidate> candidates;
  for (const HistoryChoice& choice : history.choices) {
    Candidate candidate{choice.machine, choice.parts.front(), {}};
    candidate.machine.name = candidate.part.machine;
    const auto axis = journal.Axis(candidate.part.machine);
    if (!axis) return tl::unexpected(axis.error());
    if (candidate.part.strokes() > 0)
      candidate.doubts =
          DoubtsOfLearning(history.database, a.history.db, candidate.part, candidate.machine, axis->alarms);
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

/// Tells what speaks against learning; an error if any of it refuses and nobody insists.
Status TellDoubts(const LearnArguments& a, const std::vector<Candidate>& candidates) {
  std::string refused;
  for (const Candidate& c : candidates) {
    for (const LearningDoubt& doubt : c.doubts)
      std::cerr << fmt::format("{} strokes {} to {}: {}\n", c.part.machine, c.part.first, c.part.last - 1,
                               doubt.text);
    if (c.Refused()) refused += (refused.empty() ? "" : ", ") + c.part.machine;
  }
  if (refused.empty() || a.force) return {};
  return BadInput(
      "nothing was learned: the strokes of {} do not look like those of a healthy machine. Choose others "
      "with --from and --to, or insist with --force",
      refused);
}

/// Learns one machine's reference; what was learned as JSON.
Result<nlohmann::json> LearnOne(const LearnArguments& a, const Database& database, const Candidate& candidate,
                                const drift::RuleBook& rules, AlarmJournal& journal) {
  const HistoryPart& part = candidate.part;
  const Machine& machine = candidate.machine;
  const auto model = BuildModel(machine);
  if (!model) return tl::unexpected(model.error());
  AxisMonitor axis(machine, *model, rules, database, a.history.db, part.id, journal);
  if (const Status learned = axis.Learn(part.first, part.last, WallSeconds(), {a.user, a.comment}); !learned)
    return tl::unexpected(learned.error());
  const drift::Reference& reference = axis.monitor()->reference();
  nlohmann::json curves = nlohmann::json::array();
  const auto& quantities = axis.monitor()->model().quantities();
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    const drift::TemperatureModel& curve = reference.curves()[q];
    if (quantities[q].effect) continue;
    curves.push_back({{"quantity", quantities[q].name},
                      {"unit", quantities[q].unit},
                      {"form", curve.FormName()},
                      {"from_K", curve.low()},
                      {"to_K", curve.high()},
                      {"value", curve.At((curve.low() + curve.high()) / 2).value}});
  }
  return nlohmann::json{{"machine", part.machine},
                        {"reference_version", reference.version()},
                        {"first_stroke", reference.first_sequence()},
                        {"last_stroke", reference.last_sequence()},
                        {"operating_classes", reference.classes().count()},
                        {"doubts", DoubtsJson(candidate.doubts)},
                        {"curves", std::move(curves)}};
}

std::string LearnedText(const nlohmann::json& learned) {
  std::string text =
      fmt::format("{}: reference {} learned from strokes {} to {}, {} kinds of stroke\n",
                  learned.at("machine").get<std::string>(), learned.at("reference_version").get<int>(),
                  learned.at("first_stroke").get<std::int64_t>(),
                  learned.at("last_stroke").get<std::int64_t>(), learned.at("operating_classes").get<int>());
  for (const auto& curve : learned.at("curves")) {
    const DisplayUnit unit = DisplayUnitFor(curve.at("unit").get<std::string>());
    text += fmt::format("  {:<6} {:>10.4g} {:<6}", curve.at("quantity").get<std::string>(),
                        curve.at("value").get<double>() * unit.factor + unit.offset,
                        unit.name == "1" ? "" : unit.name);
    const double from = curve.at("from_K").get<double>(), to = curve.at("to_K").get<double>();
    if (std::isfinite(from))  // oil temperature is measured
      text += fmt::format(" over oil temperature: {}, {:.0f} to {:.0f} degC",
                          curve.at("form").get<std::string>(), from - kZeroCelsius, to - kZeroCelsius);
    text += "\n";
  }
  return text;
}

/// The journal beside the database; one of another database is set aside.
Result<AlarmJournal> OpenOwnJournal(const LearnArguments& a) {
  auto database = Database::Open(a.history.db);
  if (!database) return tl::unexpected(database.error());
  const auto names = database->MachineNames();
  if (!names) return tl::unexpected(names.error());
  const std::string press = names->empty() ? "" : names->front().substr(0, names->front().find('/'));
  const auto set_aside = PairJournal(*database, a.history.db, press, WallSeconds());
  if (!set_aside) return tl::unexpected(set_aside.error());
  if (*set_aside) std::cerr << "note: " << SetAsideText(**set_aside) << "\n";
  return AlarmJournal::Open(AlarmJournal::PathFor(a.history.db));
}

int RunLearn(const LearnArguments& a) {
  const auto history = OpenHistory(a.history, a.machine);
  if (!history) return ReportError(history.error());
  const auto rules = RulesFor(a.machine, history->choices.front().machine);
  if (!rules) return ReportError(rules.error());
  auto journal = OpenOwnJournal(a);
  if (!journal) return ReportError(journal.error());
  const auto candidates = Candidates(a, *history, *journal);
  if (!candidates) return ReportError(candidates.error());
  nlohmann::json document = {{"learned", nlohmann::json::array()}, {"refused", nlohmann::json::array()}};
  if (const Status may = TellDoubts(a, *candidates); !may) {
    for (const Candidate& c : *candidates)
      if (c.Refused())
        document["refused"].push_back({{"machine", c.part.machine},
                                       {"first_stroke", c.part.first},
                                       {"last_stroke", c.part.last - 1},
                                       {"doubts", DoubtsJson(c.doubts)}});
    if (!a.json.empty())
      if (const Status written = WriteJson(a.json, document); !written) return ReportError(written.error());
    return ReportError(may.error());
  }
  for (const Candidate& candidate : *candidates) {
    auto learned = LearnOne(a, history->database, candidate, *rules, *journal);
    if (!learned) return ReportError(learned.error());
    if (a.json != "-") Say(LearnedText(*learned));
    document["learned"].push_back(std::move(*learned));
  }
  if (a.json.empty()) return kDone;
  const Status written = WriteJson(a.json, document);
  return written ? kDone : ReportError(written.error());
}

}  // namespace

void AddLearnCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<LearnArguments>();
  CLI::App* command = app.add_subcommand("learn",
                                         "Learns the healthy machine from stored strokes and freezes it: "
                                         "drift is judged against it from then on");
  command->add_option("--db,-d", a->history.db, "Database that replay or serve fills")->required();
  command->add_option("--machine-name", a->history.machines,
                      "Machine of the database, repeatable; all without it");
  command->add_option("--from", a->history.from,
                      "First stroke: number, log (run:3), time (81.5s) or date (2025-03-01)");
  command->add_option("--to", a->history.to, "Stroke before which to stop, likewise");
  command->add_option("--machine,-m", a->machine,
                      "Machine file whose rules file (press.toml -> press_rules.toml) says what is watched");
  command->add_option("--user", a->user, "Who acts (default: the user logged in)");
  command->add_option("--comment", a->comment, "Why, kept in the journal");
  command->add_flag("--force", a->force, "Learn, whatever speaks against the strokes");
  command->add_option("--json", a->json, "Write the result as JSON; - is stdout");
  command->footer(
      "Needed where the rules file says freeze = \"command\", and after a repair or a change of oil. Every "
      "reference is\n"
      "a version of its own in the journal; alarms of the one before are cleared. The strokes are explained\n"
      "first: an effect in them, a change, an open alarm or several versions of the model are told, and "
      "nothing is\n"
      "learned without --force.\n"
      "Examples:\n"
      "  hydroscope learn --db press.db --machine press.toml\n"
      "  hydroscope learn --db press.db --machine-name press/cushion_2 "
      "--from 2025-03-01 --comment \"new seal\"");
  command->callback([a, &exit_code] {
    if (a->user.empty())
      if (const char* user = std::getenv("USER"); user != nullptr) a->user = user;
    exit_code = RunLearn(*a);
  });
}

}  // namespace hydroscope
