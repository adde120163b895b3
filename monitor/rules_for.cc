#include "monitor/rules_for.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/contains.h"
#include "diagnosis/drift/drift_thresholds.h"
#include "diagnosis/drift/valve_check_monitor.h"
#include "models/machine_file/table.h"
#include "models/machine_kind.h"

namespace hydroscope {

Result<drift::RuleBook> RulesFor(const std::string& machine_file, const Machine& machine) {
  const std::filesystem::path path(machine_file);
  const auto rules = path.parent_path() / (path.stem().string() + "_rules.toml");
  std::error_code ignored;
  if (!machine_file.empty() && std::filesystem::exists(rules, ignored))
    return drift::LoadRules(rules.string());
  drift::RuleBook built_in = drift::DefaultRules();
  // Episodes are longer than strokes, and there are fewer of them.
  if (InEpisodes(KindOf(machine))) built_in.commissioning = drift::kDriftThresholds.least_strokes;
  return built_in;
}

std::vector<std::string> RuleRemarks(const drift::RuleBook& rules, const ModelStructure& model) {
  if (rules.file.empty()) return {};
  std::vector<std::string> remarks, parameters, known;
  for (const DerivedParameter& p : model.derive(Eigen::VectorXd::Ones(model.base_count)))
    parameters.push_back(p.name);
  known = parameters;
  for (const auto& effect : model.effects) known.push_back(effect->id);
  known.insert(known.end(), drift::ValveCheckMonitor::kFigureNames.begin(),
               drift::ValveCheckMonitor::kFigureNames.end());
  for (const drift::WatchSpec& watch : rules.watches)
    if (!Contains(known, watch.quantity))
      remarks.push_back(fmt::format("{} watches {}, which this machine has not: {}parameters are {}",
                                    rules.file, watch.quantity, DidYouMean(watch.quantity, known).english,
                                    Listed(parameters)));
  std::vector<std::string> unwatched;
  for (const std::string& name : parameters)
    if (rules.Find(name) == nullptr) unwatched.push_back(name);
  // Of which it watches none, all are watched.
  if (!unwatched.empty() && unwatched.size() < parameters.size())
    remarks.push_back(fmt::format(
        "{} leaves {} unwatched: a drift there is not seen. To watch {}: [watch] {} = {{ change = 0.05 }}",
        rules.file, Listed(unwatched), unwatched.size() == 1 ? "it" : "the first", unwatched.front()));
  return remarks;
}

}  // namespace hydroscope
