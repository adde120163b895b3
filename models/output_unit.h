#pragma once

#include <string_view>

#include "core/units.h"
#include "models/machine.h"
#include "models/model_structure.h"

namespace hydroscope {

/// The unit in which people read the output of a model and its errors: l/min for the flows of a die cushion (and if
/// there is no model), that of the signal where the output is one (ShownUnit), else the usual one. The model must outlive it.
DisplayUnit OutputUnit(const ModelStructure* model);
/// The same of the model that a machine file describes, which must outlive it.
DisplayUnit OutputUnit(const Machine& machine);
/// That of an error of the machine's model that was kept in `si`.
DisplayUnit UnitOfRecord(const Machine& machine, std::string_view si);
/// That of a machine's errors in texts: several outputs err by a share of their variation.
DisplayUnit UnitOfErrors(const Machine& machine);
inline constexpr DisplayUnit kOfVariation = {100, 0, "% of the outputs' variation"};
/// The unit in which people read a signal or a state: the one that its file states, where that is no plain SI unit (rpm, kW, %),
/// else the usual one. The machine must outlive its name.
DisplayUnit ShownUnit(const Machine& machine, std::string_view name);
/// SI unit of a signal or a state of a machine, which must outlive it; "1" where its file states none.
std::string_view SiOf(const Machine& machine, std::string_view name);

}  // namespace hydroscope
