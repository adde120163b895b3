#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/units.h"
#include "service/axis_monitor.h"
#include "service/commands.h"
#include "service/history_options.h"
#include "service/live/real_clock.h"
#include "service/output.h"

namespace hydroscope {
namespace {

struct LearnArguments {
  HistoryOptions history;
  std::string machine, user, comment, json;
};

/// Learns one machine's reference; what was learned as JSON.
Result<nlohmann::json> LearnOne(const LearnArguments& a, const Database& database,
                                const HistoryChoice& choice, const drift::RuleBook& rules,
                                AlarmJournal& journal) {
  const HistoryPart& part = choice.parts.front();
  Machine machine = choice.machine;
  machine.name = part.machine;
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
    text += fmt::format("  {:<6} {:>10.4g} {:<6} over oil temperature: {}, {:.0f} to {:.0f} degC\n",
                        curve.at("quantity").get<std::string>(),
                        curve.at("value").get<double>() * unit.factor + unit.offset, unit.name,
                        curve.at("form").get<std::string>(), curve.at("from_K").get<double>() - 273.15,
                        curve.at("to_K").get<double>() - 273.15);
  }
  return text;
}

int RunLearn(const LearnArguments& a) {
  const auto history = OpenHistory(a.history, a.machine);
  if (!history) return ReportError(history.error());
  const auto rules = a.machine.empty() ? Result<drift::RuleBook>(drift::DefaultRules()) : RulesFor(a.machine);
  if (!rules) return ReportError(rules.error());
  auto journal = AlarmJournal::Open(AlarmJournal::PathFor(a.history.db));
  if (!journal) return ReportError(journal.error());
  nlohmann::json document = {{"learned", nlohmann::json::array()}};
  for (const HistoryChoice& choice : history->choices) {
    auto learned = LearnOne(a, history->database, choice, *rules, *journal);
    if (!learned) return ReportError(learned.error());
    if (a.json != "-") std::cout << LearnedText(*learned);
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
  command->add_option("--json", a->json, "Write the result as JSON; - is stdout");
  command->footer(
      "Needed where the rules file says freeze = \"command\", and after a repair or a change of oil. Every "
      "reference is\n"
      "a version of its own in the journal; alarms of the one before are cleared.\n"
      "Examples:\n"
      "  hydroscope learn --db press.db --machine press.toml\n"
      "  hydroscope learn --db press.db --machine-name press/cushion_2 --from 2025-03-01 --comment \"new "
      "seal\"");
  command->callback([a, &exit_code] {
    if (a->user.empty())
      if (const char* user = std::getenv("USER"); user != nullptr) a->user = user;
    exit_code = RunLearn(*a);
  });
}

}  // namespace hydroscope
