#pragma once

#include "models/machine.h"
#include "models/machine_table.h"

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
void ReadBalance(TableReader& file, Machine& machine);
void ReadEffects(TableReader& file, Machine& machine);
void ReadModelHistory(TableReader& file, Machine& machine);
/// `effect_values` of the section [machine].
void ReadEffectValues(TableReader& section, Machine& machine);
void ReadLive(TableReader& file, Machine& machine);
/// `dds` and `modbus` of one signal.
void ReadSignalOrigin(TableReader& signal, const toml::table& table, SignalSpec& spec);

/// What concerns several sections: the model's signals and known values are there and of the right quantity,
/// limits and windows fit each other.
void CheckMachine(TableReader& file, const Machine& machine);
/// Every live signal has one origin that its section describes, within the registers there are.
void CheckLive(TableReader& file, const Machine& machine);

}  // namespace hydroscope
