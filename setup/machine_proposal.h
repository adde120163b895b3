#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/told.h"
#include "models/machine.h"
#include "setup/log_columns.h"

namespace hydroscope {

/// What a person may know beforehand.
struct ProposalOptions {
  std::map<std::string, double> known;  ///< geometry by name, SI
  std::string model = {};               ///< id of the kind of machine it is; "": to be recognised
  std::set<std::string> placed = {};    ///< signals whose columns a person named
};

/// One line of what was found.
struct ProposedColumn {
  std::string signal;  ///< name in the machine file, "time" for the time column
  std::string column;  ///< column of the log
  std::string unit;
  Told why;
  bool sure = true;  ///< false: a person should have a look
};

/// A machine file proposed from a log, and the reasons.
struct MachineProposal {
  Machine machine;
  std::string text;                     ///< the machine file with comments
  std::vector<ProposedColumn> columns;  ///< what was inferred from which column
  std::vector<std::string> unused;      ///< columns that mean nothing to the model
  std::vector<Told> decided;            ///< model, directions, sample period: what and why
  std::vector<Told> open;               ///< what cannot be inferred and has to be filled in
};

/// Proposes a machine file: time, pressures, position, spool, command and temperature by name and by
/// behaviour; the model, unless it is said, by what is there: a die cushion by the names of its columns, a kind all of whose
/// signals are there by name, die cushion and valve by behaviour, else a balance of expressions. Never fails: what
/// cannot be inferred is in `open` and marked in the file.
MachineProposal ProposeMachine(const LogColumns& head, const ProposalOptions& options);

}  // namespace hydroscope
