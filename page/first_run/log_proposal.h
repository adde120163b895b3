#pragma once

#include <nlohmann/json_fwd.hpp>

#include "page/api_arguments.h"
#include "setup/machine_proposal.h"

namespace hydroscope {

/// What `init` proposes for a log, after a person said what the machine is and put columns where they belong: columns that
/// `mapping` gives a signal are that signal, those it leaves out are not used; without any entry it is the plain proposal.
MachineProposal ProposeMapped(const LogColumns& log, const ColumnMapping& mapping);

/// A proposal for the page: `machine` (name), `model`, `title`, `kinds` (that may be chosen: `id`, `title`,
/// `german`), `pins` (what the machine reads: `signal`, `meaning`, `german`, `required`, `si`, `column`,
/// `unit`, `why`, `sure`, `low`, `high`, `shown_unit`), `picture` (page/work/machine_info.h), `columns`
/// (`column`, `name`, `unit`, `low`, `high` as in the log, `thumbnail`, `signal`), `geometry` (`name`,
/// `meaning`, `required`, `si`, `unit` that people read: `factor`, `offset`, `name`; `value`, `otherwise`: what
/// holds where none is given, or null; `lowest`, `highest`), `balance` (of a machine of one's own: `output`,
/// `terms`: `name`, `expression`; or null), `effects` (of one: `id`, `expression`, `not_negative`; or null), `gate`, `units` (that may be chosen), `decided`, `open`, `german`
/// of both and of `title`, `rows`, `duration_s`, `text` (the machine file), `problem` (why that cannot be used
/// yet, or null).
nlohmann::json ProposalJson(const LogColumns& log, const MachineProposal& proposal);

/// The machine file of a machine of one's own whose balance is still being written: its signals and gate, with a balance of
/// `output` where that is one of them, else of any. "" of other machines, and without signals.
std::string TextWithoutBalance(Machine machine, const std::string& output = "");

}  // namespace hydroscope
