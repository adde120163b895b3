#pragma once

#include "models/machine_draft.h"

namespace hydroscope {

/// A log with pressure A, position and spool is of a die cushion; its signals are turned the model's way round.
extern const DraftRules kCushionDraft;

}  // namespace hydroscope
