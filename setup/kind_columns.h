#pragma once

#include <cstddef>
#include <vector>

#include "core/told.h"
#include "models/machine_kind.h"
#include "setup/log_columns.h"
#include "setup/unit_guess.h"

namespace hydroscope {

/// A column of a log that is a signal of a kind of machine by its name.
struct KindColumn {
  std::size_t column = 0;
  const MachineInput* signal = nullptr;
  UnitGuess unit;
  Told why;
};

/// Columns called like signals of the kind: by the signal's own name, one usual in logs (MachineInput::columns), or what it means in
/// English or German. In the order of the kind's signals; no column is given twice.
std::vector<KindColumn> ColumnsByName(const LogColumns& head, const MachineKind& kind);

/// The kind of which a log has all required signals by name: of several the one with the most of them, then the first of
/// MachineKinds(). Asked are kinds that have no other rule (DraftRules::suits). nullptr: none.
const MachineKind* KindByColumnNames(const LogColumns& head);

/// Kinds that a machine file can be made of on a log by saying which column is which signal.
std::vector<const MachineKind*> KindsToChoose();

}  // namespace hydroscope
