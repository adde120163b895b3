#pragma once

#include <nlohmann/json_fwd.hpp>

#include "page/api_arguments.h"
#include "setup/machine_proposal.h"

namespace hydroscope {

/// What `init` proposes for a log, after a person put columns where they belong: columns that `mapping` gives a signal are
/// that signal, those it leaves out are not used; without any entry it is the plain proposal.
MachineProposal ProposeMapped(const LogColumns& log, const ColumnMapping& mapping);

/// A proposal for the page: `machine` (name), `model`, `title`, `pins` (what the machine reads: `signal`, `meaning`,
/// `german`, `required`, `si`, `column`, `unit`, `why`, `sure`, `low`, `high`, `shown_unit`), `picture` (page/machine_info.h), `columns` (`column`, `name`, `unit`,
/// `low`, `high` as in the log, `thumbnail`, `signal`), `geometry` (`name`, `meaning`, `required`, `si`, `value`, `lowest`,
/// `highest`), `gate`, `units` (that may be chosen), `decided`, `open`, `rows`, `duration_s`, `text` (the machine file),
/// `problem` (why that cannot be used yet, or null).
nlohmann::json ProposalJson(const LogColumns& log, const MachineProposal& proposal);

}  // namespace hydroscope
