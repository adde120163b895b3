#pragma once

#include "models/expressions/check.h"
#include "models/machine.h"
#include "models/machine_file/table.h"

namespace hydroscope {

/// Each reads one section of the machine file into `machine`; what is wrong is noted at the reader. They run
/// in this order: the units of later sections depend on the signals read before.
void ReadMachineSection(TableReader& file, Machine& machine);
void ReadLogSection(TableReader& file, Machine& machine);
void ReadSignals(TableReader& file, Machine& machine);
void ReadGeometry(TableReader& file, Machine& machine);
void ReadGate(TableReader& file, Machine& machine);
void ReadWindow(TableReader& file, Machine& machine);
void ReadEstimator(TableReader& file, Machine& machine);
void ReadMonitors(TableReader& file, Machine& machine);
void ReadValve(TableReader& file, Machine& machine);
void ReadConditions(TableReader& file, Machine& machine);
/// A condition as [conditions] has it: "max(p)".
std::string ConditionText(const Condition& condition);
void ReadExperiment(TableReader& file, Machine& machine);
void ReadBalance(TableReader& file, Machine& machine);
/// [states], [outputs] and [parameters]: a machine that is described by states.
void ReadStates(TableReader& file, Machine& machine);
void ReadEpisodeSection(TableReader& file, Machine& machine);
/// `adds` and `parameters` of an effect of such a machine.
void ReadStateEffect(TableReader& section, const Machine& machine, UserEffectSpec& effect);
void ReadEffects(TableReader& file, Machine& machine);
void ReadModelHistory(TableReader& file, Machine& machine);
/// `effect_values` of the section [machine].
void ReadEffectValues(TableReader& section, Machine& machine);
void ReadLive(TableReader& file, Machine& machine);
void ReadFeeds(TableReader& file, Machine& machine);
/// Where one signal comes from live, by the key of its source.
void ReadSignalOrigin(TableReader& signal, SignalSpec& spec);

/// Bounds on signals and on their rates: { z = { ... }, "ddt(z)" = { ... },
/// "abs(ddt(z))" = { ... } }. `path` stands in messages.
std::vector<GateBound> ReadBounds(TableReader& section, std::string_view key, const std::string& path,
                                  const Machine& machine);

/// Notes the first texts of `key` that are no address and no network.
void CheckAddressRanges(TableReader& section, const char* key, const std::vector<std::string>& ranges);

/// SI unit of a unit of the file; "1" if it is not known.
std::string SiOf(const std::string& unit);

/// Parts of [balance] and [[effect]] (sections_expressions.cc).
/// terms = { F_c = "sign(ddt(x))" } or { F_c = { expression = "sign(ddt(x))", unit = "N" } }; every expression is
/// checked against `names`.
std::vector<TermSpec> ReadTerms(TableReader& section, const std::string& key, const ExpressionNames& names,
                                std::vector<ExpressionUnit>& units);
/// Whether expressions can use it as a name.
bool IsName(const std::string& text);
/// Notes what is wrong with an expression, pointing at the character. `node` is its text in the file.
void ExpressionProblem(TableReader& reader, const toml::node& node, const std::string& key,
                       const ExpressionError& error);
/// The units of terms fit the output: parameter * expression = output, where that can be told.
void CheckTermUnits(TableReader& section, const std::string& key, const std::vector<TermSpec>& terms,
                    const std::vector<ExpressionUnit>& units, const std::string& output_unit);

/// The signals and known values that the machine's kind requires are there and of the right quantity.
void CheckModelInputs(TableReader& file, const Machine& machine);
/// What concerns several sections: what the model requires is there, limits and windows fit each other.
void CheckMachine(TableReader& file, const Machine& machine);
/// Every live signal has one origin that its section describes, within the registers there are.
void CheckLive(TableReader& file, const Machine& machine);

}  // namespace hydroscope
