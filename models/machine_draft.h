#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/told.h"
#include "models/machine.h"
#include "models/machine_file/format.h"

namespace hydroscope {

/// Beginning of a log, in the names that machine files give to signals.
struct LogSample {
  struct Signal {
    std::vector<double> value;  ///< SI, NaN where there is no number
    double high = 0;            ///< SI, 99 % quantile
  };
  double period = 0;  ///< s between rows; 0 = not known
  std::map<std::string, Signal, std::less<>> signals;
};

/// A machine file in the making.
struct MachineDraft {
  Machine machine;
  MachineNotes notes;
  std::vector<Told> decided;  ///< what and why, a sentence each
  std::vector<Told> open;     ///< what has to be filled in
};

/// How `hydroscope init` comes to a machine of a kind.
struct DraftRules {
  /// Why a log with these signals is of such a machine; "" if it is not. Kinds are asked in the order of MachineKinds(). nullptr: a
  /// log is of such a machine if it has its required signals by name (MachineInput::columns).
  Told (*suits)(const LogSample& log) = nullptr;
  /// Fills in what goes beyond the signals: gate, geometry, balance. `known`: what a person knows beforehand, SI.
  void (*complete)(const LogSample& log, const std::map<std::string, double>& known,
                   MachineDraft& draft) = nullptr;
};

}  // namespace hydroscope
