#include "monitor/learning.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "storage/journal_pairing.h"

namespace hydroscope {

bool LearningCandidate::Refused() const {
  return std::ranges::any_of(doubts, [](const LearningDoubt& d) { return d.Refuses(); });
}

Result<LearningCandidate> LookBeforeLearning(const Database& database, const std::string& path,
                                             const Machine& machine, const HistoryPart& part,
                                             const AlarmJournal& journal) {
  LearningCandidate candidate{machine, part, {}};
  candidate.machine.name = part.machine;
  const auto axis = TRY(journal.Axis(part.machine));
  if (part.strokes() > 0)
    candidate.doubts = DoubtsOfLearning(database, path, part, candidate.machine, axis.alarms);
  return candidate;
}

Result<nlohmann::json> LearnReference(const Database& database, const std::string& path,
                                      const LearningCandidate& candidate, const drift::RuleBook& rules,
                                      AlarmJournal& journal, const AlarmUser& user, double wall) {
  const HistoryPart& part = candidate.part;
  const auto model = TRY(BuildModel(candidate.machine));
  AxisMonitor axis(candidate.machine, model, rules, database, path, part.id, journal);
  TRY(axis.Learn(part.first, part.last, wall, user));
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

nlohmann::json DoubtsJson(const std::vector<LearningDoubt>& doubts) {
  nlohmann::json out = nlohmann::json::array();
  for (const LearningDoubt& doubt : doubts)
    out.push_back({{"kind", LearningDoubtName(doubt.kind)},
                   {"text", doubt.text.english},
                   {"german", doubt.text.InGerman()},
                   {"refuses", doubt.Refuses()}});
  return out;
}

Result<AlarmJournal> OpenJournalOf(const std::string& path, double wall, std::string& note) {
  auto database = TRY(Database::Open(path));
  const auto names = TRY(database.MachineNames());
  const std::string press = names.empty() ? "" : names.front().substr(0, names.front().find('/'));
  const auto set_aside = TRY(PairJournal(database, path, press, wall));
  if (set_aside) note = SetAsideText(*set_aside);
  return AlarmJournal::Open(AlarmJournal::PathFor(path));
}

}  // namespace hydroscope
