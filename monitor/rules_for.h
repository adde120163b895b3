#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "diagnosis/drift/rules.h"
#include "models/model_structure.h"

namespace hydroscope {

/// The rules file beside a machine file, "press.toml" -> "press_rules.toml", if there is one; else, and without a machine
/// file (""), the built-in rules as they are for this kind of machine.
Result<drift::RuleBook> RulesFor(const std::string& machine_file, const Machine& machine);

/// Where a rules file and a machine do not fit, as sentences: what it watches that the machine has not, and parameters that
/// it leaves unwatched. Nothing of the built-in rules, which are for every machine.
std::vector<std::string> RuleRemarks(const drift::RuleBook& rules, const ModelStructure& model);

}  // namespace hydroscope
